#include "rule_test/plan_report.h"

#include <algorithm>

#include <fmt/core.h>

#include "analyze/near_trigger.h"
#include "knowledge/describe.h"
#include "manager/restrained_planner.h"

namespace culprit::rule_test {
namespace {

constexpr std::size_t kMostNearTriggers = 3;

// Inputs of triggers without a value.
std::vector<std::string> unknown_inputs(const Knowledge& knowledge) {
  std::vector<std::string> unknown;
  for (std::size_t i = 0; i < knowledge.rules.inputs.size(); ++i) {
    const Input& input = knowledge.rules.inputs[i];
    if (!input.readers.empty() && !knowledge.signals[InputId(i)].known)
      unknown.push_back(describe(input, knowledge.rules));
  }
  return unknown;
}

std::vector<std::string> names_of(const auto& ids, const RuleSet& rules) {
  std::vector<std::string> names;
  for (const auto id : ids) names.push_back(rules[id].name);
  return names;
}

// One sentence, as culprit run says it.
std::string sentence(const plan::ExplainedDecision& explained, const RuleSet& rules) {
  const Decision& decision = explained.decision;
  if (decision.chosen) {
    return describe(
        Event{{}, StrategyChosen{*decision.chosen, decision.candidates, explained.explains, true}},
        rules);
  }
  if (decision.is_spent) return describe(Event{{}, RoundSpent{decision.rule, {}}}, rules);
  const auto withheld =
      std::find_if(decision.candidates.begin(), decision.candidates.end(),
                   [](const Candidate& c) { return c.excluded == Condition::kWithheld; });
  if (withheld == decision.candidates.end())
    return describe(Event{{}, FailureHeldBack{decision.rule, decision.candidates}}, rules);
  ActionHeldBack held;
  held.strategy = withheld->strategy;
  held.reason = withheld->remark;
  return describe(Event{{}, held}, rules);
}

// Chosen, and not begun.
void hold_back(plan::ExplainedDecision& explained, const std::string& reason,
               const RuleSet& rules) {
  for (Candidate& candidate : explained.decision.candidates) {
    if (candidate.strategy != explained.decision.chosen) continue;
    candidate.excluded = Condition::kWithheld;
    candidate.component = rules[candidate.strategy].components.front();
    candidate.remark = reason;
  }
  explained.decision.chosen.reset();
  explained.explains.clear();
}

std::optional<double> seconds_failing(RuleId rule, const PlanReport& report) {
  if (!report.now) return std::nullopt;
  return seconds(*report.now - report.knowledge.states[rule].failing_since);
}

// ---- for people

std::string quantity(double value, const Input& input) {
  return fmt::format("{:g}{}", value, input.type == Type::kDuration ? " s" : "");
}

std::string nearness(const NearTrigger& near, const RuleSet& rules) {
  const Input& input = rules[near.input];
  return fmt::format("{}: {} is {}, compared with {}", rules[near.rule].name,
                     describe(input, rules), quantity(near.value, input),
                     quantity(near.threshold, input));
}

std::string candidate_table(const Decision& decision, const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  std::size_t width = std::string_view("strategy").size();
  for (const Candidate& c : decision.candidates)
    width = std::max(width, rules[c.strategy].name.size());
  std::string out = fmt::format("  {:<{}}  success  impact   cost\n", "strategy", width);
  for (const Candidate& c : decision.candidates) {
    out +=
        fmt::format("  {:<{}}  {:>7}  {:>6}  {:>5.2f}  {}\n", rules[c.strategy].name, width,
                    to_string(knowledge.beliefs[c.strategy].mean()), rules[c.strategy].impact.count,
                    c.cost, c.excluded ? describe_exclusion(c, rules) : "chosen");
  }
  return out;
}

std::string evidence_as_text(const Decision& decision, const RuleSet& rules) {
  std::string out;
  for (const Suspect& suspect : decision.suspects) {
    out += fmt::format(
        "  {} with {:.0f} %{}\n", rules[suspect.component].name, 100 * suspect.probability,
        suspect.failure == decision.rule ? "" : ", by " + rules[suspect.failure].name);
    for (const Evidence& each : suspect.evidence) out += "    " + describe(each) + "\n";
  }
  return out.empty() ? out : out + "\n";
}

std::string flips_as_text(const plan::ExplainedDecision& explained, const Knowledge& knowledge) {
  std::string out;
  for (std::size_t i = 0; i < explained.flips.size(); ++i) {
    const auto& flips = explained.flips[i];
    const StrategyId loser = explained.decision.candidates[i].strategy;
    for (std::size_t f = 0; f < flips.size(); ++f) {
      out += f == 0 ? "  " + knowledge.rules[loser].name + " would be chosen if\n" : "";
      out += "    " + std::string(f == 0 ? "" : "or ") +
             plan::describe(flips[f], loser, knowledge) + "\n";
    }
  }
  return out;
}

std::string as_text(const plan::ExplainedDecision& explained, const PlanReport& report) {
  const RuleSet& rules = report.knowledge.rules;
  const RuleId rule = explained.decision.rule;
  const auto failing = seconds_failing(rule, report);
  return fmt::format(
             "{} ({}{})\n  {}\n\n", rules[rule].name, to_string(rules[rule].policies.criticality),
             failing ? fmt::format(", for {:.1f} s", *failing) : "", sentence(explained, rules)) +
         evidence_as_text(explained.decision, rules) +
         candidate_table(explained.decision, report.knowledge) +
         flips_as_text(explained, report.knowledge) + "\n";
}

// ---- for programs

struct AsJson {
  const RuleSet& rules;

