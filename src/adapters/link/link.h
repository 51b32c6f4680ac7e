// The adapter to a live ROS 2 robot, directly over DDS.
//
// It joins as the node /culprit. It reports its observations to the manager: nodes and their
// dependencies, the rhythm of topics, values of fields, diagnostics and parameters, lifecycle
// states. It carries out the manager's commands to nodes, and publishes culprit's messages on
// /diagnostics and /rosout.
//
// It does no harm: its readers are best effort and keep one sample, it subscribes only to what the
// rules read, and it uses no shared memory.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/mutex.h"
#include "language/rule_set.h"
#include "link/clock_step.h"
#include "link/component_link.h"
#include "link/diagnostics_watch.h"
#include "link/lease_link.h"
#include "link/log_watch.h"
#include "link/namesake.h"
#include "link/neighbour_hosts.h"
#include "link/process_usage.h"
#include "link/simulated_clock.h"
#include "link/starvation.h"
#include "link/topic_watch.h"
#include "link/type_finder.h"
#include "robot/command.h"
#include "robot/component_binding.h"
#include "robot/inbox.h"
#include "ros2/hearing.h"
#include "ros2/node.h"
#include "ros2/timer.h"

namespace culprit::ros2 {

// One status on /diagnostics. `level` as in diagnostic_msgs: 0 OK, 1 WARN, 2 ERROR.
struct Health {
  std::string name;
  std::uint8_t level = 0;
  std::string message;
  std::vector<std::pair<std::string, std::string>> values;
};

// execute(), publish() and log() may be called from any thread; results of commands go to the
// inbox.
class Link {
 public:
  struct Options {
    ParticipantOptions participant;
    NodeName name{"/", "culprit"};
    TypeFinder::Options types{};
    std::vector<std::pair<std::string, Value>>
        parameters;  // what the node shows of itself, read-only
    // Announced to other culprits, of which one manages the robot (manager_lease.h). Nothing: this
    // one never will.
    std::optional<LeaseLink::Options> lease{};
    // The robot is simulated: its time is /clock (simulated_clock.h), also before anybody publishes that.
    // Without it /clock is followed once it runs, if a component's node has use_sim_time, and for such
    // nodes only: nothing is judged about them while it stands still (TimeHeld).
    bool use_sim_time = false;
  };

  // `rules` and `inbox` must outlive the link. Errors: the domain cannot be joined.
  static Expected<std::unique_ptr<Link>> open(const RuleSet& rules, Options options, Inbox& inbox);
  ~Link();

  void execute(const Command& command);
  // Publishes at once, and again every second until there is something new to publish.
  void publish(std::vector<Health> health);
  void log(Severity severity, std::string text);

  // For each component's and container's node whose name others have too, by full name: the
  // processes that hold it, their launchers, and how to end the extra one. From any thread.
  std::map<std::string, std::string> contested() const;
  // The processes of all nodes of one name, where there are several: by that name; 0: on another
  // machine, or not proven. From any thread.
  std::map<std::string, std::vector<int>> doubled() const;

  // The other computers that nodes of the graph run on, as their middleware announces them, by the
  // nodes' full names. From any thread.
  std::map<std::string, std::string> nodes_elsewhere() const;

  // The other computer where the component was last discovered, if that computer is unreachable
  // now, so that its state there is unknown. The result is reported (HostHeard) before this
  // returns. From any thread.
  std::optional<std::string> cut_off(ComponentId component);

  // The component's node was ordered to leave: until then the node is not asked whether it left.
  // From any thread.
  void expect_departure(ComponentId component, Time until);
  // An earlier run had proven that a process of this machine has this node. From any thread.
  void note_proven_here(const std::string& node) { context_->note_proven_here(node); }

  // The publishers of diagnostics that an earlier run learned, by status. From any thread.
  void remember_publishers(const std::map<std::string, std::string>& publishers);

  // Our own node, for clients of nodes that are no component. It goes with the link.
  NodeEntry& entry() { return node_->entry(); }

  // Until when it is certain that the robot's messages arrive (hearing.h), that no other culprit
  // manages it (lease_link.h), and that its time passes (simulated_clock.h). From any thread, as
  // all of the following.
  Time doubtful() const;
  // When reception was last proven, and to have it proven now.
  Time heard() const { return hearing_->heard(); }
  void prove_hearing() { hearing_->say(); }
  // Asks those that alone publish what the rules watch, and of which nothing comes, whether they know
  // that it is listened to (ListenerKnown), until then. Not through a discovery server.
  void prove_listening(Time until);
  // The doubt, once that time has come.
  std::string doubt() const;
  // True if culprit itself works, and only the robot's time stands still.
  bool is_paused() const;

