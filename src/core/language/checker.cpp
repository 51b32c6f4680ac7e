#include "language/checker.h"

#include <algorithm>
#include <set>
#include <tuple>
#include <unordered_map>

#include "base/sort_unique.h"
#include "language/compiler.h"
#include "language/condition_checks.h"
#include "language/conflict_checks.h"
#include "language/constants.h"
#include "language/facts.h"
#include "language/foreign_files.h"
#include "language/likely_slips.h"
#include "language/parser.h"
#include "language/place_index.h"
#include "language/repaired.h"
#include "language/rule_checks.h"
#include "language/start_checks.h"
#include "language/strategy_entries.h"
#include "language/typed_condition.h"
#include "language/typing.h"

namespace culprit {
namespace {

constexpr std::int64_t kMaxCount = 1000;
// In shorter ones a state of an hour would take hours to compute.
constexpr Duration kMinCycle = std::chrono::milliseconds(1);
constexpr Duration kMaxCycle = std::chrono::hours(1);
constexpr int kDefaultRounds = 3;  // each strategy is tried this often before the rule is exhausted

class Checker {
 public:
  Checker(const syntax::File& file, Strictness strictness, std::vector<Diagnostic>& diagnostics)
      : file_(file),
        diagnostics_(diagnostics),
        symbols_(rules_, strictness, diagnostics),
        strategies_(rules_, symbols_, diagnostics) {}

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
    define_constants(file_, symbols_, diagnostics_);
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
    for (std::size_t g = 0; g < rules_.groups.size(); ++g) {
      for (const ComponentId member : rules_.groups[g].members)
        groups_of_members_[member].emplace_back(g);
    }
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
      } else if (file_.cycle->length < kMinCycle) {
        report(Code::kPolicyRange, file_.cycle->span, "a cycle is at least 1 ms",
               "the paper's is 200ms");
      } else {
        rules_.cycle = file_.cycle->length;
      }
    }
    for (const syntax::Name& topic : file_.ignored_topics)
      rules_.ignored_topics.push_back(topic.text);
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
      if (!composed) continue;
      const auto container = symbols_.known_component(composed->container);
      if (container && container->index != part && rules_[*container].node == composed->container)
        rules_.dependencies.push_back({ComponentId(part), *container});
    }
  }

  void interlocks() {
    for (const syntax::Interlock& written : file_.interlocks) {
      if (auto typed = typed_condition(written.condition, "an INTERLOCK", symbols_, diagnostics_)) {
        rules_.interlocks.push_back({compile(*typed), written.text});
        file_conditions_.push_back({"INTERLOCK", std::move(*typed)});
      }
    }
  }

  void drills() {
    for (const syntax::Interlock& written : file_.aborts) {
      if (auto typed = typed_condition(written.condition, "an ABORT", symbols_, diagnostics_)) {
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
        const auto value =
            constant_value({written.subject, *written.value}, symbols_, diagnostics_);
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
    const std::size_t said = diagnostics_.size();
    Rule rule;
    rule.name = written.name.text;
    rule.declaration = written.name;
    if (!written.has_broken_part) check_complete(written);
    if (written.policies) policies(*written.policies, written, rule.policies);
    if (written.trigger) {
      if (auto typed = typed_condition(*written.trigger, "a trigger", symbols_, diagnostics_)) {
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
      const bool has_trigger = !conditions_.empty() && conditions_.back().rule == id;
      strategies_.add(strategy, id, has_trigger ? &conditions_.back() : nullptr);
    }
    Rule& added = rules_.rules[id.index];
    sort_unique(added.components);
    for (const StrategyId strategy : added.strategies)
      add_repaired(rules_[strategy], added.repaired);
    sort_unique(added.repaired);
    // How a component of a broken line is started is not known.
    if (!written.has_broken_part && !has_broken_declaration_) {
      check_launches(written, symbols_, rules_, id, said, diagnostics_);
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
      check_cooldown(rule, rules_, diagnostics_);
      check_true_when_well(rule, rules_, diagnostics_);
      check_compared_values(rule, rules_, diagnostics_);
      check_impacts(*rule.written, rules_, diagnostics_);
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
    check_fields(file_, diagnostics_);
    check_signals_as_statuses(file_, diagnostics_);
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
    const auto add_those_of = [&](ComponentId member) {
      const auto found = groups_of_members_.find(member);
      if (found == groups_of_members_.end()) return;
      rule.groups.insert(rule.groups.end(), found->second.begin(), found->second.end());
    };
    for (const ComponentId component : rule.components) add_those_of(component);
    for (const InputId input_id : rule.inputs) {
      const Input& input = rules_[input_id];
      if (input.kind == Input::Kind::kAlive || input.kind == Input::Kind::kLifecycle)
        add_those_of(input.component);
      const auto* source = input.kind == Input::Kind::kSignal
                               ? std::get_if<GroupId>(&rules_[input.signal].source)
                               : nullptr;
      if (source != nullptr) rule.groups.push_back(*source);
    }
    sort_unique(rule.groups);
    for (const GroupId group : rule.groups) {
      Input health;
      health.type = Type::kString;
      health.signal = rules_[group].health;
      auto& readers = rules_.inputs[symbols_.input(health).index].readers;
      // Rules are linked in their order, so this one is the last reader if it is one.
      if (readers.empty() || readers.back() != id) readers.push_back(id);
    }
  }

  void report(Code code, Span span, std::string cause, std::string remedy) {
    diagnostics_.push_back({code, Severity::kError, span, std::move(cause), std::move(remedy)});
  }

  const syntax::File& file_;
  std::vector<Diagnostic>& diagnostics_;
  RuleSet rules_;
  Symbols symbols_;
  StrategyEntries strategies_;
  bool has_broken_declaration_ = false;
  PlaceIndex rule_names_;
  std::unordered_map<ComponentId, std::vector<GroupId>> groups_of_members_;
  std::vector<RuleConditions> conditions_;  // of each rule that has a trigger
  std::vector<FileCondition> file_conditions_;
};

// The line above `use` that has the same statement; 0: none.
std::uint32_t line_of_twin(const Place& use, const Source& source) {
  const Source& file = source.file(use.file);
  const std::string statement(file.text(use.span));
  const std::uint32_t last = file.position(use.span.begin).line;
  for (std::uint32_t number = 1; number < last; ++number) {
    const std::string_view line = trimmed(file.text(file.line(number)));
    if (line == statement || line.starts_with(statement + " ")) return number;
  }
  return 0;
}

// A name of a template is one of the rules: a second USE with the same arguments gives it again. One report of such a
// USE is enough.
void name_uses(std::vector<Diagnostic>& diagnostics, const Source& source) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> twins;  // by file and place
  std::vector<Diagnostic> kept;
  for (Diagnostic& d : diagnostics) {
    const auto notes = located(d, source).notes;
    const auto use =
        std::ranges::find_if(notes, [](const auto& note) { return note.text == "used here"; });
    if (d.code == Code::kDuplicateName && use != notes.end()) {
      const std::uint32_t twin = line_of_twin(use->place, source);
      if (twin > 0 && !twins.emplace(use->place.file, use->place.span.begin).second) continue;
      d.remedy =
          twin > 0
              ? "remove one of the two equal USEs: the other one is in line " + std::to_string(twin)
              : "give each USE other arguments, and put a parameter into this name of the TEMPLATE";
    }
    kept.push_back(std::move(d));
  }
  diagnostics = std::move(kept);
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
