#include "language/checker.h"

#include <algorithm>
#include <cstdio>
#include <set>
#include <tuple>

#include "language/compiler.h"
#include "language/condition_checks.h"
#include "language/conflict_checks.h"
#include "language/evaluate.h"
#include "language/facts.h"
#include "language/foreign_files.h"
#include "language/likely_slips.h"
#include "language/parser.h"
#include "language/place_index.h"
#include "language/request_text.h"
#include "language/rule_checks.h"
#include "language/start_checks.h"
#include "language/typing.h"

namespace culprit {
namespace {

constexpr double kMaxImpact = 1e6;  // cycles
constexpr std::int64_t kMaxCount = 1000;
constexpr Duration kMaxCycle = std::chrono::hours(1);
constexpr Duration kWithin = std::chrono::seconds(2);  // LASTRESORT without WITHIN
constexpr int kDefaultRounds = 3;  // each strategy is tried this often before the rule is exhausted

class Checker {
 public:
  Checker(const syntax::File& file, Strictness strictness, std::vector<Diagnostic>& diagnostics)
      : file_(file), diagnostics_(diagnostics), symbols_(rules_, strictness, diagnostics) {}

  RuleSet check() {
    rules_.components.reserve(file_.components.size());
    rules_.signals.reserve(file_.signals.size());
    rules_.rules.reserve(file_.rules.size());
    rules_.inputs.reserve(2 * file_.rules.size());  // as most triggers read
    rule_names_.reserve(file_.rules.size());
    conditions_.reserve(file_.rules.size());
    std::size_t strategies = 0;
    for (const syntax::Rule& rule : file_.rules) strategies += rule.strategies.size();
    rules_.strategies.reserve(strategies);
    header();
    const std::size_t said = diagnostics_.size();
    symbols_.declare(file_);
    const auto is_stray = [](const Diagnostic& d) { return d.code == Code::kUnknownStatement; };
    has_broken_declaration_ = diagnostics_.size() > said || has_broken_component() ||
                              std::any_of(diagnostics_.begin(), diagnostics_.end(), is_stray);
    constants();
    dependencies();
    infer();
    for (std::size_t s = 0; s < rules_.signals.size(); ++s) declare_signal_type(SignalId(s));
    interlocks();
    drills();
    for (const syntax::Rule& rule : file_.rules) {
      if (rule.name.text.empty()) continue;  // its line was broken
      check_name(rule);
      add_rule(rule);
    }
    symbols_.drop_forgotten_reports();
    for (Input& input : rules_.inputs) sort_unique(input.thresholds);
    for (std::size_t s = 0; s < rules_.signals.size(); ++s) declare_signal_type(SignalId(s));
    for (std::size_t r = 0; r < rules_.rules.size(); ++r) link_readers(RuleId(r));
    check_circles(file_, rules_, diagnostics_);
    check_meaning();
    return std::move(rules_);
  }

  std::vector<RuleConditions> take_conditions() { return std::move(conditions_); }

 private:
  void header() {
    if (file_.robot) rules_.robot = file_.robot->text;
    if (file_.cycle) {
      if (file_.cycle->length > kMaxCycle) {
        report(Code::kPolicyRange, file_.cycle->span, "a cycle is at most an hour",
               "the paper's is 200ms");
      } else {
        rules_.cycle = file_.cycle->length;
      }
    }
    for (const syntax::Name& topic : file_.ignored_topics)
      rules_.ignored_topics.push_back(topic.text);
  }

  void constants() {
    for (const syntax::Constant& constant : file_.constants) {
      if (const auto* known = symbols_.constant(constant.name.text);
          known != nullptr && !known->broken)
        continue;
      if (auto value = constant_value(constant))
        symbols_.define_constant(constant.name, {std::move(*value), false});
    }
  }

