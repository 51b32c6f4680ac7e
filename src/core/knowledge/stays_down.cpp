#include "knowledge/stays_down.h"

namespace culprit {

std::string_view to_string(StaysDown::Why why) {
  switch (why) {
    case StaysDown::Why::kPerson:
      return "person";
    case StaysDown::Why::kDoubt:
      return "doubt";
    case StaysDown::Why::kUnseen:
      return "unseen";
    case StaysDown::Why::kOwner:
      return "owner";
    case StaysDown::Why::kTerminal:
      return "terminal";
    case StaysDown::Why::kShutDown:
      return "shut_down";
    case StaysDown::Why::kStopped:
      return "stopped";
    case StaysDown::Why::kFrozen:
      return "frozen";
    case StaysDown::Why::kUnloaded:
      return "unloaded";
    case StaysDown::Why::kOrder:
      return "order";
  }
  return "";
}

std::optional<StaysDown::Why> reason_named(std::string_view name) {
  using enum StaysDown::Why;
  for (const StaysDown::Why each : {kPerson, kDoubt, kUnseen, kOwner, kTerminal, kShutDown,
                                    kStopped, kFrozen, kUnloaded, kOrder}) {
    if (to_string(each) == name) return each;
  }
  return std::nullopt;
}

}  // namespace culprit
