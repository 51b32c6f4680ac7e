#include "language/conflict_checks.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>

#include "base/invariant.h"
#include "language/compiler.h"
#include "language/evaluate.h"
#include "language/facts.h"

namespace culprit {
namespace {

// At most this many of one kind are compared with each other: more would only make checking slow,
// and give too many warnings to read.
constexpr std::size_t kMaxCompared = 64;

// Whether the two can be so at the same time.
bool is_possible(const Typed& a, bool a_truth, const Typed& b, bool b_truth, const RuleSet& rules) {
  if (!is_small_enough(a) || !is_small_enough(b)) return true;
  Facts facts(rules);
  for (int round = 0; round < 2; ++round) {
    if (!facts.assume(a, a_truth) || !facts.assume(b, b_truth)) return false;
  }
  return true;
}

// The input of a trigger that is one comparison with a constant.
std::optional<InputId> only_input(const Typed& trigger) {
  if (trigger.children.size() != 2 || trigger.children[0].type == Type::kBool) return std::nullopt;
  for (const std::size_t side : {0u, 1u}) {
    const Typed& here = trigger.children[side];
    const Typed& leaf = here.op == Op::kIntToDouble ? here.children[0] : here;
    if (leaf.op == Op::kInput && !reads_inputs(trigger.children[1 - side])) return leaf.input;
  }
  return std::nullopt;
}

// Whether `rule` has detected a failure by the time when one of the same trigger and the policies
// of `other` detects it.
bool is_no_slower(const Policies& rule, const Policies& other) {
  return !rule.on_change && rule.hold_for <= other.hold_for && rule.cooldown <= other.cooldown &&
         rule.hold_needed == other.hold_needed && rule.hold_window == other.hold_window;
}

bool covers(const RuleConditions& strong, const RuleConditions& weak, const RuleSet& rules) {
  const Rule& s = rules[strong.rule];
  const Rule& w = rules[weak.rule];
  return s.components == w.components && !w.components.empty() &&
         s.policies.criticality >= w.policies.criticality && is_no_slower(s.policies, w.policies) &&
         !is_possible(weak.trigger, true, strong.trigger, false, rules);
}

// The effect of an adaptation: a state of one thing that another adaptation can change.
struct Effect {
  std::string thing;
  std::string state;
  std::string verb;                        // for messages: "activates", "sets exposure to 3"
  std::optional<ParameterId> parameter{};  // that it sets to a constant
  Slot value{};
  Type type = Type::kDouble;
};

std::optional<Effect> effect_of(const Adaptation& a) {
  const auto of_component = [&](const std::string& what) {
    return std::to_string(a.component.index) + what;
  };
  switch (a.type) {
    case AdaptationType::kActivate:
      return Effect{of_component(" lifecycle"), "active", "activates it"};
    case AdaptationType::kDeactivate:
      return Effect{of_component(" lifecycle"), "inactive", "deactivates it"};
    case AdaptationType::kStart:
      return Effect{of_component(" process"), "started", "starts it"};
    case AdaptationType::kStop:
      return Effect{of_component(" process"), "stopped", "stops it"};
    case AdaptationType::kChangeCommunication:
      return Effect{of_component(" parameter " + a.subject), "\"" + a.topic + "\"",
                    "sets its " + a.subject + " to " + a.topic};
    case AdaptationType::kSetParameter: {
      const bool is_constant =
          !a.value.empty() && std::none_of(a.value.code.begin(), a.value.code.end(),
                                           [](const auto& i) { return i.op == Op::kInput; });
      if (!is_constant) return std::nullopt;
      const Slot slot = evaluate(a.value, {});
      if (!slot.known) return std::nullopt;
      // A whole number fits a parameter of numbers, so 1 and 1.0 are no different.
      const Value value = a.value.type == Type::kInt ? Value(static_cast<double>(slot.i))
                                                     : to_value(slot, a.value.type);
      return Effect{of_component(" parameter " + a.subject),
                    to_string(value),
                    "sets its " + a.subject + " to " + to_string(to_value(slot, a.value.type)),
                    a.parameter,
                    slot,
                    a.value.type};
    }
    case AdaptationType::kIncreaseParameter:
      return Effect{of_component(" parameter " + a.subject), "more", "increases its " + a.subject};
    case AdaptationType::kDecreaseParameter:
      return Effect{of_component(" parameter " + a.subject), "less", "decreases its " + a.subject};
    case AdaptationType::kRestart:
    case AdaptationType::kRedeploy:
    case AdaptationType::kChangeMode:
    case AdaptationType::kCall:
    case AdaptationType::kStartGroup:
      break;
  }
  return std::nullopt;
}

// An adaptation that leaves something behind.
struct Doing {
  const RuleConditions* rule;
  StrategyId strategy;
  ComponentId component;
  Span span;
  Effect effect;
};

std::vector<Doing> doings_of(const RuleConditions& rule, const RuleSet& rules) {
  std::vector<Doing> doings;
  for (std::size_t s = 0; s < rule.strategies.size(); ++s) {
    const StrategyId strategy = rules[rule.rule].strategies[s];
    const auto& adaptations = rules[strategy].adaptations;
    for (std::size_t i = 0; i < adaptations.size(); ++i) {
      auto effect = effect_of(adaptations[i]);
      if (!effect) continue;
      // The effect of a step is not left behind if a later step changes the same thing.
      std::erase_if(doings, [&](const Doing& earlier) {
        return earlier.strategy == strategy && earlier.effect.thing == effect->thing;
      });
      const Span span = rule.strategies[s]->adaptations[adaptations[i].written].span;
      doings.push_back({&rule, strategy, adaptations[i].component, span, std::move(*effect)});
    }
  }
  return doings;
}

bool take_turns(const RuleConditions& a, const RuleConditions& b, const RuleSet& rules) {
  return is_possible(a.trigger, true, b.trigger, true, rules) ||
         !is_possible(a.trigger, false, b.trigger, false, rules);
}

// Does the parameter's value, as `effect` sets it, make the trigger true by itself?
bool sets_off(const Effect& effect, RuleId rule, const RuleSet& rules) {
  if (!effect.parameter) return false;
  const auto reads_it = [&](const Input& input) {
    if (input.kind == Input::Kind::kParameter) return input.parameter == *effect.parameter;
    if (input.kind != Input::Kind::kSignal) return false;
    const auto* source = std::get_if<ParameterId>(&rules[input.signal].source);
    return source != nullptr && *source == *effect.parameter;
  };
  const Program& trigger = rules[rule].trigger;
  std::vector<Assumed> assumed;
  for (const Instruction& instruction : trigger.code) {
    if (instruction.op != Op::kInput) continue;
    const Input& input = rules[InputId(instruction.operand)];
    if (!reads_it(input)) continue;
    const bool is_whole = effect.type == Type::kInt && input.type == Type::kDouble;
    if (!is_whole && effect.type != input.type) return false;
    assumed.push_back({InputId(instruction.operand),
                       is_whole ? Slot::of(static_cast<double>(effect.value.i)) : effect.value});
  }
  if (assumed.empty()) return false;
  const std::vector<Slot> unknown(rules.inputs.size());
  const Slot value = evaluate(trigger, unknown, assumed);
  return value.known && value.b;
}

bool set_off_one_another(const Doing& a, const Doing& b, const RuleSet& rules) {
  return sets_off(a.effect, b.rule->rule, rules) && sets_off(b.effect, a.rule->rule, rules);
}

// @pre both are about the same thing
bool undo_one_another(const Doing& a, const Doing& b, const RuleSet& rules) {
  CULPRIT_ASSERT(a.effect.thing == b.effect.thing);
  return a.rule != b.rule && a.effect.state != b.effect.state &&
         (take_turns(*a.rule, *b.rule, rules) || set_off_one_another(a, b, rules));
}

Diagnostic oscillation(const Doing& earlier, const Doing& later, const RuleSet& rules) {
  return {Code::kOscillation, Severity::kWarning, later.span,
          "rules '" + rules[earlier.rule->rule].name + "' and '" + rules[later.rule->rule].name +
              "' can undo one another for ever: strategy '" + rules[earlier.strategy].name +
              "' of the one " + earlier.effect.verb + ", this one " + later.effect.verb +
              " (component '" + rules[later.component].name + "')",
          "leave a band between their triggers, or make the two strategies of one rule"};
}

// Only where it is certain: of a parameter, a lifecycle or a process, not of what a robot does then.
bool is_read(const Adaptation& changed, const Program& condition, const RuleSet& rules) {
  return std::ranges::any_of(condition.code, [&](const Instruction& instruction) {
    if (instruction.op != Op::kInput) return false;
    const Input& input = rules[InputId(instruction.operand)];
    const bool is_parameter = syntax::names_parameter(changed.type);
    switch (input.kind) {
      case Input::Kind::kParameter:
        return is_parameter && input.parameter == changed.parameter;
      case Input::Kind::kSignal: {
        const auto* source = std::get_if<ParameterId>(&rules[input.signal].source);
        return is_parameter && source != nullptr && *source == changed.parameter;
      }
      case Input::Kind::kAlive:
      case Input::Kind::kLifecycle:
        return !is_parameter && changed.type != AdaptationType::kCall &&
               changed.type != AdaptationType::kChangeMode && input.component == changed.component;
      default:
        return false;
    }
  });
}

}  // namespace

void check_covered_rules(const std::vector<RuleConditions>& conditions, const RuleSet& rules,
                         std::vector<Diagnostic>& diagnostics) {
  std::map<InputId, std::vector<const RuleConditions*>> by_input;
  for (const RuleConditions& rule : conditions) {
    const auto input = only_input(rule.trigger);
    if (!input || rule.never_fires || is_never(false, rule.trigger, rules)) continue;
    auto& group = by_input[*input];
    if (group.size() < kMaxCompared) group.push_back(&rule);
  }
  for (const auto& [input, group] : by_input) {
    for (const RuleConditions* weak : group) {
      const auto strong = std::find_if(group.begin(), group.end(), [&](const auto* candidate) {
        if (candidate == weak || !covers(*candidate, *weak, rules)) return false;
        // If two cover each other, only the second one is reported.
        return candidate->rule < weak->rule || !covers(*weak, *candidate, rules);
      });
      if (strong == group.end()) continue;
      const std::string& name = rules[(*strong)->rule].name;
      diagnostics.push_back(
          {Code::kCovered, Severity::kWarning, weak->trigger.span,
           "rule '" + name +
               "' covers this one: whenever this trigger is true, "
               "its trigger is too, for the same components",
           "move the strategies to rule '" + name + "', or give this rule a trigger of its own"});
    }
  }
}

void check_oscillation(const std::vector<RuleConditions>& conditions, const RuleSet& rules,
                       std::vector<Diagnostic>& diagnostics) {
  std::unordered_map<std::string, std::vector<Doing>> by_thing;
  for (const RuleConditions& rule : conditions) {
    if (rule.never_fires) continue;
    std::set<std::string> reported;  // of one rule and one thing, once is enough
    for (Doing& doing : doings_of(rule, rules)) {
      auto& known = by_thing[doing.effect.thing];
      if (!reported.contains(doing.effect.thing)) {
        const auto earlier = std::find_if(known.begin(), known.end(), [&](const Doing& other) {
          return undo_one_another(other, doing, rules);
        });
        if (earlier != known.end()) {
          diagnostics.push_back(oscillation(*earlier, doing, rules));
          reported.insert(doing.effect.thing);
        }
      }
      if (known.size() < kMaxCompared) known.push_back(std::move(doing));
    }
  }
}

void check_interlocks(const std::vector<RuleConditions>& conditions, const RuleSet& rules,
                      std::vector<Diagnostic>& diagnostics) {
  if (rules.interlocks.empty()) return;
  for (const RuleConditions& rule : conditions) {
    for (std::size_t s = 0; s < rule.strategies.size(); ++s) {
      const Strategy& strategy = rules[rules[rule.rule].strategies[s]];
      for (std::size_t a = 0; strategy.is_last_resort && a < strategy.adaptations.size(); ++a) {
        const Adaptation& changed = strategy.adaptations[a];
        const auto interlock = std::ranges::find_if(rules.interlocks, [&](const Interlock& each) {
          return is_read(changed, each.condition, rules);
        });
        if (interlock == rules.interlocks.end()) continue;
        diagnostics.push_back(
            {Code::kMovesInterlock, Severity::kWarning,
             rule.strategies[s]->adaptations[changed.written].span,
             "last resort '" + strategy.name + "' changes what INTERLOCK " + interlock->text +
                 " reads: it then shows the setting of culprit, not the state of the robot",
             "let the INTERLOCK read a measurement, such as a speed"});
      }
    }
  }
}

}  // namespace culprit
