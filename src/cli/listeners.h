// The listeners that report what a running culprit does.
#pragma once

#include <memory>

#include "live/listener.h"

namespace culprit::cli {

enum class Audience : std::uint8_t {
  kPeople,   // lines at the terminal, or wherever the output goes
  kPrograms  // what happens as JSON, a document each line, and all else on the standard error output
};

std::unique_ptr<live::Listener> listener_for(Audience audience);

}  // namespace culprit::cli