  std::optional<syntax::Literal> constant_value(const syntax::Constant& constant) {
    if (is_comment(constant.value) || names_a_signal(constant.value)) return std::nullopt;
    const auto typed = type_expression(constant.value, symbols_, diagnostics_);
    if (!typed) return std::nullopt;
    if (reads_inputs(*typed)) {
      report(Code::kNotConstant, constant.value.span, "this changes at run time",
             "a constant is made of constants");
      return std::nullopt;
    }
    const Program program = compile(*typed);  // the slot borrows its text
    const Slot slot = evaluate(program, {});
    if (!slot.known) {
      report(Code::kNoValue, constant.value.span, "this has no value",
             "it divides by zero or overflows");
      return std::nullopt;
    }
    if (typed->type == Type::kDuration) return Duration(slot.i);
    return std::visit([](const auto& value) -> syntax::Literal { return value; },
                      to_value(slot, typed->type));
  }

  // "75.0 -- degrees", which reads as two signs
  bool is_comment(const syntax::Expression& e) {
    if (e.kind != syntax::Expression::Kind::kBinary || e.op != syntax::Operator::kSubtract)
      return false;
    const syntax::Expression& right = e.children[1];
    const std::uint32_t signs = right.span.begin - 1;
    const bool is_so =
        right.kind == syntax::Expression::Kind::kUnary && right.op == syntax::Operator::kNegate &&
        right.children[0].kind == syntax::Expression::Kind::kName &&
        e.children[0].span.end + 1 == signs && right.children[0].span.begin > signs + 2 &&
        !symbols_.constant(right.children[0].name.text);
    if (is_so)
      diagnostics_.push_back({Code::kExtraText,
                              Severity::kError,
                              {signs, signs + 2},
                              "no comment begins with '--'",
                              "begin a comment with #",
                              Edit{{signs, signs + 2}, "#"}});
    return is_so;
  }

  // A constant must not create signals by naming them.
  bool names_a_signal(const syntax::Expression& e) {
    if (e.kind == syntax::Expression::Kind::kCall || e.kind == syntax::Expression::Kind::kName) {
      const auto* constant = symbols_.constant(e.name.text);
      const bool is_name = e.kind == syntax::Expression::Kind::kName;
      const bool pure = e.name.text == "abs" || e.name.text == "min" || e.name.text == "max" ||
                        e.name.text == "pow" || e.name.text == "sqrt";
      if (is_name ? constant == nullptr : !pure) {
        report(Code::kNotConstant, e.span, "'" + e.name.text + "' is no constant",
               "a constant is made of numbers, texts and constants");
        return true;
      }
      if (is_name && constant->broken) {
        report(Code::kNotConstant, e.span, "'" + e.name.text + "' has no value yet",
               "define it in a line before this one");
        return true;
      }
    }
    return std::any_of(e.children.begin(), e.children.end(),
                       [&](const auto& c) { return names_a_signal(c); });
  }

  void dependencies() {
    for (const syntax::Dependency& d : file_.dependencies) {
      const ComponentId consumer = symbols_.component(d.consumer);
      for (const syntax::Name& producer : d.producers) {
        rules_.dependencies.push_back({consumer, symbols_.component(producer)});
      }
    }
    containers();
  }

  // A component in a container exits with it, and starts after it: it depends on the container.
  void containers() {
    for (std::size_t part = 0; part < rules_.components.size(); ++part) {
      const auto& composed = rules_.components[part].composed;
      for (std::size_t c = 0; composed && c < rules_.components.size(); ++c) {
        if (c != part && rules_.components[c].node == composed->container)
          rules_.dependencies.push_back({ComponentId(part), ComponentId(c)});
      }
    }
  }

  void interlocks() {
    for (const syntax::Interlock& written : file_.interlocks) {
      if (auto typed = boolean(written.condition, "an INTERLOCK")) {
        rules_.interlocks.push_back({compile(*typed), written.text});
        file_conditions_.push_back({"INTERLOCK", std::move(*typed)});
      }
    }
  }

