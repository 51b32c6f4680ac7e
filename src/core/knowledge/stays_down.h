// Components that ended or were stopped by a person's wish, or may have, and are not started again by culprit itself.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "base/ids.h"
#include "base/time.h"

namespace culprit {

struct StaysDown {
  enum class Why : std::uint8_t {
    kPerson,    // a person ended the launch that it belongs to
    kDoubt,     // its launch ended so soon after a crash that it may have ended because of that
    kUnseen,    // it ended with all others while culprit did not run
    kOwner,     // its owner was told to end it (systemctl stop, docker stop)
    kTerminal,  // it ended in the foreground of a terminal (Ctrl-C)
    kShutDown,  // its node was shut down (ros2 lifecycle set … shutdown)
    kStopped,   // a person stopped its process in its terminal (Ctrl-Z)
    kFrozen,    // a person froze it (systemctl freeze, docker pause)
    kUnloaded,  // a person unloaded it from its container (ros2 component unload)
    kOrder      // a person ordered culprit to end what it had started
  };
  std::vector<ComponentId> components;
  Why why = Why::kPerson;
  int launcher = 0;                   // kPerson, kDoubt: its process
  std::optional<ComponentId> fell{};  // kDoubt: this one crashed
  Duration after{};                   // kDoubt: so long before the launch began to end
};

// "person", "doubt", "unseen", "owner", "terminal", "shut_down", "stopped", "frozen", "unloaded", "order"
std::string_view to_string(StaysDown::Why why);
std::optional<StaysDown::Why> reason_named(std::string_view name);

}  // namespace culprit
