#include "language/strategy_entries.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "base/sort_unique.h"
#include "language/compiler.h"
#include "language/request_text.h"
#include "language/rule_checks.h"
#include "language/typed_condition.h"

namespace culprit {
namespace {

constexpr double kMaxImpact = 1e6;                     // cycles
constexpr Duration kWithin = std::chrono::seconds(2);  // LASTRESORT without WITHIN

Cycles whole_impact(const std::vector<Adaptation>& adaptations) {
  Cycles whole, step;
  for (const Adaptation& each : adaptations) {
    if (each.begins_step) {
      whole.count += step.count;
      step = {};
    }
    step = std::max(step, each.impact);
  }
  return {whole.count + step.count};
}

std::optional<Edit> in_percent_fix(const syntax::Number& fraction) {
  if (fraction.value < 0.01) return std::nullopt;
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", fraction.value * 100);
  return Edit{fraction.span, text};
}

// Empty if a hundred times the fraction is no whole percentage either.
std::string percent_remedy(const syntax::Number& fraction) {
  const auto fix = in_percent_fix(fraction);
  return "probabilities are in percent" + (fix ? ": write " + fix->text : "");
}

}  // namespace

void StrategyEntries::check_numbers(const syntax::Strategy& written) {
  const auto in_percent = [](const syntax::Number& n) { return n.value > 0 && n.value <= 100; };
  if (!in_percent(written.probability)) {
    report(Code::kProbabilityRange, written.probability.span,
           "a success probability is above 0 and at most 100 percent",
           written.probability.value == 0 ? "a strategy that never helps need not be written down"
                                          : "write how often it helps, in percent, for example 80");
  }
  if (written.probability.value > 0 && written.probability.value < 1) {
    diagnostics_.push_back({Code::kProbabilityRange, Severity::kWarning, written.probability.span,
                            "this success probability is less than one percent",
                            percent_remedy(written.probability),
                            in_percent_fix(written.probability)});
  }
  if (!in_percent(written.confidence)) {
    report(Code::kConfidenceRange, written.confidence.span,
           "a confidence is above 0 and at most 100", "it counts as that many past attempts");
  }
}

void StrategyEntries::add(const syntax::Strategy& written, RuleId rule,
                          RuleConditions* conditions) {
  const StrategyId id(rules_.strategies.size());
  if (conditions != nullptr) conditions->strategies.push_back(&written);
  Strategy strategy;
  strategy.name = written.name.text;
  strategy.rule = rule;
  strategy.is_last_resort = written.is_last_resort;
  if (written.is_last_resort) strategy.within = written.within.value_or(kWithin);
  check_numbers(written);
  strategy.success = percent(written.probability.value);
  strategy.confidence = written.confidence.value;
  if (written.when) {
    if (auto typed = typed_condition(*written.when, "a WHEN condition", symbols_, diagnostics_)) {
      strategy.when = compile(*typed);
      if (conditions != nullptr) conditions->whens.push_back({id, std::move(*typed)});
    }
  }
  if (written.adaptations.empty() && !written.has_broken_adaptation) {
    report(Code::kIncomplete, written.name.span,
           "strategy '" + written.name.text + "' has no ADAPTATION",
           "say what it does: ADAPTATION component restart 5");
  }
  add_adaptations(written, strategy);
  strategy.impact = whole_impact(strategy.adaptations);
  if (!written.has_broken_adaptation) check_contradictions(written, diagnostics_);

  sort_unique(strategy.components);
  auto& touched = rules_.rules[rule.index].components;
  touched.insert(touched.end(), strategy.components.begin(), strategy.components.end());
  rules_.heaviest = std::max(rules_.heaviest, strategy.impact);
  rules_.rules[rule.index].strategies.push_back(id);
  rules_.strategies.push_back(std::move(strategy));
}

void StrategyEntries::add_adaptations(const syntax::Strategy& written, Strategy& strategy) {
  strategy.adaptations.reserve(written.adaptations.size());
  strategy.components.reserve(written.adaptations.size());
  for (const syntax::Adaptation& adaptation : written.adaptations) {
    const auto first = strategy.adaptations.size();
    adaptation.type == AdaptationType::kStartGroup ? add_group(adaptation, strategy)
                                                   : add_adaptation(adaptation, strategy);
    for (auto i = first; i < strategy.adaptations.size(); ++i)
      strategy.adaptations[i].written =
          static_cast<std::uint32_t>(&adaptation - written.adaptations.data());
  }
  const auto begins_step = steps_of(written);
  for (std::size_t i = 0; i < strategy.adaptations.size(); ++i) {
    Adaptation& each = strategy.adaptations[i];
    const bool is_next_of_group = i > 0 && strategy.adaptations[i - 1].written == each.written;
    each.begins_step = is_next_of_group || begins_step[each.written];
  }
}

void StrategyEntries::add_adaptation(const syntax::Adaptation& written, Strategy& strategy) {
  Adaptation adaptation;
  adaptation.component = symbols_.component(written.component);
  adaptation.type = written.type;
  adaptation.subject = written.subject.text;
  adaptation.topic = written.topic.text;
  if (written.request) add_request(*written.request, adaptation);
  if (syntax::names_parameter(written.type))
    adaptation.parameter = symbols_.parameter(adaptation.component, adaptation.subject);
  adaptation.impact = impact_of(written);
  if (written.value) {
    if (auto typed = type_expression(*written.value, symbols_, diagnostics_)) {
      adaptation_value(written, *typed, adaptation);
    }
  }
  strategy.components.push_back(adaptation.component);
  strategy.adaptations.push_back(std::move(adaptation));
}

void StrategyEntries::add_request(const syntax::Name& written, Adaptation& adaptation) {
  adaptation.request = written.text;
  if (auto flaw = flaw_of_request(written.text))
    report(Code::kBadRequest, written.span, std::move(flaw->cause), std::move(flaw->remedy));
}

// Zero: it was reported.
Cycles StrategyEntries::impact_of(const syntax::Adaptation& written) {
  if (written.impact.whole && written.impact.value >= 1 && written.impact.value <= kMaxImpact)
    return {static_cast<std::int64_t>(written.impact.value)};
  report(Code::kImpactRange, written.impact.span,
         written.impact.value > kMaxImpact ? "no impact has so many cycles"
                                           : "an impact is a whole number of cycles, at least 1",
         "count the cycles until the failure is cleared");
  return {};
}

// start_group: each member in its order, as steps; then its manager, where somebody can start that.
// The last one has the impact.
void StrategyEntries::add_group(const syntax::Adaptation& written, Strategy& strategy) {
  const Cycles impact = impact_of(written);
  const auto id = symbols_.group(written.component);
  if (!id || rules_[*id].members.empty()) return;
  const Group& group = rules_[*id];
  const auto add = [&](ComponentId component, AdaptationType type) {
    Adaptation adaptation;
    adaptation.component = component;
    adaptation.type = type;
    adaptation.group = *id;
    strategy.components.push_back(component);
    strategy.adaptations.push_back(std::move(adaptation));
  };
  for (const ComponentId member : group.members) add(member, AdaptationType::kActivate);
  if (rules_[group.manager].can_start_again()) add(group.manager, AdaptationType::kRedeploy);
  strategy.adaptations.back().impact = impact;
}

void StrategyEntries::adaptation_value(const syntax::Adaptation& written, const Typed& typed,
                                       Adaptation& adaptation) {
  const bool changes = written.type != AdaptationType::kSetParameter;
  const bool number = typed.type == Type::kInt || typed.type == Type::kDouble;
  if (changes && !number) {
    report(Code::kTypeMismatch, written.value->span,
           std::string(keyword(written.type)) + " needs a number; this is " + describe(typed.type),
           "write by how much the value changes, or use set_parameter");
  } else if (typed.type == Type::kDuration) {
    report(Code::kTypeMismatch, written.value->span, "ROS parameters hold no durations",
           "write the number that the node expects, for example its seconds");
  } else if (fits_stack(typed, *written.value, diagnostics_)) {
    adaptation.value = compile(typed);
    check_value(written, typed, adaptation.parameter);
  }
}

// Warnings about a value that the node would refuse.
void StrategyEntries::check_value(const syntax::Adaptation& written, const Typed& typed,
                                  ParameterId parameter) {
  const bool is_list = typed.op == Op::kConstant && typed.type == Type::kString &&
                       typed.constant->text.starts_with('[');
  const auto read = symbols_.type_of(parameter);
  const bool fits =
      !read || *read == typed.type || is_list || (is_numeric(*read) && is_numeric(typed.type));
  if (!fits)
    diagnostics_.push_back({Code::kTypeMismatch, Severity::kWarning, written.value->span,
                            "the rules read parameter '" + written.subject.text + "' as " +
                                describe(*read) + ", and this is " + describe(typed.type),
                            "write one type at both places: a node refuses another one"});
  if (is_list && typed.constant->text.find(']') == std::string::npos)
    diagnostics_.push_back({Code::kNoValue, Severity::kWarning, written.value->span,
                            "this list is not closed, so it is sent as a text",
                            "write ']' at its end, as in \"[1, 2]\""});
}

void StrategyEntries::report(Code code, Span span, std::string cause, std::string remedy) {
  diagnostics_.push_back({code, Severity::kError, span, std::move(cause), std::move(remedy)});
}

}  // namespace culprit
