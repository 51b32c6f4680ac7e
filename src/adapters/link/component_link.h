// The requests that culprit makes to one component's node: its lifecycle, its parameters, its
// modes, its routines.
//
// Its clients are made when the node is discovered to offer a service, or at the first command that
// needs it, and kept (component_clients.h).
#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "base/mutex.h"
#include "inbox/inbox.h"
#include "language/rule_set.h"
#include "link/asking.h"
#include "link/component_clients.h"
#include "link/component_needs.h"
#include "link/processor_time.h"
#include "link/starvation.h"
#include "link/type_finder.h"
#include "robot/command.h"
#include "ros2/executor.h"
#include "ros2/graph.h"
#include "ros2/messages.h"
#include "ros2/service_client.h"
#include "ros2/subscription.h"

namespace culprit::link {

class ServiceCall;

// All members may be called from any thread. Their results are put into the inbox: a Reply for each
// command, and LifecycleRead, ParameterRead, ParametersListed and Probed as they become known.
class ComponentLink {
 public:
  // `self` is our own node, `node` the component's full name. All references must outlive the link.
  // `types` is asked on the executor's thread, and not after the link is gone.
  ComponentLink(ros2::NodeEntry& self, ComponentId component, std::string node,
                const RuleSet& rules, Inbox& inbox, TypeFinder& types, Starvation& starvation);

  // The process of the node, on this machine; 0: not known. And the participant that holds the
  // node: from now on only its answers count, but for those of modes, which a mode manager gives
  // for others.
  void lives_in(int pid, const rtps::GuidPrefix& participant);

  // Its modes come from this participant: its own, or that of a mode manager.
  void modes_come_from(const rtps::GuidPrefix& participant) {
    clients_.modes_come_from(participant);
  }

  // Reads the parameters again: an event announced that they changed.
  void check_values() { read_parameters(); }

  // The node was discovered to offer a service: readies the client, reads the present state, and
  // finds out what a routine takes while the node is well enough to be asked. On the executor's
  // thread.
  void service_seen(const ros2::GraphEndpoint& service);

  // A cheap read that proves that the node answers: of its lifecycle state, which is reported as by
  // check_lifecycle(), or of no parameter. `pid` is its process; 0: not known. A missing answer is
  // not reported if a debugger traces the process. For a node on another computer it is reported
  // only once a later message of that computer arrived after the answer was due. `heard` returns
  // the time of the last one, and is called from any thread. Null: the node is on this computer.
  // Nor is it reported if culprit was starved a moment ago, or while the process is at work.
  void probe(int pid, std::function<Time()> heard = {});
  // Asks once, by the same read, whether the node is there, and gives the participant that answered, if any does.
  // `then` may be called before this returns.
  void ask(std::function<void(std::optional<rtps::GuidPrefix> answered)> then);
  // Its computer is known to be unreachable: answers that are still missing are never reported.
  void forget_unanswered();

  // Reads the state of a node that was discovered to have a lifecycle, and reports it if it differs
  // from the last report. Events report transitions sooner, and they may be lost: they are not
  // repeated, and the first ones pass before both sides have matched.
  void check_lifecycle();

  // Asks a node that lacks a parameter of the rules which ones it has: one of those may be meant.
  void check_parameters();

  // Asks the node whether its time is the simulated one (use_sim_time). `then` is called with the answer, on any
  // thread. On the executor's thread.
  void ask_time_source(std::function<void(bool is_simulated)> then);

  // The same again, if it was asked before: it may be another one now (ros2 param set).
  void ask_time_source_again();

  // Asks again what the node was asked when it was discovered, and has not answered: while it loads (a model, slow
  // imports), it may answer nothing. For Asking::kMost times after that. On the executor's thread.
  void ask_again();

  void execute(const Command& command);

 private:
  struct Answer {
    Outcome outcome = Outcome::kDone;
    decltype(Reply::value) value;
    std::string text;
  };

