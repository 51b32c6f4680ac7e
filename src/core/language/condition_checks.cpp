#include "language/condition_checks.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <optional>

#include "language/compiler.h"
#include "language/facts.h"

namespace culprit {
namespace {

bool is_connective(const Typed& e) {
  if (e.type != Type::kBool) return false;
  if (e.op == Op::kNot) return e.span != e.children[0].span;  // not the ! of !=
  return e.op == Op::kAnd || e.op == Op::kOr || e.op == Op::kSelect;
}

const Typed* plain_input(const Typed& e) {
  if (e.op == Op::kInput) return &e;
  return e.op == Op::kIntToDouble ? plain_input(e.children[0]) : nullptr;
}

// The input that a comparison with a constant is about; null for other conditions.
const Typed* compared_input(const Typed& comparison) {
  if (comparison.op == Op::kNot) return compared_input(comparison.children[0]);
  if (comparison.children.size() != 2) return nullptr;
  const Typed* left = plain_input(comparison.children[0]);
  return left != nullptr ? left : plain_input(comparison.children[1]);
}

// Facts know all about it after one look: is_never() would find no more with a second one.
bool compares_with_constant(const Typed& e) {
  if (e.children.size() != 2) return false;
  const Typed& left = e.children[0];
  const Typed& right = e.children[1];
  return (plain_input(left) != nullptr && right.op == Op::kConstant) ||
         (plain_input(right) != nullptr && left.op == Op::kConstant);
}

// "1", not "1.0": as people write the ends of a RANGE.
std::string plain_number(double value) {
  std::string text = to_string(Value(value));
  if (text.ends_with(".0")) text.resize(text.size() - 2);
  return text;
}

bool has_declared_range(InputId id, const RuleSet& rules) {
  switch (rules[id].kind) {
    case Input::Kind::kSignal:
    case Input::Kind::kMin:
    case Input::Kind::kMax:
    case Input::Kind::kMean:
    case Input::Kind::kStddev:
      return rules[rules[id].signal].range.has_value();
    default:
      return false;
  }
}

// The known facts about the input, for a message; empty if the message can say nothing more.
std::string known_of(InputId id, const RuleSet& rules) {
  if (has_declared_range(id, rules)) {
    const Signal& signal = rules[rules[id].signal];
    return ": '" + signal.name + "' has RANGE " + plain_number(signal.range->low) + ".." +
           plain_number(signal.range->high);
  }
  switch (rules[id].kind) {
    case Input::Kind::kRate:
      return ": a rate is not negative";
    case Input::Kind::kAge:
      return ": an age is not negative";
    case Input::Kind::kPhi:
      return ": phi is not negative";
    case Input::Kind::kGoals:
      return ": a number of goals is not negative";
    case Input::Kind::kLogs:
      return ": a number of lines is not negative";
    case Input::Kind::kGoalAge:
      return ": the age of a goal is not negative";
    case Input::Kind::kCpu:
      return ": a share of a core is not negative";
    case Input::Kind::kMemory:
      return ": a size is not negative";
    case Input::Kind::kLoss:
      return ": loss is a share from 0 to 1";
    case Input::Kind::kLevel:
      return ": a level is 0, 1, 2 or 3";
    case Input::Kind::kSignal:
      return std::holds_alternative<GroupId>(rules[rules[id].signal].source)
                 ? ": a group is active, half_up, inactive, down or changing"
                 : "";
    case Input::Kind::kLifecycle:
      return ": the states are unconfigured, inactive, active and finalized";
    default:
      return "";
  }
}

struct Finding {
  bool always = false;  // otherwise never
  Span span;
  std::string reason;  // of the cause
  std::string remedy;
};

// Whether the values of the input are all between 0 and `high`. A deviation may be far smaller.
bool is_from_0_to(double high, const Input& input, const RuleSet& rules) {
  switch (input.kind) {
    case Input::Kind::kLoss:
      return high == 1;
    case Input::Kind::kSignal:
    case Input::Kind::kMin:
    case Input::Kind::kMax:
    case Input::Kind::kMean: {
      const auto& range = rules[input.signal].range;
      return range && range->low == 0 && range->high == high;
    }
    default:
      return false;
  }
}

// A signal is compared with a smaller number rather by another slip: its RANGE may be wrong.
constexpr double kLeastPercentOfSignal = 5;

// "Active" for "active", 0.2 for a share of 20 percent; empty: neither.
std::string meant_value(const Typed& comparison, const Input& input, const RuleSet& rules) {
  if (comparison.op == Op::kNot) return meant_value(comparison.children[0], input, rules);
  if (is_from_0_to(1, input, rules)) {
    const bool is_loss = input.kind == Input::Kind::kLoss;
    for (const double percent : thresholds_of(comparison)) {
      if (percent <= 1 || percent > 100) continue;
      if (is_loss) return "write " + plain_number(percent / 100);
      if (percent >= kLeastPercentOfSignal)
        return "write " + plain_number(percent / 100) + " for " + plain_number(percent) +
               " percent, or correct the RANGE if the value can be another";
    }
  }
  const auto states = states_of(input, rules);
  for (const Typed& side : comparison.children) {
    if (side.op != Op::kConstant || states.empty()) continue;
    std::string lower = side.constant->text;
    std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
    const bool is_case_only = std::ranges::find(states, lower) != states.end();
    const std::string near = is_case_only ? lower : closest(lower, {states.begin(), states.end()});
    if (!near.empty()) return "did you mean \"" + near + "\"?";
    if (lower == "deactivated" || lower == "stopped") return "write \"inactive\"";
    if (lower == "running" || lower == "activated") return "write \"active\"";
  }
  return "";
}

// The smallest parts of `condition` that are always or never true. `known`: whether the whole is
// never true, if that is known.
void find_constant_parts(const Typed& condition, const RuleSet& rules,
                         std::vector<Finding>& findings, std::optional<bool> known = {}) {
  if (!reads_inputs(condition)) return;  // a constant that switches something on or off
  const std::size_t before = findings.size();
  const bool is_conjunction = condition.op == Op::kAnd;
  if (is_connective(condition)) {
    // If the whole conjunction can be true, so can each part.
    const auto of_part = is_conjunction && known == false ? known : std::nullopt;
    for (const Typed& child : condition.children)
      find_constant_parts(child, rules, findings, of_part);
    if (findings.size() > before) return;
  }
  const bool never = known ? *known : is_never(true, condition, rules);
  // No part of it is always true, or that had been found: so it is not always true either.
  const bool has_plain_parts =
      is_conjunction &&
      std::all_of(condition.children.begin(), condition.children.end(), compares_with_constant);
  if (!never && (has_plain_parts || !is_never(false, condition, rules))) return;
  std::string reason;
  std::string remedy;
  bool is_by_range = false;
  if (is_connective(condition)) {
    reason = never ? ": its parts exclude one another" : ": one of its parts always holds";
  } else if (const Typed* input = compared_input(condition)) {
    reason = known_of(input->input, rules);
    is_by_range = has_declared_range(input->input, rules);
    remedy = meant_value(condition, rules[input->input], rules);
  }
  if (remedy.empty())
    remedy = is_by_range ? "correct the condition, or the RANGE if the value can be another"
                         : "correct the condition, or remove it";
  findings.push_back({!never, condition.span, std::move(reason), std::move(remedy)});
}

// Neither can be true when the other is.
bool exclude_each_other(const Typed& a, const Typed& b, const RuleSet& rules) {
  if (!is_small_enough(a) || !is_small_enough(b)) return false;
  Facts facts(rules);
  for (int round = 0; round < 2; ++round) {
    if (!facts.assume(a, true) || !facts.assume(b, true)) return true;
  }
  return false;
}

void check_when(const RuleConditions& rule, const RuleConditions::When& when, const RuleSet& rules,
                std::vector<Diagnostic>& diagnostics) {
  const std::string strategy = "strategy '" + rules[when.strategy].name + "'";
  std::vector<Finding> findings;
  if (is_never(true, when.condition, rules)) {
    find_constant_parts(when.condition, rules, findings);
    const std::string reason = findings.empty() ? "" : findings[0].reason;
    diagnostics.push_back({Code::kWhenNeverTrue, Severity::kWarning, when.condition.span,
                           strategy + " can never be chosen: its WHEN is never true" + reason,
                           "correct the condition, or remove the strategy"});
    return;
  }
  // A rule that counts cycles or acts on an edge looks for strategies while its trigger is false.
  const Policies& policies = rules[rule.rule].policies;
  if (policies.hold_window > 1 || policies.on_change) return;
  if (!exclude_each_other(rule.trigger, when.condition, rules)) return;
  diagnostics.push_back({Code::kWhenContradictsTrigger, Severity::kWarning, when.condition.span,
                         strategy + " can never help: its WHEN is false while the trigger is true",
                         "correct the condition, or move the strategy to a rule of its own"});
}

bool tells_of_life(Input::Kind kind) {
  return kind == Input::Kind::kRate || kind == Input::Kind::kAge || kind == Input::Kind::kPhi ||
         kind == Input::Kind::kAlive;
}

// Assumes that all signs of life stop for good.
void fall_silent(const Typed& e, const RuleSet& rules, Facts& facts) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const Typed& child : e.children) fall_silent(child, rules, facts);
  if (e.op != Op::kInput) return;
  switch (rules[e.input].kind) {
    case Input::Kind::kRate:
      facts.know(e.input, Interval{0, 0});
      return;
    case Input::Kind::kAge:
    case Input::Kind::kPhi:
      facts.know(e.input, Interval{1e15, kInfinity});  // 1e15 ns: eleven days
      return;
    case Input::Kind::kAlive:
      facts.know(e.input, TruthSet{false, true});
      return;
    default:
      return;
  }
}

