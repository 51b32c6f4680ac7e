#include "web/event_json.h"

#include <cmath>

#include "incident_reports/incident_json.h"
#include "journal/event_json.h"
#include "knowledge/describe.h"
#include "rule_test/plan_report.h"

namespace culprit::web {
namespace {

Json to_json(const Candidate& candidate, const RuleSet& rules) {
  const Strategy& strategy = rules[candidate.strategy];
  return {{"strategy", strategy.name},
          {"impact", strategy.impact.count},
          {"cost", candidate.cost},
          {"value", candidate.value},
          {"resolves", candidate.resolves},
          {"excluded", rule_test::exclusion_as_json(candidate, rules)}};
}

// Fields of an event for people, beyond the journal's.
struct Additions {
  const RuleSet& rules;
  Time start;
  Json& json;

  template <class What>
  void operator()(const What& e) const {
    if constexpr (requires { e.strategy.index; })
      json["components"] = names_of(rules[e.strategy].components, rules);
    if constexpr (requires { e.candidates; }) {
      json["candidates"] = Json::array();
      for (const Candidate& c : e.candidates) json["candidates"].push_back(to_json(c, rules));
    }
    if constexpr (std::is_same_v<What, StrategyChosen>)
      json["actions"] = action_list(rules[e.strategy], rules);
    if constexpr (requires { e.retry_at; }) json["retry_at"] = time_to_json(e.retry_at, start);
    if constexpr (requires { e.until; }) json["until"] = time_to_json(e.until, start);
  }
};

}  // namespace

Json time_to_json(Time at, Time start) {
  if (at == kNever || at == kLongAgo) return nullptr;
  return std::round(seconds(at - start) * 1000) / 1000;
}

Json to_json(const EventWords& words) { return incident_reports::to_json(words); }

Json to_json(const Event& event, const RuleSet& rules, Time start) {
  Json json{{"t", time_to_json(event.at, start)}};
  json.update(to_json(words_of(event)));
  json["severity"] = culprit::to_string(severity_of(event, rules));
  json.update(journal::to_json(event, rules));
  json.erase("time");  // of the robot's clock; `t` says it
  std::visit(Additions{rules, start, json}, event.what);
  return json;
}

}  // namespace culprit::web
