// Troubles of a component itself, which count without any rule.
//
// A consumer of a component that exited, hangs or is inactive is an effect of that, also if no rule
// is about the supplier.
#pragma once

#include <optional>

#include "diagnose/timing.h"

namespace culprit::diagnose {

enum class Trouble : std::uint8_t {
  kExited,     // its process is gone
  kStopped,    // its process is stopped (SIGSTOP)
  kLeft,       // its node left the graph
  kStarting,   // its process runs, and its node is not there yet
  kHung,       // its process runs and does not answer: any more, or what it was asked (questions.h)
  kNotActive,  // its lifecycle was active, and is not any more
  kNotYetActive,  // its lifecycle is known and was never active
  kNeverSeen,     // it was not seen yet
  kSilent  // a topic that it alone publishes, at a steady rate, is silent, or all of its signals are
};

// For people, after the component's name: "exited", "hangs".
std::string_view to_string(Trouble trouble);
// Does a component in such a trouble answer no request?
bool answers_nothing(Trouble trouble);

struct TroubleSeen {
  Trouble trouble = Trouble::kExited;
  Onset onset;                     // `earliest` of the first trouble: it hung, and was killed
  std::optional<TopicId> topic{};  // kSilent: that is silent; empty: a signal is
  Time first_onset = kNever;       // the latest onset of the first trouble
  Time began = kLongAgo;           // the earliest onset of this one

  // Have only the values of its signals stopped?
  bool is_of_values() const { return trouble == Trouble::kSilent && !topic; }
};

// The worst known trouble of the component now; empty: no trouble is known. A component on an
// unreachable computer has none, because its state is unknown.
std::optional<TroubleSeen> trouble_of(ComponentId component, const Knowledge& knowledge);

// By component, for all of them.
std::vector<std::optional<TroubleSeen>> all_troubles(const Knowledge& knowledge);

}  // namespace culprit::diagnose
