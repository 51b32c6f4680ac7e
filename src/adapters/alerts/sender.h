// Sends one alert to one destination: over HTTP or HTTPS, or to a program.
#pragma once

#include <atomic>
#include <string>

#include "alerts/alert.h"
#include "alerts/settings.h"

namespace culprit::alerts {

struct Sent {
  enum class How : std::uint8_t {
    kSent,
    kNotNow,  // another try may help: no answer, or the destination is overloaded
    kNever    // it refuses what it is sent, or the program is not there
  };
  How how = How::kSent;
  std::string why{};  // why not; holds no secrets
};

// Blocks, for `patience` at most and a moment, however slow or hostile the other side is; less if
// `stop` is set. A program gets the text of the alert as its last argument, and as JSON in
// CULPRIT_ALERT.
// @pre SIGPIPE is ignored, as StopSignals does: the other side may hang up.
Sent send(const Destination& destination, const Alert& alert, Duration patience,
          const std::atomic<bool>& stop);

}  // namespace culprit::alerts