bool reads_life(const Typed& e, const RuleSet& rules) {
  return (e.op == Op::kInput && tells_of_life(rules[e.input].kind)) ||
         std::any_of(e.children.begin(), e.children.end(),
                     [&](const Typed& c) { return reads_life(c, rules); });
}

// Whether silence alone decides some part of the trigger, and so makes the trigger true. `truth` is
// the value that the part needs for that.
bool silence_speaks_for(const Typed& e, bool truth, const Facts& silent, const RuleSet& rules) {
  if (e.op == Op::kNot) return silence_speaks_for(e.children[0], !truth, silent, rules);
  if (is_connective(e)) {
    return std::any_of(e.children.begin(), e.children.end(), [&](const Typed& c) {
      return c.type == Type::kBool && silence_speaks_for(c, truth, silent, rules);
    });
  }
  Facts otherwise = silent;
  return reads_life(e, rules) && !otherwise.assume(e, !truth);
}

// Messages have just come, and all are there.
void live(const Typed& e, const RuleSet& rules, Facts& facts) {
  for (const Typed& child : e.children) live(child, rules, facts);
  if (e.op != Op::kInput) return;
  switch (rules[e.input].kind) {
    case Input::Kind::kAge:
      facts.know(e.input, Interval{1, 1});  // ns: no message is as young as 0
      return;
    case Input::Kind::kPhi:
      facts.know(e.input, Interval{0, 0});
      return;
    case Input::Kind::kAlive:
      facts.know(e.input, TruthSet{true, false});
      return;
    default:
      return;
  }
}