  void drills() {
    for (const syntax::Interlock& written : file_.aborts) {
      if (auto typed = boolean(written.condition, "an ABORT")) {
        rules_.aborts.push_back(written.text);
        file_conditions_.push_back({"ABORT", std::move(*typed)});
      }
    }
    for (const syntax::Drill& written : file_.drills) {
      DrillLine line{symbols_.component(written.component),
                     written.what,
                     written.subject.text,
                     {},
                     written.times};
      if (written.value) {
        const auto value = constant_value({written.subject, *written.value});
        if (!value) continue;
        if (std::holds_alternative<Duration>(*value)) {
          report(Code::kTypeMismatch, written.value->span, "a parameter is no duration",
                 "write a number, a text, true or false");
          continue;
        }
        std::visit(
            [&](const auto& each) {
              if constexpr (!std::is_same_v<std::decay_t<decltype(each)>, Duration>)
                line.value = each;
            },
            *value);
      }
      rules_.drills.push_back(std::move(line));
    }
  }

  void infer() {
    for (const syntax::Rule& rule : file_.rules) {
      if (rule.trigger) infer_types(*rule.trigger, Type::kBool, symbols_);
      for (const syntax::Strategy& strategy : rule.strategies) {
        if (strategy.when) infer_types(*strategy.when, Type::kBool, symbols_);
        for (const syntax::Adaptation& a : strategy.adaptations) {
          const bool number = a.type == AdaptationType::kIncreaseParameter ||
                              a.type == AdaptationType::kDecreaseParameter;
          if (a.value)
            infer_types(*a.value, number ? std::optional(Type::kDouble) : std::nullopt, symbols_);
        }
      }
    }
    // Behind the rules, which compare a signal more often than these do.
    for (const syntax::Interlock& abort : file_.aborts)
      infer_types(abort.condition, Type::kBool, symbols_);
    for (const syntax::Interlock& interlock : file_.interlocks)
      infer_types(interlock.condition, Type::kBool, symbols_);
  }

  void declare_signal_type(SignalId id) {
    if (const auto type = symbols_.type_of(id)) rules_.signals[id.index].type = *type;
  }

  void check_name(const syntax::Rule& written) {
    const std::string& name = written.name.text;
    if (!place_of(name, rules_.rules, rule_names_)) {
      rule_names_.add(name_hash(name), rules_.rules.size());
    } else {
      report(Code::kDuplicateName, written.name.span, "there is a rule '" + name + "' already",
             "give this rule another name");
    }
  }

  void add_rule(const syntax::Rule& written) {
    const RuleId id(rules_.rules.size());
    Rule rule;
    rule.name = written.name.text;
    rule.declaration = written.name;
    if (!written.has_broken_part) check_complete(written);
    if (written.policies) policies(*written.policies, written, rule.policies);
    if (written.trigger) {
      if (auto typed = boolean(*written.trigger, "a trigger")) {
        rule.trigger = compile(*typed);
        check_constant_trigger(written, rule.trigger, diagnostics_);
        collect_thresholds(*typed, rules_.inputs);
        RuleConditions conditions;
        conditions.written = &written;
        conditions.rule = id;
        conditions.trigger = std::move(*typed);
        conditions.strategies.reserve(written.strategies.size());
        conditions_.push_back(std::move(conditions));
      }
    }
    rule.strategies.reserve(written.strategies.size());
    rule.components.reserve(written.strategies.size());
    rules_.rules.push_back(std::move(rule));
    PlaceIndex names;  // of its strategies
    for (const syntax::Strategy& strategy : written.strategies) {
      if (strategy.name.text.empty()) continue;
      if (place_of(strategy.name.text, rules_.strategies, names)) {
        report(
            Code::kDuplicateName, strategy.name.span,
            "rule '" + written.name.text + "' has a strategy '" + strategy.name.text + "' already",
            "give this strategy another name");
        continue;
      }
      names.add(name_hash(strategy.name.text), rules_.strategies.size());
      add_strategy(strategy, id);
    }
    sort_unique(rules_.rules[id.index].components);
    // How a component of a broken line is started is not known.
    if (!written.has_broken_part && !has_broken_declaration_) {
      check_launches(written, rules_, id, diagnostics_);
      check_required(written, rules_, id, diagnostics_);
    }
  }