  void run(const Command& command, const ChangeLifecycle& what);
  void run(const Command& command, const ReadLifecycle& what);
  void run(const Command& command, const SetParameter& what);
  void run(const Command& command, const ReadParameter& what);
  void run(const Command& command, const CallService& what);
  void call(const Command& command, const std::string& type, const std::string& service,
            const ServiceCall& call);
  void run(const Command& command, const ChangeMode& what);
  void run(const Command& command, const ReadMode& what);
  void run(const Command& command, const Probe& what);
  // Processes are not this link's.
  void run(const Command& command, const StopProcess& what);
  void run(const Command& command, const StartProcess& what);

  // Calls and turns the response into the command's Reply by `understand`.
  template <class Service, class Understand>
  void ask(ros2::ServiceClient* client, const typename Service::Request& request,
           ros2::Repeat repeat, const Command& command, Understand understand);
  void reply(const Command& command, Answer answer);
  Expected<ros2::msg::ParameterValue> to_set(const std::string& name, const Value& value);
  std::optional<Value> read_value(const std::string& name, const ros2::msg::ParameterValue& value);
  // Nothing: it was answered.
  std::optional<Answer> why_unanswered(const ros2::CallResult& result, const Command& command,
                                       const std::string& type) const;

  // The cheap read. `then` is called with its result; not at all if no client could be made.
  bool read_anything(Duration patience, rtps::Haste haste,
                     std::function<void(const ros2::CallResult&)> then);
  void read_first_state(rtps::Haste haste);
  enum class Told : std::uint8_t { kAlways, kIfNew };
  void on_lifecycle(const ros2::CallResult& result, Told told);
  void tell(Lifecycle state, Told told);
  // The content of a transition event.
  struct Claim {
    Lifecycle state = Lifecycle::kUnknown;
    bool is_shut_down = false;  // somebody ordered its end
  };
  void watch_transitions();
  void on_transition(const ros2::Sample& sample);
  void ask_for_transition();
  void on_state(const ros2::CallResult& result, const Claim& claim);
  bool was_shut_down(const Claim& claim);
  bool is_at_work(int pid);
  void unanswered(Time due, const std::function<Time()>& heard);
  void read_parameters();
  void note_that_it_answers();

  ros2::NodeEntry& self_;
  const ComponentId component_;
  const std::string node_;
  const RuleSet& rules_;
  const ComponentNeeds needs_;
  Inbox& inbox_;
  TypeFinder& types_;
  Starvation& starvation_;
  // Not under the mutex: a receive thread that waited for it would block the thread that makes a
  // client.
  std::atomic<int> pid_ = 0;
  std::atomic<Lifecycle> told_ = Lifecycle::kUnknown;
  std::atomic<bool> misses_parameter_ = false;  // found since it was asked for its names
  Asking asking_state_, asking_values_, asking_time_, asking_anything_;
  std::function<void(bool)> then_of_time_;  // of the executor's thread

  ComponentClients clients_;
  Mutex mutex_;  // never held while calling
  std::map<std::string, TypeFinder::Offer> services_
      CULPRIT_GUARDED_BY(mutex_);        // that the node offers, by name
  std::optional<ProcessorLook> looked_;  // when it did not answer last; of the executor's thread
  Mutex unanswered_mutex_;
  // The due times of missing answers that are not reported yet.
  std::deque<Time> unanswered_ CULPRIT_GUARDED_BY(unanswered_mutex_);
  Mutex lists_mutex_;  // another one: receive threads take it
  std::map<std::string, std::uint8_t> lists_
      CULPRIT_GUARDED_BY(lists_mutex_);  // parameters that were read to be lists -> type
  std::unique_ptr<ros2::RawSubscription> transitions_;

  // The claims of transition events (kTransition: one is under way), and whether the node is being asked about them.
  struct Claimed {
    std::optional<rtps::GuidPrefix> holder;  // whose events count
    std::optional<Claim> last;               // since the node was asked
    bool is_asked = false;
  };
  Mutex claimed_mutex_;  // receive threads take it
  Claimed claimed_ CULPRIT_GUARDED_BY(claimed_mutex_);
  ros2::TaskGroup tasks_;  // goes first
};

}  // namespace culprit::link