  Json operator()(const plan::SuccessChange& c) const {
    Json json = about("success", c.strategy);
    json["success"] = c.success.value;
    return json;
  }
  Json operator()(const plan::ImpactChange& c) const {
    Json json = about("impact", c.strategy);
    json["impact"] = c.impact.count;
    return json;
  }
  Json operator()(const plan::TriedChange& c) const {
    Json json = about("tried", c.strategy);
    json["tried"] = c.is_tried;
    return json;
  }
  Json operator()(const plan::ResolvedChange& c) const {
    return {{"kind", "resolved"}, {"rules", names_of(c.rules, rules)}};
  }
  Json operator()(const plan::ComponentChange& c) const {
    constexpr const char* kSituations[] = {"alive", "active", "inactive", "absent", "launchable"};
    return {{"kind", "component"},
            {"component", rules[c.component].name},
            {"situation", kSituations[static_cast<std::size_t>(c.situation)]}};
  }
  Json operator()(const plan::WhenChange& c) const { return about("when", c.strategy); }

  Json about(const char* kind, StrategyId strategy) const {
    return {{"kind", kind},
            {"rule", rules[rules[strategy].rule].name},
            {"strategy", rules[strategy].name}};
  }
};

Json candidate_as_json(const plan::ExplainedDecision& explained, std::size_t place,
                       const Knowledge& knowledge) {
  const Candidate& candidate = explained.decision.candidates[place];
  const Strategy& strategy = knowledge.rules[candidate.strategy];
  Json json{{"strategy", strategy.name},
            {"success", knowledge.beliefs[candidate.strategy].mean().value},
            {"impact", strategy.impact.count},
            {"cost", candidate.cost},
            {"chosen", explained.decision.chosen == candidate.strategy},
            {"excluded", exclusion_as_json(candidate, knowledge.rules)},
            {"flips", Json::array()}};
  for (const plan::Change& change : explained.flips[place]) {
    Json flip = std::visit(AsJson{knowledge.rules}, change);
    flip["text"] = plan::describe(change, candidate.strategy, knowledge);
    json["flips"].push_back(std::move(flip));
  }
  return json;
}

Json decision_as_json(const plan::ExplainedDecision& explained, const PlanReport& report) {
  const RuleSet& rules = report.knowledge.rules;
  const Decision& decision = explained.decision;
  Json json{{"rule", rules[decision.rule].name},
            {"criticality", to_string(rules[decision.rule].policies.criticality)}};
  if (const auto failing = seconds_failing(decision.rule, report)) json["failing_s"] = *failing;
  json["chosen"] = nullptr;
  json["blamed"] = Json::array();
  if (decision.chosen) {
    json["chosen"] = rules[*decision.chosen].name;
    json["blamed"] = names_of(rules[*decision.chosen].components, rules);
  }
  json["spent"] = decision.is_spent;
  json["explains"] = names_of(explained.explains, rules);
  json["text"] = sentence(explained, rules);
  json["candidates"] = Json::array();
  for (std::size_t i = 0; i < decision.candidates.size(); ++i)
    json["candidates"].push_back(candidate_as_json(explained, i, report.knowledge));
  return json;
}

}  // namespace

Json exclusion_as_json(const Candidate& candidate, const RuleSet& rules) {
  if (!candidate.excluded) return nullptr;
  Json json{{"condition", to_string(*candidate.excluded)}};
  const bool is_about_component =
      *candidate.excluded != Condition::kTried && *candidate.excluded != Condition::kOneEach;
  if (is_about_component) json["component"] = rules[candidate.component].name;
  if (candidate.failure) json["failure"] = rules[*candidate.failure].name;
  json["text"] = describe_exclusion(candidate, rules);
  const std::string end = describe_end_of_wait(candidate, rules);
  if (!end.empty()) json["ends"] = end;
  return json;
}

PlanReport::PlanReport(const Planner& planner, std::vector<RuleId> failures,
                       const Knowledge& plan_knowledge, const std::optional<std::string>& held_back)
    : knowledge(plan_knowledge),
      decisions(plan::decide(RestrainedPlanner(planner), std::move(failures), plan_knowledge)) {
  if (!held_back) return;
  for (plan::ExplainedDecision& explained : decisions)
    hold_back(explained, *held_back, knowledge.rules);
}

std::string plan_as_text(const PlanReport& report) {
  const RuleSet& rules = report.knowledge.rules;
  std::string out;
  for (const plan::ExplainedDecision& explained : report.decisions)
    out += as_text(explained, report);
  if (report.decisions.empty()) {
    out += "No failure awaits a decision.\n";
    const auto near = near_triggers(report.knowledge, kMostNearTriggers);
    for (const NearTrigger& n : near)
      out += (&n == &near.front() ? "Nearest to a failure:\n  " : "  ") + nearness(n, rules) + "\n";
  }
  const auto unknown = unknown_inputs(report.knowledge);
  if (!unknown.empty()) out += "Unknown, and so no failure yet: " + listed(unknown) + "\n";
  return out;
}

Json plan_as_json(const PlanReport& report) {
  const RuleSet& rules = report.knowledge.rules;
  Json json{{"robot", rules.robot}, {"failures", Json::array()}, {"near", Json::array()}};
  for (const plan::ExplainedDecision& explained : report.decisions)
    json["failures"].push_back(decision_as_json(explained, report));
  for (const NearTrigger& near : near_triggers(report.knowledge, kMostNearTriggers)) {
    json["near"].push_back({{"rule", rules[near.rule].name},
                            {"input", describe(rules[near.input], rules)},
                            {"value", near.value},
                            {"threshold", near.threshold}});
  }
  json["unknown"] = unknown_inputs(report.knowledge);
  return json;
}

}  // namespace culprit::rule_test
