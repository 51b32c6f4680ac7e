// What is wrong with a component itself, whatever the rules say of it.
//
// A supplier counts without a rule: a consumer of a component that exited, hangs or is inactive is
// an effect of that, also if nobody wrote a rule about the supplier.
#pragma once

#include <optional>

#include "diagnose/timing.h"

namespace culprit::diagnose {

enum class Trouble : std::uint8_t {
  kExited,     // its process is gone
  kStopped,    // its process is stopped (SIGSTOP)
  kLeft,       // its node left the graph
  kHung,       // its process runs and does not answer: any more, or what it was asked (questions.h)
  kNotActive,  // its lifecycle was active, and is not any more
  kNotYetActive,  // its lifecycle is known and was never active
  kNeverSeen,     // it was not seen yet
  kSilent         // a topic that it alone publishes, at a steady rate, is silent
};

// For people, after the component's name: "exited", "hangs".
std::string_view to_string(Trouble trouble);

struct TroubleSeen {
  Trouble trouble = Trouble::kExited;
  Onset onset;
};

// The worst that is known of the component now; nothing: no trouble is known. What is on a computer
// that is not heard is not in trouble: nothing is known of it.
std::optional<TroubleSeen> trouble_of(ComponentId component, const Knowledge& knowledge);

// By component, for all of them.
std::vector<std::optional<TroubleSeen>> all_troubles(const Knowledge& knowledge);

}  // namespace culprit::diagnose
