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
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/mutex.h"
#include "inbox/inbox.h"
#include "language/rule_set.h"
#include "link/component_hosts.h"
#include "link/component_link.h"
#include "link/datagram_troubles.h"
#include "link/diagnostics_watch.h"
#include "link/lease_link.h"
#include "link/leaving_announcements.h"
#include "link/listening_proof.h"
#include "link/log_watch.h"
#include "link/mode_managers.h"
#include "link/name_contests.h"
#include "link/namesake.h"
#include "link/other_nodes.h"
#include "link/parameter_watch.h"
#include "link/process_usage.h"
#include "link/robot_time.h"
#include "link/starvation.h"
#include "link/topic_watch.h"
#include "link/type_finder.h"
#include "robot/command.h"
#include "robot/component_binding.h"
#include "ros2/hearing.h"
#include "ros2/node.h"
#include "ros2/timer.h"

namespace culprit::link {

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
    ros2::ParticipantOptions participant;
    ros2::NodeName name{"/", "culprit"};
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
  void log(ros2::Severity severity, std::string text);

  // For each component's and container's node whose name others have too, by full name: the text for a
  // person. From any thread.
  std::map<std::string, std::string> contested() const { return contests_.texts(); }
  // As NameContests. From any thread.
  std::map<std::string, std::vector<int>> doubled() const { return contests_.processes(); }

  // The other computers that nodes of the graph run on, as their middleware announces them, by the
  // nodes' full names. From any thread.
  std::map<std::string, std::string> nodes_elsewhere() const { return hosts_->nodes_elsewhere(); }

  // The other computer where the component was last discovered, if that computer is unreachable
  // now, so that its state there is unknown. The result is reported (HostHeard) before this
  // returns. From any thread.
  std::optional<std::string> cut_off(ComponentId component);

  // The component's node was ordered to leave: until then the node is not asked whether it left.
  // From any thread.
  void expect_departure(ComponentId component, Time until) { leaving_.expect(component, until); }
  // An earlier run had proven that a process of this machine has this node. From any thread.
  void note_proven_here(const std::string& node) { context_->note_proven_here(node); }

  // The publishers of diagnostics that an earlier run learned, by status. From any thread.
  void remember_publishers(const std::map<std::string, std::string>& publishers);

  // Our own node, for clients of nodes that are no component. It goes with the link.
  ros2::NodeEntry& entry() { return node_->entry(); }

  // Until when it is certain that the robot's messages arrive (hearing.h), that no other culprit
  // manages it (lease_link.h), and that its time passes (robot_time.h). From any thread, as
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
  Expected<void> join();
  Expected<void> watch();
  ros2::Graph::Options graph_options();
  ros2::FoundProcess find_named(const ros2::ParticipantInfo& participant) const;
  Expected<void> declare_parameters();

  void on_change(const ros2::GraphChange& change);
  void give_memory_back_soon();
  void on_joined(const ros2::GraphNode& node);
  void on_left(const std::string& node, bool was_lost);
  void ask(const std::string& node, LeavingAnnouncements::Then then);
  void vanished(const std::string& node, bool was_lost);
  bool is_ours(const std::string& node);
  rtps::GuidPrefix participant_of(const std::string& node) const;
  void on_system(const std::string& manager, const ros2::GraphEndpoint& service);
  void on_endpoint(const std::string& node, const ros2::GraphEndpoint& endpoint);
  void on_subscription(const std::string& node, const std::string& topic);
  void tell_writers(const std::string& topic);
  void find_type(const std::string& node, const ros2::GraphEndpoint& endpoint, TopicWatch& watch);
  void on_discovery(const ros2::DiscoveryEvent& event);
  void listen_to_hosts();
  void look_at_hosts();

  void probe();
  std::vector<ListeningProof::Silent> silent_topics() const;
  void publish_again();
  void tell_usage();
  void remind();

  ComponentLink* link_of(ComponentId component);
  Time sure_to_hear(Time now) const;
  ComponentLink* make_link(ComponentId component, const std::string& node);

  const RuleSet& rules_;
  Options options_;
  Inbox& inbox_;
  ComponentBinding binding_;

  ros2::Executor executor_;
  std::unique_ptr<ros2::Context> context_;
  std::optional<DatagramTroubles> datagrams_;
  std::unique_ptr<ros2::Node> node_;
  std::optional<ros2::Publisher<ros2::msg::DiagnosticArray>> diagnostics_;
  std::map<std::string, std::unique_ptr<TopicWatch>> watches_;  // by topic
  std::unique_ptr<TypeFinder> types_;
  std::unique_ptr<RobotTime> time_;
  std::unique_ptr<DiagnosticsWatch> diagnostics_watch_;
  std::unique_ptr<LogWatch> log_watch_;
  std::unique_ptr<ParameterWatch> parameter_watch_;
  struct ToProbe {
    ComponentId component;
    int pid = 0;  // 0: not known
  };
  std::map<std::string, ToProbe> probed_;     // by node
  std::map<ComponentId, UsageMeter> meters_;  // of those whose usage the rules read
  std::unique_ptr<OtherNodes> other_nodes_;
  LeavingAnnouncements leaving_;
  NameContests contests_;
  Namesake namesake_;
  Starvation starvation_;
  std::optional<Time> probed_last_;
  ModeManagers mode_managers_{inbox_};
  std::unique_ptr<ListeningProof> listening_;
  std::unique_ptr<ros2::Timer> probing_;
  std::unique_ptr<ros2::Timer> publishing_;
  std::unique_ptr<ros2::Hearing> hearing_;
  std::unique_ptr<LeaseLink> lease_;
  std::unique_ptr<ComponentHosts> hosts_;
  Time looked_at_hosts_ = kLongAgo;  // on the executor's thread
  bool gives_memory_back_ = false;   // soon

  mutable Mutex mutex_;
  std::vector<Health> health_ CULPRIT_GUARDED_BY(mutex_);
  std::vector<std::unique_ptr<ComponentLink>> links_
      CULPRIT_GUARDED_BY(mutex_);  // by component; one that is made stays

  // Work of other threads for the executor's.
  ros2::TaskGroup tasks_{executor_};

  std::thread thread_;
};

}  // namespace culprit::link
