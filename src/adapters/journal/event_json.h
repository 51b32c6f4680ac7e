// Events as JSON, by name (knowledge/event_words.h): the rows of the journal, and the basis of the
// page's events (web/event_json.h).
//
// It is here because rows outlive the program: a replay compares hashes of them, so neither their
// words nor their order may change. Code that tells people more adds to it.
#pragma once

#include "journal/json.h"
#include "knowledge/event.h"

namespace culprit::journal {

// {"type": "failure_detected", "rule": "RGBDead", ..., "text": "...", "time": nanoseconds}
std::string line_of(const Event& event, const RuleSet& rules);

// The same, for code that adds to it.
Json to_json(const Event& event, const RuleSet& rules);

// The subject of the event, and how it ended; reasons, remarks, candidates and suspects were for
// people, and are left out. Gives nothing if `json` is no event, if its subject is not in `rules`,
// or for kinds whose rows hold too little: ActionHeldBack, SilenceEnded, NeverSeen, some orders.
std::optional<Event> event_from_json(const Json& json, const RuleSet& rules);

}  // namespace culprit::journal
