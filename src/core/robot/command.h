// Commands to the robot: the only way out for adaptations.
//
// A command is one request that an adapter carries out without being asked twice; its Reply carries
// the same number. Reads may be repeated on the wire until they are answered; the others go out
// exactly once.
#pragma once

#include <string>
#include <variant>

#include "robot/observation.h"

namespace culprit {

// Transitions of a managed node that a manager asks for (lifecycle_msgs/Transition).
enum class Transition : std::uint8_t { kConfigure, kCleanup, kActivate, kDeactivate };

struct ChangeLifecycle {
  Transition transition;
};
struct ReadLifecycle {};

struct SetParameter {
  std::string name;
  Value value;
};
struct ReadParameter {
  std::string name;
};

// A routine of the component, of any type of service. `service` is absolute; `request` is what it is
// asked, as YAML ("data: true"); empty: nothing, as of std_srvs/srv/Trigger.
struct CallService {
  std::string service;
  std::string request{};
};

// system_modes_msgs/srv/{ChangeMode,GetMode}.
struct ChangeMode {
  std::string mode;
};
// Read back as kUnknownMode while what its parts are in fits no mode.
struct ReadMode {};
inline constexpr const char* kUnknownMode = "unknown";

// A question that changes nothing, to learn whether the node answers at all: kDone if it does.
struct Probe {};

// Ends the component's process: politely, then harder, until it is proven gone. Done when it is
// gone, also if it was.
struct StopProcess {
  int pid = 0;         // which one is meant; 0 = the one that was started or adopted last
  bool hangs = false;  // it is not expected to act on a polite signal
};

// Starts the component's LAUNCH command. Done when the process runs; that the node joins the graph
// is seen there.
struct StartProcess {};

// The purpose of a command, for the part that has to finish it or to undo its change.
struct Purpose {
  StrategyId strategy;
  std::uint32_t adaptation = 0;  // index in Strategy::adaptations
  bool undoes = false;           // it brings back what an earlier command changed
  // The value that it is going to change, as read before; for a redeploy the lifecycle state to
  // restore.
  decltype(Reply::value) before{};
};

struct Command {
  CommandId id;
  ComponentId component;
  std::variant<ChangeLifecycle, ReadLifecycle, SetParameter, ReadParameter, CallService, ChangeMode,
               ReadMode, StopProcess, StartProcess, Probe>
      what;
  Duration timeout{};  // after which the adapter answers kTimedOut
  Purpose purpose{};
};

// Whether it only looks.
bool is_read(const Command& command);

// The request in words: "set exposure to 0.5".
std::string to_string(const Command& command);

}  // namespace culprit
