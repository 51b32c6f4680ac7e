#include "ros_api/decision_message.h"

#include "knowledge/describe.h"
#include "web/event_json.h"

namespace culprit::ros_api {
namespace {

constexpr std::string_view kDecision = "culprit_msgs/msg/Decision";

Json candidate_message(const Candidate& candidate, const RuleSet& rules) {
  Json message = strategy_message(candidate.strategy, rules);
  message["is_chosen"] = !candidate.excluded;
  if (candidate.excluded) message["excluded"] = describe_exclusion(candidate, rules);
  message["resolves"] = candidate.resolves;
  message["cost"] = candidate.cost;
  return message;
}

// The kind of decision of each event; empty: none.
struct KindOf {
  std::string_view operator()(const StrategyChosen& e) const {
    return e.dry_run ? "KIND_ADVISED" : "KIND_BEGUN";
  }
  std::string_view operator()(const FailureResolved& e) const {
    return e.how == FailureResolved::How::kByStrategy ? "KIND_SUCCEEDED" : "KIND_RECOVERED";
  }
  std::string_view operator()(const ApprovalAsked&) const { return "KIND_ASKED"; }
  std::string_view operator()(const ApprovalLapsed&) const { return "KIND_LAPSED"; }
  std::string_view operator()(const FailureHeldBack&) const { return "KIND_HELD_BACK"; }
  std::string_view operator()(const ActionHeldBack&) const { return "KIND_HELD_BACK"; }
  std::string_view operator()(const StrategyFailed&) const { return "KIND_FAILED"; }
  std::string_view operator()(const StrategyAbandoned&) const { return "KIND_ABANDONED"; }
  std::string_view operator()(const StrategyResumed&) const { return "KIND_RESUMED"; }
  std::string_view operator()(const OrderCarriedOut&) const { return "KIND_SUCCEEDED"; }
  std::string_view operator()(const RuleExhausted&) const { return "KIND_EXHAUSTED"; }
  std::string_view operator()(const auto&) const { return ""; }
};

// Adds the members about the event's subject.
struct Additions {
  const RuleSet& rules;
  Json& message;

  void operator()(const auto& e) const {
    if constexpr (requires { e.rule.index; }) message["rule"] = rules[e.rule].name;
    if constexpr (requires { e.strategy.index; }) about(e.strategy);
    if constexpr (requires { e.strategy->index; }) {
      if (e.strategy) about(*e.strategy);
    }
    if constexpr (requires { e.explains; }) message["explains"] = web::names_of(e.explains, rules);
    if constexpr (requires { e.candidates; }) {
      message["candidates"] = Json::array();
      for (const Candidate& each : e.candidates)
        message["candidates"].push_back(candidate_message(each, rules));
    }
  }
  void about(StrategyId strategy) const {
    message["rule"] = rules[rules[strategy].rule].name;
    message["strategy"] = rules[strategy].name;
    message["components"] = web::names_of(rules[strategy].components, rules);
  }
};

}  // namespace

Json strategy_message(StrategyId strategy, const RuleSet& rules) {
  return {{"rule", rules[rules[strategy].rule].name},
          {"name", rules[strategy].name},
          {"components", web::names_of(rules[strategy].components, rules)},
          {"actions", action_list(rules[strategy], rules)},
          {"resolves", nullptr},
          {"cost", nullptr}};
}

std::optional<Json> decision_message(const Event& event, const RuleSet& rules,
                                     const CulpritTypes& types, WallTime wall) {
  const std::string_view kind = std::visit(KindOf(), event.what);
  if (kind.empty()) return std::nullopt;
  Json message{{"stamp", stamp_of(wall)},
               {"kind", types.constant(kDecision, kind)},
               {"text", describe(event, rules)}};
  std::visit(Additions{rules, message}, event.what);
  return message;
}

}  // namespace culprit::ros_api
