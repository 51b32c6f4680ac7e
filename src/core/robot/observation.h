// Observations of the robot: the only way in for facts about the managed system.
//
// Adapters (ros2, process, simulation, recorded bags) produce observations, the monitor consumes
// them; people's orders come the same way. Things that the rule set names come with their number in
// the rule set; the rest of the robot's graph comes with its names.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "base/endpoint_kind.h"
#include "base/goal_status.h"
#include "base/ids.h"
#include "base/log_level.h"
#include "base/time.h"
#include "base/value.h"
#include "robot/order.h"

namespace culprit {

// A node joined the graph. `node` is its full name, "/namespace/name".
// `pid` is its process on this machine, 0 where that is not known (another machine, a container).
struct NodeAppeared {
  std::string node;
  int pid = 0;
};

// A node left the graph: it said good-bye, or its lease ran out.
struct NodeVanished {
  std::string node;
};

// How many other nodes have the name of this one and may be alive. A request to that name may reach
// any of them.
struct NamesakesSeen {
  std::string node;
  int others = 0;
};

// A node offers or uses a topic (publisher, subscriber) or a service (server, client). `name` is
// the ROS name of it.
struct EndpointAppeared {
  std::string node;
  EndpointKind kind;
  std::string name;
};

struct EndpointVanished {
  std::string node;
  EndpointKind kind;
  std::string name;
};

// A message came on a watched topic. `published` is how many its publisher sent since the last one
// that reached us, this one included: more than 1 if some were lost on the way (by RTPS sequence
// numbers). `lost_here`: culprit's own full sockets dropped datagrams meanwhile, which may be those.
struct SampleArrived {
  TopicId topic;
  std::uint32_t published = 1;
  bool lost_here = false;
};

// A declared or looked-up signal was read.
struct SignalRead {
  SignalId signal;
  Value value;
};

// The level of a diagnostic status: 0 OK, 1 WARN, 2 ERROR, 3 STALE
// (diagnostic_msgs/DiagnosticStatus).
struct DiagnosticRead {
  DiagnosticId diagnostic;
  std::uint8_t level = 0;
};

// A parameter of a component was read, or it announced a new value.
struct ParameterRead {
  ParameterId parameter;
  Value value;
};

// Primary states of a managed node (design.ros2.org/articles/node_lifecycle.html), with "a
// transition is under way".
enum class Lifecycle : std::uint8_t {
  kUnknown,
  kUnconfigured,
  kInactive,
  kActive,
  kFinalized,
  kTransition
};

struct LifecycleRead {
  ComponentId component;
  Lifecycle state = Lifecycle::kUnknown;
  bool is_shut_down = false;  // kFinalized: a shutdown was asked for; no error led there
};

enum class ProcessState : std::uint8_t {
  kRunning,
  kStopped,  // by SIGSTOP or a debugger, or frozen: it exists and does nothing
  kGone      // exited, killed, or never started
};

// Whether a process ended or was stopped on purpose, as far as the operating system reports.
enum class Cause : std::uint8_t {
  kUnknown,
  kFault,  // a signal that is no usual request to end, or another exit code than 0; it was stopped
           // alone
  kWish,   // exit code 0, SIGINT, SIGTERM or SIGHUP; culprit ended it; it was stopped with its
           // launcher, or with all of its job in a terminal
  kOrder,  // its owner ended it in an orderly way, as systemctl stop and docker stop do, and
           // Ctrl-C in the terminal of its shell; its control group was frozen
  kDoubt   // exit code 1 of a program in Python: an exception, or what a node makes of SIGINT
};

// The state of a component's process, as the operating system reports it.
struct ProcessSeen {
  ComponentId component;
  ProcessState state = ProcessState::kGone;
  int pid = 0;         // of the process that this is about
  std::string remark;  // how it ended ("killed by signal 9", "exit code 1"); empty while it lives
  Cause cause = Cause::kUnknown;  // of kStopped and kGone
};

// The program that started the component's process, if that was not culprit: a launch file, a
// shell.
struct LauncherSeen {
  ComponentId component;
  int pid = 0;
  bool has_ended = false;
  bool has_crashed = false;  // it has ended so; false if that is not known
  bool ran_others = false;   // other processes, when the component's had ended
};

// culprit started the component's process `pid`, in this run or an earlier one. Told before its
// ProcessSeen.
struct StartedHere {
  ComponentId component;
  int pid = 0;
  int launcher = 0;     // that had started the process in whose place it stands; 0: there is none
  Duration runs_for{};  // until now
};

// A process whose node is still awaited used the processor, or its memory grew, since it was
// started or since this was last reported.
struct ProcessWorked {
  ComponentId component;
  int pid = 0;
};

// The usage of the component's process: the processor since the observation before, in cores, and
// memory in RAM. Observed each second, for components whose usage the rules read.
struct UsageSeen {
  ComponentId component;
  double cores = 0;
  double mib = 0;
};

// Somebody else unloaded the component from its container: the container's process goes on, and does
// not list the component any more.
struct Unloaded {
  ComponentId component;
};

// How far the goals of an action are: all that its server remembers. `topic` is that of their status.
struct GoalsSeen {
  struct Goal {
    std::uint64_t id = 0;  // of the UUID
    GoalStatus status = GoalStatus::kUnknown;
  };
  TopicId topic;
  std::vector<Goal> goals;
};

// A node of the component wrote a line into its log (/rosout).
struct LogSeen {
  ComponentId component;
  LogLevel level = LogLevel::kInfo;
};

// The simulated time of the component's node (use_sim_time) stands still or has just jumped, so that its
// silence shows no fault; or that time passes again.
struct TimeHeld {
  ComponentId component;
  bool is_held = false;
};

// The system clock of culprit's own computer was stepped: set back (below 0) or ahead.
struct ClockStepped {
  Duration by{};
};

// The computer that runs a component (HOST) cannot be asked, or can be again. While nothing is
// received from a component there, it is unknown whether it works.
struct HostReached {
  ComponentId component;
  bool is_reached = false;
};

// On which other computer the component's node runs, as its middleware says: the name of the host.
// Empty: on this one, or it is not known.
struct LivesOn {
  ComponentId component;
  std::string host;
};

// Another computer became unreachable: no process there is received any more, because it is down or
// cut off. Or it is reachable again. Reported only while culprit receives its own messages
// (HearingLost).
struct HostHeard {
  std::string host;
  bool is_heard = false;
};

// To end the component's process is to end these components', too: they live in it, or it started
// them.
struct EndsWith {
  ComponentId component;
  std::vector<ComponentId> others;
};

// A component whose process is not known (another machine, a container) was asked whether it is
// there.
struct Probed {
  ComponentId component;
  bool answered = false;
  std::uint8_t node = 0;  // of a component with several: which of them, from 0
};

// How a command ended. A command that gets no Reply within its time is settled by reading the state
// back.
enum class Outcome : std::uint8_t {
  kDone,
  kRefused,      // the component answered, and said no
  kUnreachable,  // there is nobody to ask: no such node, no such service, no way to start it
  kTimedOut      // asked, not answered
};

struct CommandId {
  std::uint64_t number = 0;
  auto operator<=>(const CommandId&) const = default;
};

// The answer to a command. `value` is what was read, for commands that read; `text` is a reason for
// people.
struct Reply {
  CommandId command;
  Outcome outcome = Outcome::kDone;
  std::variant<std::monostate, Value, Lifecycle> value;
  std::string text;
};

// A diagnostic status was received for the first time, while one that the rules name was not: that
// one may be meant. Each status once, of many the first ones.
struct StatusHeard {
  std::string name;
  std::string hardware_id;
  std::vector<std::string> keys;
};

// The parameters that a component has, which lacks one that the rules name.
struct ParametersListed {
  ComponentId component;
  std::vector<std::string> names;
};

// Something about the link itself that a person should know: a payload that does not decode, two
// nodes of one name.
struct LinkTrouble {
  std::string text;
};

// culprit does not receive its own messages, which take the same way as the robot's, or the time of
// a simulated robot stands still. From now on a missing message does not show a fault of the robot.
// Until HearingRegained.
struct HearingLost {
  std::string reason;
};
struct HearingRegained {};

// The manager's host loop called it this much later than it had asked for: culprit, or the whole
// computer, stood still. Up to kBriefly it came `by` after the observation, and silences count from where they were;
// more is reported, and nothing that is silent is judged for a while.
struct Overslept {
  static constexpr Duration kBriefly = std::chrono::milliseconds(250);
  Duration by{};
};

// Priors that a fleet learned of strategies: each belief begins from there. A strategy without
// outcomes has the rule file's prior. Pseudo-counts, above zero.
struct PriorsTold {
  struct Prior {
    StrategyId strategy;
    double alpha = 1;
    double beta = 1;
  };
  std::vector<Prior> priors;
  std::string source;  // for people: the fleet that learned it; empty: none
};

// The only publisher of the topic has proven that it knows its subscriber: its messages are
// received from now on.
struct ListenerKnown {
  TopicId topic;
};

// The component cannot be started now, because something that its start needs is not there: a program, a
// file of parameters, a container. Sent again, with nothing missing, once it is.
struct StartBarred {
  ComponentId component;
  std::string missing;  // "there is no program '/opt/robot/driver'"; empty: it can be started
};

// From now on this node is the only accepted publisher of a diagnostic status that the rules name.
struct PublisherKnown {
  std::string status;
  std::string node;
};

// One of these was observed. Copied and destroyed in observation.cpp: see EventWhat (knowledge/event.h) for why.
class ObservationWhat
    : public std::variant<NodeAppeared, NodeVanished, EndpointAppeared, EndpointVanished,
                          SampleArrived, SignalRead, DiagnosticRead, ParameterRead, LifecycleRead,
                          ProcessSeen, Probed, Reply, LinkTrouble, Order, NamesakesSeen,
                          HearingLost, HearingRegained, Overslept, StatusHeard, ParametersListed,
                          ProcessWorked, HostReached, EndsWith, LauncherSeen, PriorsTold, LivesOn,
                          HostHeard, ListenerKnown, StartedHere, UsageSeen, StartBarred,
                          PublisherKnown, GoalsSeen, LogSeen, TimeHeld, ClockStepped, Unloaded> {
 public:
  using Variant = variant;
  using variant::variant;
  ObservationWhat();
  ObservationWhat(const ObservationWhat& other);
  ObservationWhat(ObservationWhat&& other) noexcept;
  ObservationWhat& operator=(const ObservationWhat& other);
  ObservationWhat& operator=(ObservationWhat&& other) noexcept;
  ~ObservationWhat();
};

struct Observation {
  Time at;
  ObservationWhat what;
};

}  // namespace culprit