  bool has_broken_component() const {
    return std::ranges::any_of(file_.broken_declarations, [](const auto& broken) {
      return broken.kind == syntax::BrokenDeclaration::Kind::kComponent;
    });
  }

  // The meaning of rules is checked only once all of them can be read: a warning that follows from
  // an error would be one too many.
  void check_meaning() {
    const bool failed = std::any_of(diagnostics_.begin(), diagnostics_.end(),
                                    [](const auto& d) { return d.severity == Severity::kError; });
    if (failed) return;
    for (RuleConditions& rule : conditions_) {
      rule.never_fires = is_never(true, rule.trigger, rules_);
      check_conditions(rule, rules_, diagnostics_);
      check_last_resort(rule, rules_, diagnostics_);
      check_true_when_well(rule, rules_, diagnostics_);
      check_compared_values(rule, rules_, diagnostics_);
      check_short_impacts(*rule.written, rules_, diagnostics_);
    }
    // Declared components come first, in the order of the file.
    for (std::size_t i = 0; i < file_.components.size(); ++i) {
      check_shell(file_.components[i], rules_.components[i], diagnostics_);
      check_command(file_.components[i], rules_.components[i], diagnostics_);
    }
    check_containers(file_, rules_, diagnostics_);
    check_topics_as_nodes(file_, diagnostics_);
    check_topics_as_components(file_, rules_, diagnostics_);
    check_nodes_as_topics(file_, rules_, diagnostics_);
    check_rules_as_values(file_, diagnostics_);
    check_unused(file_, rules_, diagnostics_);
    check_covered_rules(conditions_, rules_, diagnostics_);
    check_oscillation(conditions_, rules_, diagnostics_);
    check_interlocks(conditions_, rules_, diagnostics_);
    check_file_conditions(file_conditions_, rules_, diagnostics_);
    check_interlocked_rules(conditions_, file_conditions_, rules_, diagnostics_);
    check_effects(conditions_, rules_, diagnostics_);
    check_settings_in_rules(file_, diagnostics_);
  }

  void check_complete(const syntax::Rule& rule) {
    std::string missing;
    const auto need = [&](bool there, const char* what) {
      if (!there) missing += (missing.empty() ? "" : ", ") + std::string(what);
    };
    need(rule.policies.has_value(), "POLICIES");
    need(rule.trigger.has_value(), "TRIGGER");
    const bool is_report = rule.policies && rule.policies->is_report;
    need(is_report || !rule.strategies.empty(), "STRATEGY");
    if (is_report && !rule.strategies.empty())
      report(Code::kContradiction, rule.strategies.front().name.span,
             "rule '" + rule.name.text + "' only reports, so none of its strategies would be used",
             "remove REPORT from its POLICIES, or its strategies");
    if (missing.empty()) return;
    const char* remedy =
        missing == "POLICIES"  ? "add how critical the failure is, as in POLICIES ERROR"
        : missing == "TRIGGER" ? "add when the failure is there, as in TRIGGER age(/topic) > 1s"
        : missing == "STRATEGY"
            ? "add a STRATEGY with what may help, or REPORT to its POLICIES to notify a person"
            : "a rule says how critical the failure is (POLICIES), when it is there (TRIGGER) and "
              "what may help (STRATEGY), or that a person is notified (POLICIES ... REPORT)";
    report(Code::kIncomplete, rule.name.span,
           "rule '" + rule.name.text + "' is incomplete: no " + missing, remedy);
  }

