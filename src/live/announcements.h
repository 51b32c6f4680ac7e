// Announcements of culprit about itself: they are no events of the manager, but named in the same
// way.
#pragma once

#include "knowledge/event_words.h"

namespace culprit::live::announcements {

inline constexpr EventWords kRole{"role", "role", EventSeverity::kInfo, Tone::kAction};
inline constexpr EventWords kReloaded{"reloaded", "reloaded", EventSeverity::kInfo, Tone::kPerson};
inline constexpr EventWords kKept{"kept", "kept", EventSeverity::kInfo, Tone::kRelief};
inline constexpr EventWords kNeighbour{"neighbour", "neighbour", EventSeverity::kWarning,
                                       Tone::kWarning};
inline constexpr EventWords kNotReloaded{"not_reloaded", "trouble", EventSeverity::kWarning,
                                         Tone::kWarning};
inline constexpr EventWords kBeginsAnew{"begins_anew", "deaf", EventSeverity::kError, Tone::kAlarm,
                                        Weight::kStrong};

}  // namespace culprit::live::announcements
