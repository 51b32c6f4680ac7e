#include "web/event_json.h"

#include <cmath>

#include "knowledge/describe.h"

namespace culprit::web {
namespace {

Json of_strategy(const char* kind, StrategyId id, const RuleSet& rules) {
  const Strategy& strategy = rules[id];
  return {{"kind", kind},
          {"rule", rules[strategy.rule].name},
          {"strategy", strategy.name},
          {"components", names_of(strategy.components, rules)}};
}

void add_reasons(Json& json, const auto& event, const RuleSet& rules) {
  json["candidates"] = Json::array();
  for (const Candidate& c : event.candidates) json["candidates"].push_back(to_json(c, rules));
  json["suspects"] = Json::array();
  for (const Suspect& s : event.suspects) json["suspects"].push_back(to_json(s, rules));
}

struct AsJson {
  const RuleSet& rules;
  Time start;

  Json operator()(const FailureDetected& e) const {
    return {{"kind", "detected"},
            {"rule", rules[e.rule].name},
            {"criticality", to_string(rules[e.rule].policies.criticality)}};
  }
  Json operator()(const FailureResolved& e) const {
    Json json{{"kind", "resolved"}, {"rule", rules[e.rule].name}};
    json["strategy"] = e.strategy ? Json(rules[*e.strategy].name) : Json(nullptr);
    json["reaction_s"] = seconds(e.reaction);
    return json;
  }
  Json operator()(const FailureLost& e) const {
    return {{"kind", "lost_sight"}, {"rule", rules[e.rule].name}};
  }
  Json operator()(const StrategyChosen& e) const {
    Json json = of_strategy("decided", e.strategy, rules);
    json["explains"] = names_of(e.explains, rules);
    json["dry_run"] = e.dry_run;
    json["actions"] = Json::array();
    for (const Adaptation& a : rules[e.strategy].adaptations)
      json["actions"].push_back(describe(a, rules));
    add_reasons(json, e, rules);
    return json;
  }
  Json operator()(const FailureHeldBack& e) const {
    Json json{{"kind", "waiting"}, {"rule", rules[e.rule].name}};
    add_reasons(json, e, rules);
    return json;
  }
  Json operator()(const AdaptationDone& e) const { return of_strategy("done", e.strategy, rules); }
  Json operator()(const AdaptationFailed& e) const {
    return of_strategy("failed", e.strategy, rules);
  }
  Json operator()(const StrategyFailed& e) const {
    return of_strategy("no_help", e.strategy, rules);
  }
  Json operator()(const StrategyResumed& e) const {
    return of_strategy("resumed", e.strategy, rules);
  }
  Json operator()(const OutcomePending& e) const {
    Json json = of_strategy("outcome_pending", e.strategy, rules);
    json["helped"] = e.has_helped;
    json["due"] = time_to_json(e.due, start);
    return json;
  }
  Json operator()(const OutcomeCounted& e) const {
    Json json = of_strategy("outcome_counted", e.strategy, rules);
    json["as"] = culprit::to_string(e.as);
    return json;
  }
  Json operator()(const FailureFlaps& e) const {
    return {{"kind", "flapping"}, {"rule", rules[e.rule].name}, {"times", e.times}};
  }
  Json operator()(const LastResortReached& e) const {
    return {{"kind", "last_resort"}, {"rule", rules[e.rule].name}};
  }
  Json operator()(const Undone& e) const {
    Json json = of_strategy("undone", e.strategy, rules);
    json["succeeded"] = e.succeeded;
    return json;
  }
  Json operator()(const RoundSpent& e) const {
    return {{"kind", "pause"},
            {"rule", rules[e.rule].name},
            {"retry_at", time_to_json(e.retry_at, start)}};
  }
  Json operator()(const RuleExhausted& e) const {
    return {{"kind", "exhausted"}, {"rule", rules[e.rule].name}};
  }
  Json operator()(const ComponentLost& e) const {
    return {{"kind", "lost"}, {"component", rules[e.component].name}};
  }
  Json operator()(const ComponentFound& e) const {
    return {{"kind", "found"}, {"component", rules[e.component].name}};
  }
  Json operator()(const NeverSeen& e) const {
    Json json{{"kind", "never_seen"}};
    if (const auto* component = std::get_if<ComponentId>(&e.what))
      json["component"] = rules[*component].name;
    return json;
  }
  Json operator()(const LifecycleIntended& e) const {
    return {{"kind", "lifecycle"}, {"component", rules[e.component].name}};
  }
  Json operator()(const CameUp& e) const {
    return {{"kind", "came_up"}, {"component", rules[e.component].name}};
  }
  Json operator()(const RivalSeen& e) const {
    return {{"kind", "rival"}, {"component", rules[e.component].name}};
  }
  Json operator()(const Trouble&) const { return {{"kind", "trouble"}}; }
  Json operator()(const OrderAccepted& e) const { return of_order("order", e.order); }
  Json operator()(const OrderRefused& e) const { return of_order("order_refused", e.order); }
  Json operator()(const ActionHeldBack& e) const {
    Json json = of_strategy("held_back", e.strategy, rules);
    json["until"] = time_to_json(e.until, start);
    return json;
  }
  Json operator()(const ApprovalAsked& e) const {
    Json json = of_strategy("approval_asked", e.strategy, rules);
    add_reasons(json, e, rules);
    return json;
  }
  Json operator()(const ApprovalLapsed& e) const {
    return of_strategy("approval_lapsed", e.strategy, rules);
  }
  Json operator()(const StrategyAbandoned& e) const {
    return of_strategy("abandoned", e.strategy, rules);
  }
  Json operator()(const OrderCarriedOut& e) const {
    return of_strategy("carried_out", e.strategy, rules);
  }
  Json operator()(const SilenceEnded&) const { return {{"kind", "silence_ended"}}; }
  Json operator()(const StormBegan&) const { return {{"kind", "storm"}}; }
  Json operator()(const StormEnded&) const { return {{"kind", "calm"}}; }
  Json operator()(const JudgementSuspended&) const { return {{"kind", "deaf"}}; }
  Json operator()(const JudgementResumed&) const { return {{"kind", "hears"}}; }
  Json operator()(const SleepNoticed&) const { return {{"kind", "slept"}}; }