// Comparisons of rates with numbers that the window is too short for.
void find_short_windows(const Typed& e, const RuleSet& rules, std::vector<Diagnostic>& found) {
  const Typed* input = e.type == Type::kBool && !is_connective(e) ? compared_input(e) : nullptr;
  if (input == nullptr || rules[input->input].kind != Input::Kind::kRate) {
    for (const Typed& child : e.children) find_short_windows(child, rules, found);
    return;
  }
  const Input& rate = rules[input->input];
  for (const double hertz : thresholds_of(e)) {
    if (hertz <= 0 || seconds(rate.window) * hertz >= 1) continue;
    const std::string topic = rules.label(rate.topic);
    found.push_back({Code::kShortWindow, Severity::kWarning, e.span,
                     "within " + to_string(rate.window) + ", a topic of " + plain_number(hertz) +
                         " Hz sends nothing now and then",
                     "count over at least two of its periods: rate(" + topic + ", " +
                         to_string(from_seconds(2 / hertz)) + ")"});
  }
}

// Comparisons of cores with a number that was meant as a percentage, and of MiB with one of bytes.
void find_wrong_scales(const Typed& e, const RuleSet& rules, std::vector<Diagnostic>& found) {
  const Typed* input = e.type == Type::kBool && !is_connective(e) ? compared_input(e) : nullptr;
  const bool is_memory = input != nullptr && rules[input->input].kind == Input::Kind::kMemory;
  if (input == nullptr || (!is_memory && rules[input->input].kind != Input::Kind::kCpu)) {
    for (const Typed& child : e.children) find_wrong_scales(child, rules, found);
    return;
  }
  constexpr double kMebibyte = 1 << 20;
  for (const double bytes : is_memory ? thresholds_of(e) : std::vector<double>()) {
    if (bytes < kMebibyte) continue;
    found.push_back({Code::kNeverTrueInRange, Severity::kWarning, e.span,
                     "this is hardly ever true: memory counts the MiB that the process holds",
                     "if these are bytes, write " + plain_number(std::round(bytes / kMebibyte))});
  }
  if (is_memory) return;
  for (const double cores : thresholds_of(e)) {
    if (cores < 20 || cores > 100) continue;
    found.push_back({Code::kNeverTrueInRange, Severity::kWarning, e.span,
                     "this is hardly ever true: cpu counts the cores that the process uses",
                     "write " + plain_number(cores / 100) + " for " + plain_number(cores) +
                         " percent of a core"});
  }
}

