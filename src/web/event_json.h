// Events of the manager as JSON (docs/web.md): a row of the journal (journal/event_json.h), and the
// fields that the page needs to show it without a table of its own.
#pragma once

#include "json/json.h"
#include "knowledge/event_words.h"

namespace culprit::web {

// Seconds since `start`, to the millisecond; null for kNever and kLongAgo.
Json time_to_json(Time at, Time start);

// For example of components or rules.
Json names_of(const auto& ids, const RuleSet& rules) {
  Json names = Json::array();
  for (const auto id : ids) names.push_back(rules[id].name);
  return names;
}

Json to_json(const Event& event, const RuleSet& rules, Time start);
// {"type": ..., "label": ..., "severity": ..., "tone": ...}
Json to_json(const EventWords& words);

}  // namespace culprit::web