  static Json of_order(const char* kind, const Order& order) {
    return {{"kind", kind},
            {"number", order.number},
            {"author", order.author},
            {"reason", order.reason}};
  }
};

}  // namespace

Json time_to_json(Time at, Time start) {
  if (at == kNever || at == kLongAgo) return nullptr;
  return std::round(seconds(at - start) * 1000) / 1000;
}

Json to_json(const Candidate& candidate, const RuleSet& rules) {
  const Strategy& strategy = rules[candidate.strategy];
  Json json{{"strategy", strategy.name},      {"impact", strategy.impact.count},
            {"cost", candidate.cost},         {"value", candidate.value},
            {"resolves", candidate.resolves}, {"excluded", nullptr}};
  if (candidate.excluded) {
    json["excluded"] = {{"condition", to_string(*candidate.excluded)},
                        {"text", describe_exclusion(candidate, rules)}};
    if (candidate.because) json["excluded"]["because"] = rules[*candidate.because].name;
  }
  return json;
}

Json to_json(const Suspect& suspect, const RuleSet& rules) {
  return {{"component", rules[suspect.component].name},
          {"failure", rules[suspect.failure].name},
          {"probability", suspect.probability}};
}

Json to_json(const Event& event, const RuleSet& rules, Time start) {
  Json json{{"t", time_to_json(event.at, start)}};
  json.update(std::visit(AsJson{rules, start}, event.what));
  json["text"] = describe(event, rules);
  return json;
}

std::string to_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace culprit::web