  // The lease that decides which of the domain's culprits manages the robot. Null: this culprit
  // claims none.
  LeaseLink* lease() { return lease_.get(); }
  const LeaseLink* lease() const { return lease_.get(); }

 private:
  Link(const RuleSet& rules, Options options, Inbox& inbox);
  Expected<void> start();
  FoundProcess find_named(const ParticipantInfo& participant) const;
  Expected<void> declare_parameters();
  Expected<void> watch_parameter_events();

  void on_change(const GraphChange& change);
  void give_memory_back_soon();
  void on_joined(const GraphNode& node);
  void on_left(const std::string& node, bool was_lost);
  struct Leaving;
  void doubt_leaving(const std::string& node, Leaving leaving);
  void ask_leaving(const std::string& node, std::uint64_t doubt);
  void believe_leaving(const std::string& node, std::optional<GuidPrefix> answered,
                       std::uint64_t doubt);
  void vanished(const std::string& node, bool was_lost);
  bool is_other_node(ComponentId component, const std::string& node) const;
  void other_node_joined(ComponentId component, const GraphNode& node);
  void probe_other_nodes();
  void tell_usage();
  void on_said_to_leave(const std::string& node);
  void ask_whether_left(const std::string& node);
  void ask_whether_left(const std::string& node, int questions);
  void on_whether_left(const std::string& node, int questions, bool answers);
  void on_system(const std::string& manager, const GraphEndpoint& service);
  void on_endpoint(const std::string& node, const GraphEndpoint& endpoint);
  void tell_writers(const std::string& topic);
  void find_type(const std::string& node, const GraphEndpoint& endpoint, TopicWatch& watch);
  void on_parameter_event(const msg::ParameterEvent& event, const Guid& writer);
  void ask_for_parameters(ComponentId component, const std::string& node, const std::string& by);
  bool may_tell_modes(const std::string& manager, const std::string& system);
  void probe();
  void ask_silent_ones();
  void publish_again();
  void tell_of_refused();
  void tell_of_foreign_sources();
  void on_namesakes(const NodeNamesakes& seen);
  void remind();
  void note_time_source(ComponentId component, const std::string& node, bool is_simulated);
  void follow_clock(const std::string& node);
  void look_at_simulated_nodes();
  void hold_time(const std::string& node, bool is_held);
  void tell_of_pause(bool is_held, Time now);
  void look_at_clocks();
  const SimulatedClock* clock() const;
  const SimulatedClock* clock_of_all() const;
  void on_discovery(const DiscoveryEvent& event);
  void listen_to_hosts();
  void look_at_hosts();
  void lives_on(ComponentId component, const std::string& host);

  ComponentLink* link_of(ComponentId component);
  Time sure_to_hear(Time now) const;
  ComponentLink* make_link(ComponentId component, const std::string& node);

  const RuleSet& rules_;
  Options options_;
  Inbox& inbox_;
  ComponentBinding binding_;