// Comparisons of a percentage with a number that was meant as a ratio.
void find_ratios(const Typed& e, const RuleSet& rules, std::vector<Diagnostic>& found) {
  const Typed* input = e.type == Type::kBool && !is_connective(e) ? compared_input(e) : nullptr;
  if (input == nullptr || !is_from_0_to(100, rules[input->input], rules)) {
    for (const Typed& child : e.children) find_ratios(child, rules, found);
    return;
  }
  for (const double ratio : thresholds_of(e)) {
    if (ratio <= 0 || ratio >= 1) continue;
    Facts in_the_middle(rules);
    in_the_middle.know(input->input, Interval{50, 50});
    const bool is_mostly_true = in_the_middle.assume(e, true);
    const std::string percent = plain_number(std::round(ratio * 1e6) / 1e4);
    found.push_back(
        {is_mostly_true ? Code::kAlwaysTrueInRange : Code::kNeverTrueInRange, Severity::kWarning,
         e.span,
         std::string(is_mostly_true ? "this is nearly always true" : "this is hardly ever true") +
             known_of(input->input, rules),
         "if " + percent + " percent are meant, write " + percent});
  }
}

// Comparisons with a number, or with true or false, in quotes. The values of a diagnostic are texts.
void find_quoted_values(const Typed& e, const RuleSet& rules, std::vector<Diagnostic>& found) {
  for (const Typed& child : e.children) find_quoted_values(child, rules, found);
  const bool is_order = e.op == Op::kLessString || e.op == Op::kLessEqualString;
  if (!is_order && e.op != Op::kEqualString) return;
  for (const std::size_t side : {0u, 1u}) {
    const Typed& value = e.children[side];
    const Typed* input = plain_input(e.children[1 - side]);
    if (value.op != Op::kConstant || input == nullptr) continue;
    const std::string& text = value.constant->text;
    const bool is_number =
        is_order && !text.empty() && text.find_first_not_of("-.0123456789") == std::string::npos;
    const bool is_field =
        rules[input->input].kind == Input::Kind::kSignal &&
        std::holds_alternative<TopicField>(rules[rules[input->input].signal].source);
    const bool is_truth = !is_order && is_field && (text == "true" || text == "false");
    if (!is_number && !is_truth) continue;
    found.push_back(
        {Code::kTypeMismatch, Severity::kWarning, e.span,
         "in quotes, " + text + " is a text: no " +
             (is_number ? "number is less or more" : "field of true or false equals it"),
         "remove the quotes"});
  }
}

}  // namespace