  void policies(const syntax::Policies& written, const syntax::Rule& rule, Policies& policies) {
    policies.criticality = written.criticality;
    policies.hold_for = written.hold_for.value_or(Duration::zero());
    policies.cooldown = written.cooldown.value_or(Duration::zero());
    policies.on_change = written.on_change;
    policies.attempts =
        kDefaultRounds * static_cast<int>(std::min<std::size_t>(rule.strategies.size(), kMaxCount));
    if (written.attempts) {
      if (written.attempts->count < 1 || written.attempts->count > kMaxCount) {
        report(Code::kPolicyRange, written.attempts->span, "ATTEMPTS is a number from 1 to 1000",
               "leave it out for the default: three rounds");
      } else {
        policies.attempts = static_cast<int>(written.attempts->count);
      }
    }
    if (written.hold) {
      const auto [needed, window, span] = *written.hold;
      if (needed < 1 || window > kMaxCount || needed > window) {
        report(Code::kPolicyRange, span, "HOLD n/k needs 1 <= n <= k <= 1000",
               "HOLD 3/5 means: true in 3 of the last 5 cycles");
      } else {
        policies.hold_needed = static_cast<int>(needed);
        policies.hold_window = static_cast<int>(window);
      }
    }
  }

  void check_numbers(const syntax::Strategy& written) {
    const auto in_percent = [](const syntax::Number& n) { return n.value > 0 && n.value <= 100; };
    if (!in_percent(written.probability)) {
      report(Code::kProbabilityRange, written.probability.span,
             "a success probability is above 0 and at most 100 percent",
             written.probability.value == 0
                 ? "a strategy that never helps need not be written down"
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

  void add_strategy(const syntax::Strategy& written, RuleId rule) {
    const StrategyId id(rules_.strategies.size());
    const bool has_trigger = !conditions_.empty() && conditions_.back().rule == rule;
    if (has_trigger) conditions_.back().strategies.push_back(&written);
    Strategy strategy;
    strategy.name = written.name.text;
    strategy.rule = rule;
    strategy.is_last_resort = written.is_last_resort;
    if (written.is_last_resort) strategy.within = written.within.value_or(kWithin);
    check_numbers(written);
    strategy.success = percent(written.probability.value);
    strategy.confidence = written.confidence.value;
    if (written.when) {
      if (auto typed = boolean(*written.when, "a WHEN condition")) {
        strategy.when = compile(*typed);
        if (has_trigger) conditions_.back().whens.push_back({id, std::move(*typed)});
      }
    }
    if (written.adaptations.empty() && !written.has_broken_adaptation) {
      report(Code::kIncomplete, written.name.span,
             "strategy '" + written.name.text + "' has no ADAPTATION",
             "say what it does: ADAPTATION component restart 5");
    }
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
    strategy.impact = impact_of(strategy.adaptations);
    if (!written.has_broken_adaptation) check_contradictions(written, diagnostics_);

    sort_unique(strategy.components);
    auto& touched = rules_.rules[rule.index].components;
    touched.insert(touched.end(), strategy.components.begin(), strategy.components.end());
    rules_.heaviest = std::max(rules_.heaviest, strategy.impact);
    rules_.rules[rule.index].strategies.push_back(id);
    rules_.strategies.push_back(std::move(strategy));
  }

  static Cycles impact_of(const std::vector<Adaptation>& adaptations) {
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

  // Empty if a hundred times the fraction is no whole percentage either.
  static std::string percent_remedy(const syntax::Number& fraction) {
    const auto fix = in_percent_fix(fraction);
    return "probabilities are in percent" + (fix ? ": write " + fix->text : "");
  }

  static std::optional<Edit> in_percent_fix(const syntax::Number& fraction) {
    if (fraction.value < 0.01) return std::nullopt;
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", fraction.value * 100);
    return Edit{fraction.span, text};
  }

  void add_adaptation(const syntax::Adaptation& written, Strategy& strategy) {
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
        adaptation_value(written, std::move(*typed), adaptation);
      }
    }
    strategy.components.push_back(adaptation.component);
    strategy.adaptations.push_back(std::move(adaptation));
  }

  void add_request(const syntax::Name& written, Adaptation& adaptation) {
    adaptation.request = written.text;
    if (auto flaw = flaw_of_request(written.text))
      report(Code::kBadRequest, written.span, std::move(flaw->cause), std::move(flaw->remedy));
  }

  // Zero: it was reported.
  Cycles impact_of(const syntax::Adaptation& written) {
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
  void add_group(const syntax::Adaptation& written, Strategy& strategy) {
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

  void adaptation_value(const syntax::Adaptation& written, Typed typed, Adaptation& adaptation) {
    const bool changes = written.type != AdaptationType::kSetParameter;
    const bool number = typed.type == Type::kInt || typed.type == Type::kDouble;
    if (changes && !number) {
      report(
          Code::kTypeMismatch, written.value->span,
          std::string(keyword(written.type)) + " needs a number; this is " + describe(typed.type),
          "write by how much the value changes, or use set_parameter");
    } else if (typed.type == Type::kDuration) {
      report(Code::kTypeMismatch, written.value->span, "ROS parameters hold no durations",
             "write the number that the node expects, for example its seconds");
    } else if (fits_stack(typed, *written.value)) {
      adaptation.value = compile(typed);
      check_value(written, typed, adaptation.parameter);
    }
  }

  // Warnings about a value that the node would refuse.
  void check_value(const syntax::Adaptation& written, const Typed& typed, ParameterId parameter) {
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

  std::optional<Typed> boolean(const syntax::Expression& e, const std::string& what) {
    auto typed = type_expression(e, symbols_, diagnostics_);
    if (!typed || !fits_stack(*typed, e)) return std::nullopt;
    if (typed->type == Type::kBool) return typed;
    report(Code::kTypeMismatch, e.span,
           what + " is true or false; this is " + describe(typed->type),
           remedy_of_no_condition(*typed, e));
    return std::nullopt;
  }

  static std::string remedy_of_no_condition(const Typed& typed, const syntax::Expression& e) {
    if (typed.type == Type::kDuration) return "compare it with a duration, as in age(/topic) > 1s";
    if (typed.type != Type::kString) return "compare it with something, as in rate(/topic) < 1";
    return e.kind == syntax::Expression::Kind::kLiteral
               ? "write the condition without quotes"
               : "compare it with a text, as in lifecycle(camera) != \"active\"";
  }

  bool fits_stack(const Typed& typed, const syntax::Expression& e) {
    if (stack_need(typed) <= kStackSize) return true;
    report(Code::kTooDeep, e.span, "this expression is nested too deeply",
           "split it into several rules");
    return false;
  }

  void link_readers(RuleId id) {
    Rule& rule = rules_.rules[id.index];
    rule.inputs.reserve(static_cast<std::size_t>(
        std::count_if(rule.trigger.code.begin(), rule.trigger.code.end(),
                      [](const Instruction& i) { return i.op == Op::kInput; })));
    for (const Instruction& instruction : rule.trigger.code) {
      if (instruction.op == Op::kInput) rule.inputs.push_back(InputId(instruction.operand));
    }
    sort_unique(rule.inputs);
    for (const InputId input : rule.inputs) rules_.inputs[input.index].readers.push_back(id);
    link_groups(id);
  }

  // It is about a group if it reads the group, or a member, or adapts one.
  void link_groups(RuleId id) {
    Rule& rule = rules_.rules[id.index];
    rule.groups.clear();
    for (std::size_t g = 0; g < rules_.groups.size(); ++g) {
      const Group& group = rules_.groups[g];
      const auto is_member = [&](ComponentId component) {
        return std::ranges::find(group.members, component) != group.members.end();
      };
      const auto is_of_group = [&](InputId input_id) {
        const Input& input = rules_[input_id];
        const bool is_of_component =
            input.kind == Input::Kind::kAlive || input.kind == Input::Kind::kLifecycle;
        const auto* source = input.kind == Input::Kind::kSignal
                                 ? std::get_if<GroupId>(&rules_[input.signal].source)
                                 : nullptr;
        return (is_of_component && is_member(input.component)) ||
               (source != nullptr && *source == GroupId(g));
      };
      if (std::ranges::none_of(rule.components, is_member) &&
          std::ranges::none_of(rule.inputs, is_of_group))
        continue;
      rule.groups.emplace_back(g);
      Input health;
      health.type = Type::kString;
      health.signal = group.health;
      auto& readers = rules_.inputs[symbols_.input(health).index].readers;
      if (std::ranges::find(readers, id) == readers.end()) readers.push_back(id);
    }
  }

  template <class T>
  static void sort_unique(std::vector<T>& items) {
    std::sort(items.begin(), items.end());
    items.erase(std::unique(items.begin(), items.end()), items.end());
  }

  void report(Code code, Span span, std::string cause, std::string remedy) {
    diagnostics_.push_back({code, Severity::kError, span, std::move(cause), std::move(remedy)});
  }

  const syntax::File& file_;
  std::vector<Diagnostic>& diagnostics_;
  RuleSet rules_;
  Symbols symbols_;
  bool has_broken_declaration_ = false;
  PlaceIndex rule_names_;
  std::vector<RuleConditions> conditions_;  // of each rule that has a trigger
  std::vector<FileCondition> file_conditions_;
};

// A name of a template is one of the rules: a second USE with the same arguments gives it again.
void name_uses(std::vector<Diagnostic>& diagnostics, const Source& source) {
  for (Diagnostic& d : diagnostics) {
    if (d.code != Code::kDuplicateName) continue;
    const auto notes = located(d, source).notes;
    const bool is_of_use =
        std::ranges::any_of(notes, [](const auto& note) { return note.text == "used here"; });
    if (is_of_use)
      d.remedy =
          "give each USE other arguments, and put a parameter into this name of the TEMPLATE";
  }
}

// A mistake in a template repeats in each USE of it; one report is enough.
void say_once(std::vector<Diagnostic>& diagnostics, const Source& source) {
  std::set<std::tuple<std::uint32_t, std::uint32_t, Code, std::string>> said;
  std::erase_if(diagnostics, [&](const Diagnostic& d) {
    const Origin origin = source.origin(d.span);
    const Place& place = origin.place;
    // An included file may declare more than each including file needs.
    if (d.code == Code::kUnused && (place.file != 0 || !origin.steps.empty())) return true;
    return !said.emplace(place.file, place.span.begin, d.code, d.cause).second;
  });
}

Checked check_tree(const syntax::File& file, std::vector<Diagnostic> said, Strictness strictness) {
  Checked result;
  result.diagnostics = std::move(said);
  Checker checker(file, strictness, result.diagnostics);
  RuleSet rules = checker.check();
  result.conditions = checker.take_conditions();
  std::stable_sort(
      result.diagnostics.begin(), result.diagnostics.end(),
      [](const Diagnostic& a, const Diagnostic& b) { return a.span.begin < b.span.begin; });
  const bool failed =
      std::any_of(result.diagnostics.begin(), result.diagnostics.end(),
                  [](const Diagnostic& d) { return d.severity == Severity::kError; });
  if (!failed) result.rules = std::move(rules);
  return result;
}

}  // namespace

Checked check(const Source& source, Strictness strictness) {
  Parsed whole = parse_whole(source);
  if (!whole.file.has_reuse()) {
    Checked checked = check(whole, strictness);
    checked.file = std::move(whole.file);
    return checked;
  }
  const Expansion rules = expand(source);
  Checked checked = check(rules, strictness);
  checked.diagnostics = as_written(std::move(checked.diagnostics), rules.source);
  return checked;
}

Checked check(const Expansion& rules, Strictness strictness) {
  Parsed whole = parse_whole(rules.source);
  Checked checked = check(rules, whole, strictness);
  checked.file = std::move(whole.file);
  return checked;
}

Checked check(const Parsed& whole, Strictness strictness) {
  Checked checked = check_tree(whole.file, whole.said, strictness);
  condense(whole.source, checked.diagnostics);
  return checked;
}

Checked check(const Expansion& rules, const Parsed& whole, Strictness strictness) {
  if (!rules.mistakes.empty()) return {{}, rules.mistakes};
  Checked checked = check(whole, strictness);
  say_once(checked.diagnostics, rules.source);
  name_uses(checked.diagnostics, rules.source);
  return checked;
}

}  // namespace culprit
