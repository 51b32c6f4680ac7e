// The body that all virtual robots' components have: a process, a node, a lifecycle, parameters and
// a mode, and what they answer when they are asked.
//
// The times, the faults and the observers are each robot's own: that of the simulation (node.h),
// that of rule tests, that of the manager's tests, and that of the root-cause benchmark.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "robot/command.h"

namespace culprit::simulation {

// Where `transition` leads to from `state`; nothing: it is not possible there.
std::optional<Lifecycle> after(Transition transition, Lifecycle state);

struct Answer {
  Outcome outcome = Outcome::kDone;
  decltype(Reply::value) value{};
  std::string text{};
};

struct Body {
  ProcessState process = ProcessState::kRunning;
  int pid = 0;                           // of the last process
  bool is_in_graph = true;               // its node; that of a killed process lingers
  bool answers = true;                   // false: it hangs
  Lifecycle state = Lifecycle::kActive;  // kUnknown: it has no lifecycle
  std::map<std::string, Value> parameters;
  std::string mode;

  // Does a node answer requests to the component?
  bool can_answer() const { return process == ProcessState::kRunning && is_in_graph && answers; }
  // A new process, which answers; its node is not there yet.
  void start(int new_pid);
  // The process has exited. Gives whether there was one.
  bool end();

  // Gives whether the transition is possible, and was made.
  bool change(Transition transition);
  // Null if there is none of this name.
  const Value* parameter(const std::string& name) const;
  // Gives whether there is such a parameter, of the value's type.
  bool set_parameter(const std::string& name, const Value& value);

  // The effect of a request on one that can answer, and the answer. A routine succeeds, and any
  // mode can be changed to. @pre `request` is neither StartProcess nor StopProcess
  Answer answer(const decltype(Command::what)& request);
};

}  // namespace culprit::simulation
