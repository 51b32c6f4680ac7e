#include "robot/command.h"

namespace culprit {
namespace {

struct Describe {
  std::string operator()(const ChangeLifecycle& c) const {
    switch (c.transition) {
      case Transition::kConfigure:
        return "configure";
      case Transition::kCleanup:
        return "cleanup";
      case Transition::kActivate:
        return "activate";
      case Transition::kDeactivate:
        return "deactivate";
    }
    return "?";
  }
  std::string operator()(const ReadLifecycle&) const { return "read lifecycle state"; }
  std::string operator()(const SetParameter& c) const {
    return "set " + c.name + " to " + culprit::to_string(c.value);
  }
  std::string operator()(const ReadParameter& c) const { return "read parameter " + c.name; }
  std::string operator()(const CallService& c) const {
    return "call " + c.service + (c.request.empty() ? "" : " with " + c.request);
  }
  std::string operator()(const ChangeMode& c) const { return "change mode to " + c.mode; }
  std::string operator()(const ReadMode&) const { return "read mode"; }
  std::string operator()(const StopProcess&) const { return "stop process"; }
  std::string operator()(const StartProcess&) const { return "start process"; }
  std::string operator()(const Probe&) const { return "ask whether it answers"; }
};

}  // namespace

bool is_read(const Command& command) {
  return std::holds_alternative<ReadLifecycle>(command.what) ||
         std::holds_alternative<ReadParameter>(command.what) ||
         std::holds_alternative<ReadMode>(command.what) ||
         std::holds_alternative<Probe>(command.what);
}

std::string to_string(const Command& command) { return std::visit(Describe{}, command.what); }

}  // namespace culprit
