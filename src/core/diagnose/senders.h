// The senders of the messages and values that culprit watches, and those that have stopped to send.
#pragma once

#include <optional>
#include <vector>

#include "diagnose/timing.h"

namespace culprit::diagnose {

// The only publisher of a topic, or of that of a field; or the component that a diagnostic is from. Empty: it is not known, or
// the input is about something else.
std::optional<ComponentId> sender_of(const Input& input, const Knowledge& knowledge);

// When the last came of what the component sends all the time; kLongAgo: nothing yet.
Time sent_last(ComponentId component, const Knowledge& knowledge);

// Does a message come from it in time, on a topic that it alone publishes?
bool is_publishing(ComponentId component, const Knowledge& knowledge);

// By component: since when all that it sends has stopped, values of signals included; empty: it has not, or nothing that comes
// regularly is known of it. A diagnostic without a STALE may be sent on change alone: its silence counts if the component
// has given no answer since.
std::vector<std::optional<Onset>> all_stopped(const Knowledge& knowledge);

}  // namespace culprit::diagnose