  Executor executor_;
  std::unique_ptr<Context> context_;
  std::unique_ptr<Node> node_;
  std::optional<Publisher<msg::DiagnosticArray>> diagnostics_;
  std::map<std::string, std::unique_ptr<TopicWatch>> watches_;  // by topic
  std::unique_ptr<TypeFinder> types_;
  // If the robot is simulated, or a node announces that it is. Made on the executor's thread, once.
  std::unique_ptr<SimulatedClock> clock_;
  std::atomic<const SimulatedClock*> made_clock_ = nullptr;  // for the other threads
  std::string simulated_node_;                               // the first that has use_sim_time
  struct Simulated {
    ComponentId component;
    bool is_held = false;  // as was reported
  };
  std::map<std::string, Simulated> simulated_;  // those whose time is /clock, by node
  std::set<std::string> clock_sources_;         // those of them that publish it, or did
  // Components' nodes have real time, too: a clock that stands still is no reason to judge nothing at all.
  std::atomic<bool> is_time_mixed_ = false;
  Time clock_stood_ = kLongAgo;  // the last time
  Time clock_runs_ = kLongAgo;   // the last time that no node was held
  bool told_of_pause_ = false;
  std::unique_ptr<Timer> looking_at_clock_;
  Time simulated_since_ = kLongAgo;  // when that was known
  bool told_of_clock_ = false;
  bool told_of_no_clock_ = false;
  ClockStep system_clock_;
  std::unique_ptr<DiagnosticsWatch> diagnostics_watch_;
  std::unique_ptr<LogWatch> log_watch_;
  std::unique_ptr<RawSubscription> parameter_events_;
  std::atomic<int> parameter_events_waiting_ = 0;
  std::map<ComponentId, Time> parameters_asked_;           // because of somebody else's event
  std::set<std::pair<std::string, std::string>> told_of_;  // nodes, and the sources in their names
  std::map<std::string, GuidPrefix> holders_;              // participants of nodes that are there
  std::map<std::string, std::string> mode_managers_;       // by system: the node whose modes count
  struct ToProbe {
    ComponentId component;
    int pid = 0;  // 0: not known
  };
  std::map<std::string, ToProbe> probed_;     // by node
  std::map<ComponentId, UsageMeter> meters_;  // of those whose usage the rules read
  // Nodes that the process of a component has besides: whether they answer.
  struct OtherNode {
    ComponentId component;
    std::uint8_t place = 1;  // Probed::node
    int pid = 0;
    bool is_there = false;
    std::unique_ptr<ServiceClient> client;
  };
  std::map<std::string, OtherNode> other_nodes_;  // by node
  Namesake namesake_;
  Starvation starvation_;
  std::optional<Time> probed_last_;
  std::map<std::string, int> pids_;  // of nodes that are there; 0 where it is not known
  // Nodes of components whose process is not known, and the participant that has each.
  struct Unproven {
    Vendor vendor = Vendor::kOther;
    GuidPrefix participant{};
  };
  std::map<std::string, Unproven> unproven_;
  // Such nodes that are announced to have left.
  struct Leaving {
    Unproven node;
    bool was_lost = false;
    std::uint64_t doubt = 0;  // which of all
    bool is_told = false;     // that it answers all the same
  };
  std::map<std::string, Leaving> leaving_;
  std::uint64_t doubts_ = 0;
  std::map<std::string, std::vector<std::string>> systems_;       // by the mode manager's node
  std::map<std::string, std::multiset<std::string>> publishers_;  // nodes, by watched topic
  // Those that are asked whether they know that the topic is listened to.
  std::map<TopicId, std::unique_ptr<ServiceClient>> asked_;
  Time asks_until_ = kLongAgo;
  std::unique_ptr<Timer> asking_;
  std::unique_ptr<Timer> probing_;
  std::unique_ptr<Timer> publishing_;
  std::unique_ptr<Hearing> hearing_;
  std::uint64_t refused_ = 0;  // datagrams that were reported
  std::unique_ptr<LeaseLink> lease_;
  std::unique_ptr<NeighbourHosts> hosts_;
  Time looked_at_hosts_ = kLongAgo;              // on the executor's thread
  bool gives_memory_back_ = false;               // soon
  std::set<std::string> asked_whether_left_;     // nodes that were announced to leave
  std::set<std::string> told_of_false_leaving_;  // those of them that answered once

  mutable Mutex mutex_;
  // A component's node that others have the name of.
  struct Contest {
    std::string text;
    Time due{};  // for the report
  };
  std::map<std::string, Contest> contested_ CULPRIT_GUARDED_BY(mutex_);            // by node
  std::map<std::string, std::vector<int>> doubled_ CULPRIT_GUARDED_BY(mutex_);     // by node
  std::map<std::string, std::string> nodes_elsewhere_ CULPRIT_GUARDED_BY(mutex_);  // by node
  std::map<ComponentId, std::string> elsewhere_
      CULPRIT_GUARDED_BY(mutex_);  // the other computer where it ran last, unless it left in order
  std::map<ComponentId, Time> departures_ CULPRIT_GUARDED_BY(mutex_);  // expected until then
  std::set<std::string> silent_hosts_ CULPRIT_GUARDED_BY(mutex_);      // that were reported
  std::vector<Health> health_ CULPRIT_GUARDED_BY(mutex_);
  std::vector<std::unique_ptr<ComponentLink>> links_
      CULPRIT_GUARDED_BY(mutex_);  // by component; one that is made stays

  // Work of other threads for the executor's.
  TaskGroup tasks_{executor_};

  std::thread thread_;
};

}  // namespace culprit::ros2