void check_true_when_well(const RuleConditions& rule, const RuleSet& rules,
                          std::vector<Diagnostic>& diagnostics) {
  const bool acts_on_edges = rules[rule.rule].policies.on_change;
  if (acts_on_edges || rule.never_fires || !is_small_enough(rule.trigger) ||
      !reads_life(rule.trigger, rules))
    return;
  Facts facts(rules);
  live(rule.trigger, rules, facts);
  if (facts.assume(rule.trigger, false)) return;
  if (is_never(false, rule.trigger, rules)) return;  // it is always true, and that is said
  diagnostics.push_back(
      {Code::kTrueWhenWell, Severity::kWarning, rule.trigger.span,
       "this is true while all is well: everything is there, and messages come",
       "a trigger describes a failure, as in age(/topic) > 1s; a rule that waits for something to "
       "come has ON_CHANGE among its policies"});
}

void check_compared_values(const RuleConditions& rule, const RuleSet& rules,
                           std::vector<Diagnostic>& diagnostics) {
  find_short_windows(rule.trigger, rules, diagnostics);
  find_wrong_scales(rule.trigger, rules, diagnostics);
  find_ratios(rule.trigger, rules, diagnostics);
  find_quoted_values(rule.trigger, rules, diagnostics);
}

void check_conditions(const RuleConditions& rule, const RuleSet& rules,
                      std::vector<Diagnostic>& diagnostics) {
  std::vector<Finding> findings;
  if (is_small_enough(rule.trigger))
    find_constant_parts(rule.trigger, rules, findings, rule.never_fires);
  for (const Finding& f : findings) {
    diagnostics.push_back(
        {f.always ? Code::kAlwaysTrueInRange : Code::kNeverTrueInRange, Severity::kWarning, f.span,
         std::string(f.always ? "this is always true" : "this is never true") + f.reason,
         f.remedy});
  }
  if (rule.never_fires) return;  // with which every WHEN would be at odds
  for (const RuleConditions::When& when : rule.whens) check_when(rule, when, rules, diagnostics);
}

void check_file_conditions(const std::vector<FileCondition>& conditions, const RuleSet& rules,
                           std::vector<Diagnostic>& diagnostics) {
  for (const FileCondition& each : conditions) {
    if (!is_small_enough(each.condition)) continue;
    const bool is_never_true = is_never(true, each.condition, rules);
    if (!is_never_true && !is_never(false, each.condition, rules)) continue;
    const std::string effect =
        each.keyword == "INTERLOCK"
            ? is_never_true ? ", so no strategy ever starts" : ", so it holds nothing back"
        : is_never_true ? ", so it ends no drill"
                        : ", so no drill begins";
    std::vector<Finding> findings;
    find_constant_parts(each.condition, rules, findings, is_never_true);
    const std::string reason = findings.empty() ? "" : findings[0].reason;
    diagnostics.push_back(
        {is_never_true ? Code::kNeverTrueInRange : Code::kAlwaysTrueInRange, Severity::kWarning,
         each.condition.span,
         "this " + std::string(each.keyword) + " is " + (is_never_true ? "never" : "always") +
             " true" + effect + reason,
         findings.empty() ? "let it read a signal, such as a speed" : findings[0].remedy});
  }
}

void check_interlocked_rules(const std::vector<RuleConditions>& rules_of_file,
                             const std::vector<FileCondition>& conditions, const RuleSet& rules,
                             std::vector<Diagnostic>& diagnostics) {
  for (const FileCondition& each : conditions) {
    if (each.keyword != "INTERLOCK" || is_never(true, each.condition, rules)) continue;
    for (const RuleConditions& rule : rules_of_file) {
      const Policies& policies = rules[rule.rule].policies;
      // A rule that counts cycles or acts on an edge also acts while its trigger is false.
      // An interlock does not hold a last resort.
      const bool has_last_resort = std::ranges::any_of(
          rules[rule.rule].strategies, [&](StrategyId s) { return rules[s].is_last_resort; });
      if (rule.never_fires || rule.strategies.empty() || has_last_resort ||
          policies.hold_window > 1 || policies.on_change ||
          !exclude_each_other(rule.trigger, each.condition, rules))
        continue;
      diagnostics.push_back({Code::kNeverValid, Severity::kWarning, rule.written->name.span,
                             "no strategy of rule '" + rules[rule.rule].name +
                                 "' ever starts: an INTERLOCK is false while its trigger is true",
                             "let the INTERLOCK read something that this failure leaves true, such "
                             "as a speed"});
    }
  }
}

void check_last_resort(const RuleConditions& rule, const RuleSet& rules,
                       std::vector<Diagnostic>& diagnostics) {
  const Rule& checked = rules[rule.rule];
  const auto can_be_launched = [&](ComponentId c) { return rules[c].can_start_again(); };
  const auto begins = [&](const Adaptation& a) { return launches(a) || a.group; };
  const auto helps_a_hung_process = [&](StrategyId s) {
    const auto& adaptations = rules[s].adaptations;
    return std::any_of(adaptations.begin(), adaptations.end(), begins);
  };
  const auto launchable =
      std::find_if(checked.components.begin(), checked.components.end(), can_be_launched);
  if (launchable == checked.components.end() || !is_small_enough(rule.trigger)) return;
  // A rule with nothing but last resorts only makes the robot safe.
  const auto is_last = [&](StrategyId s) { return rules[s].is_last_resort; };
  if (std::ranges::any_of(checked.strategies, helps_a_hung_process) ||
      std::ranges::all_of(checked.strategies, is_last))
    return;
  Facts silent(rules);
  fall_silent(rule.trigger, rules, silent);
  Facts with_trigger = silent;
  if (!silence_speaks_for(rule.trigger, true, silent, rules) ||
      !with_trigger.assume(rule.trigger, true))
    return;
  const std::string& name = rules[*launchable].name;
  diagnostics.push_back({Code::kNoLastResort, Severity::kWarning, rule.written->name.span,
                         "rule '" + checked.name +
                             "' also fires if the process hangs, and none of its strategies "
                             "helps then",
                         "add a strategy with ADAPTATION " + name + " redeploy"});
}

void check_cooldown(const RuleConditions& rule, const RuleSet& rules,
                    std::vector<Diagnostic>& diagnostics) {
  const Rule& checked = rules[rule.rule];
  const auto last = std::ranges::find_if(checked.strategies,
                                         [&](StrategyId s) { return rules[s].is_last_resort; });
  if (checked.policies.cooldown == Duration::zero() || last == checked.strategies.end()) return;
  diagnostics.push_back(
      {Code::kLateLastResort, Severity::kWarning, rule.written->policies->cooldown_span,
       "for " + to_string(checked.policies.cooldown) + " after a resolution, rule '" +
           checked.name + "' detects nothing, so last resort '" + rules[*last].name +
           "' may come that much too late",
       "remove COOLDOWN; FOR or HOLD also keeps the rule from firing too often"});
}

}  // namespace culprit
