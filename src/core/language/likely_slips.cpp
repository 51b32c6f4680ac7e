#include "language/likely_slips.h"

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <string_view>

#include "language/functions.h"
#include "language/scanner.h"

namespace culprit {
namespace {

// No node is there, discovered and at work, in less.
constexpr Duration kFastestStart = std::chrono::milliseconds(400);
// An impact of so many cycles that takes so long was given in milliseconds.
constexpr std::int64_t kMilliseconds = 5000;
constexpr Duration kSlowestEffect = std::chrono::minutes(5);

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  // Most differ in their length: asked first, it spares the call that compares their letters.
  return std::any_of(words.begin(), words.end(), [&](std::string_view each) {
    return each.size() == word.size() && each == word;
  });
}

bool is_shell(std::string_view program) {
  return is_one_of(program.substr(program.rfind('/') + 1), {"sh", "bash", "dash", "zsh", "ksh"});
}

// NAME=value
bool sets_variable(std::string_view word) {
  const auto equals = word.find('=');
  return equals != std::string_view::npos && equals > 0 &&
         word.find_first_not_of(
             "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_0123456789") == equals;
}

// $NAME, anywhere in it
bool names_variable(std::string_view word) {
  const auto dollar = word.find('$');
  if (dollar == std::string_view::npos || dollar + 1 == word.size()) return false;
  const char first = word[dollar + 1];
  return (first >= 'A' && first <= 'Z') || (first >= 'a' && first <= 'z') || first == '_';
}

// A substitution, as in "$(find-pkg-share my_cameras)/config".
bool is_of_launch_file(std::string_view word) {
  return word.starts_with("$(find") || word.starts_with("$(var") || word.starts_with("$(env") ||
         word.starts_with("$(dirname");
}

struct ShellWord {
  std::string word;  // that only a shell understands; empty: there is none
  std::string remedy;
};

// `text`: the command as it is written.
ShellWord shell_word(const std::vector<std::string>& command, const std::string& text) {
  const std::string& program = command.front();
  if (is_shell(program)) return {};
  if (is_one_of(program, {"source", "."}))
    return {program,
            "a file to source first is a clause of its own: SETUP /opt/ros/humble/setup.bash"};
  if (program == "cd")
    return {program, "the folder to run in is a clause of its own: CWD /a/folder"};
  if (program == "export" || sets_variable(program))
    return {program, "variables are a clause of their own: ENV \"NAME=value\""};
  for (const std::string& word : command) {
    if (is_of_launch_file(word))
      return {word,
              "write the path in full, or LAUNCH \"package/file.launch.py#node\" for a node "
              "of a launch file"};
    if (word.find("\u2013") != std::string::npos || word.find("\u2014") != std::string::npos ||
        word.find("\u201c") != std::string::npos || word.find("\u201d") != std::string::npos)
      return {word, "write the - and the \" of the keyboard, not typographic ones"};
    if (is_one_of(word, {"&&", "||", ";", "|", "&", ">", ">>", "<", "2>&1"}) ||
        word.starts_with("$(") || word.starts_with("${"))
      return {word, "leave it out, or ask for a shell: LAUNCH \"bash -c '...'\""};
    // No shell would expand it either.
    if (text.find("'" + word + "'") != std::string::npos) continue;
    if (word == "~" || word.starts_with("~/"))
      return {word, "write the full path of the home folder: /home/robot" + word.substr(1)};
    if (names_variable(word))
      return {word, "write its value, or ask for a shell: LAUNCH \"bash -c '...'\""};
    if (has_hole(word))
      return {word, "write its value: braces name a parameter of a TEMPLATE only"};
    if (word.find('*') != std::string::npos && word.find(':') == std::string::npos)
      return {word, "name each file, or ask for a shell: LAUNCH \"bash -c '...'\""};
  }
  return {};
}

// source /a/setup.bash && program: with the clause that is meant instead.
std::optional<Edit> with_setup(const syntax::Component& written,
                               const std::vector<std::string>& command) {
  const bool is_so = command.size() > 3 && is_one_of(command[0], {"source", "."}) &&
                     command[1].starts_with('/') && is_one_of(command[2], {"&&", ";"});
  if (!is_so || written.setup) return std::nullopt;
  const std::string& text = written.launch->text;
  const auto begin = text.find(command[2]) + command[2].size();
  const auto first = text.find_first_not_of(" \t", begin);
  const bool is_plain = first != std::string::npos &&
                        text.find_first_of("\"\\\n\t") == std::string::npos &&
                        command[1].find_first_of(" ()#,") == std::string::npos;
  if (!is_plain) return std::nullopt;
  return Edit{written.launch->span, "\"" + text.substr(first) + "\" SETUP " + command[1]};
}

Duration impact_of(const syntax::Adaptation& a, const RuleSet& rules) {
  return duration_of(Cycles{static_cast<std::int64_t>(a.impact.value)}, rules);
}

void check_short_impact(const syntax::Adaptation& a, const RuleSet& rules,
                        std::vector<Diagnostic>& diagnostics) {
  const bool starts = a.type == AdaptationType::kRedeploy || a.type == AdaptationType::kStart;
  const Duration given = impact_of(a, rules);
  if (!starts || given >= kFastestStart) return;
  diagnostics.push_back(
      {Code::kShortImpact, Severity::kWarning, a.impact.span,
       "an impact of " + to_string(given) + " is over before a process is at work again",
       "count the cycles of " + to_string(rules.cycle) +
           " from the start of its node until the failure is cleared: 10 and more are usual"});
}

void check_long_impact(const syntax::Adaptation& a, const RuleSet& rules,
                       std::vector<Diagnostic>& diagnostics) {
  const auto count = static_cast<std::int64_t>(a.impact.value);
  const Duration given = impact_of(a, rules);
  if (count < kMilliseconds || given < kSlowestEffect) return;
  const std::int64_t meant =
      std::max<std::int64_t>(1, std::chrono::milliseconds(count) / rules.cycle);
  diagnostics.push_back({Code::kImpactRange, Severity::kWarning, a.impact.span,
                         "an impact counts cycles, and " + std::to_string(count) +
                             " of them take " + to_string(given),
                         "if these are milliseconds, write " + std::to_string(meant)});
}

// Calls `take` with the first argument of each call of one of `functions` in `e`.
void for_each_argument(const syntax::Expression& e,
                       std::initializer_list<std::string_view> functions,
                       const std::function<void(const syntax::Name&)>& take) {
  const bool is_one = e.kind == syntax::Expression::Kind::kCall && !e.children.empty() &&
                      is_one_of(e.name.text, functions);
  if (is_one) take(e.children[0].name);
  for (const syntax::Expression& child : e.children) for_each_argument(child, functions, take);
}

// Of a component.
void check_calls(const syntax::Expression& e,
                 const std::function<void(const syntax::Name&)>& check) {
  for_each_argument(e, {"alive", "lifecycle", "cpu", "memory"}, check);
}

void for_each_topic(const syntax::Expression& e,
                    const std::function<void(const syntax::Name&)>& take) {
  for_each_argument(e, {"age", "rate", "phi", "loss"}, take);
}

// Calls `take` with each name in `e` that is a value by itself.
void for_each_value(const syntax::Expression& e,
                    const std::function<void(const syntax::Name&)>& take) {
  if (e.kind == syntax::Expression::Kind::kName) take(e.name);
  const FunctionInfo* function =
      e.kind == syntax::Expression::Kind::kCall ? find_function(e.name.text) : nullptr;
  for (std::size_t i = 0; i < e.children.size(); ++i) {
    const bool is_value = function == nullptr || i >= function->arguments.size() ||
                          function->arguments[i] == Argument::kExpression;
    if (is_value) for_each_value(e.children[i], take);
  }
}

std::set<std::string_view> names_of_strategies(const syntax::File& file) {
  std::set<std::string_view> names;
  for (const syntax::Rule& rule : file.rules) {
    for (const syntax::Strategy& strategy : rule.strategies) names.insert(strategy.name.text);
  }
  return names;
}

// The names of constants, signals and groups.
std::set<std::string_view> names_of_values(const syntax::File& file) {
  std::set<std::string_view> names;
  for (const auto& each : file.constants) names.insert(each.name.text);
  for (const auto& each : file.signals) names.insert(each.name.text);
  for (const auto& each : file.groups) names.insert(each.name.text);
  return names;
}

}  // namespace

void check_impacts(const syntax::Rule& rule, const RuleSet& rules,
                   std::vector<Diagnostic>& diagnostics) {
  for (const syntax::Strategy& strategy : rule.strategies) {
    for (const syntax::Adaptation& a : strategy.adaptations) {
      check_short_impact(a, rules, diagnostics);
      check_long_impact(a, rules, diagnostics);
    }
  }
}

void check_settings_in_rules(const syntax::File& file, std::vector<Diagnostic>& diagnostics) {
  for (const syntax::Name& setting : file.settings_in_rules) {
    const bool is_condition = setting.text == "INTERLOCK";
    diagnostics.push_back(
        {Code::kSettingInRule, Severity::kWarning, setting.span,
         setting.text + " holds for the whole file, not only for the rule that it stands in",
         std::string("move it above the first RULE") +
             (is_condition ? "; for one strategy, write WHEN behind its two numbers" : "")});
  }
}

void check_shell(const syntax::Component& written, const Component& component,
                 std::vector<Diagnostic>& diagnostics) {
  if (!written.launch || component.launch.empty()) return;
  const ShellWord found = shell_word(component.launch, written.launch->text);
  if (found.word.empty()) return;
  diagnostics.push_back(
      {Code::kNoShell, Severity::kWarning, written.launch->span,
       "no shell reads this command, so '" + found.word + "' is a word like any other",
       found.remedy, with_setup(written, component.launch)});
}

void check_topics_as_components(const syntax::File& file, const RuleSet& rules,
                                std::vector<Diagnostic>& diagnostics) {
  std::set<std::string_view> topics;
  for (const Topic& topic : rules.topics) topics.insert(topic.name);
  // A node may be called like a topic, but then it is declared: first, in the order of the file.
  for (std::size_t i = 0; i < file.components.size(); ++i) {
    topics.erase(rules.components[i].node);
    for (const std::string& node : rules.components[i].other_nodes) topics.erase(node);
  }
  const auto check = [&](const syntax::Name& name) {
    if (!topics.contains(name.text)) return;
    diagnostics.push_back({Code::kUnknownName, Severity::kWarning, name.span,
                           "'" + name.text + "' is a topic of these rules, and no component",
                           "write the component that publishes it"});
  };
  for (const syntax::Dependency& dependency : file.dependencies) {
    check(dependency.consumer);
    for (const syntax::Name& producer : dependency.producers) check(producer);
  }
  for (const syntax::Rule& rule : file.rules) {
    if (rule.trigger) check_calls(*rule.trigger, check);
    for (const syntax::Strategy& strategy : rule.strategies) {
      if (strategy.when) check_calls(*strategy.when, check);
      for (const syntax::Adaptation& a : strategy.adaptations) check(a.component);
    }
  }
}

void check_nodes_as_topics(const syntax::File& file, const RuleSet& rules,
                           std::vector<Diagnostic>& diagnostics) {
  std::map<std::string_view, std::string_view> owners;  // by node
  for (const Component& component : rules.components) {
    if (component.declared && !component.node.empty())
      owners.emplace(component.node, component.name);
  }
  const auto is_undeclared_node = [&](const syntax::Adaptation& a) {
    return a.component.text.starts_with('/') && !owners.contains(a.component.text);
  };
  for (const syntax::Rule& rule : file.rules) {
    const bool adapts_other = std::ranges::any_of(rule.strategies, [&](const auto& strategy) {
      return std::ranges::any_of(strategy.adaptations, is_undeclared_node);
    });
    if (!adapts_other || !rule.trigger) continue;
    for_each_topic(*rule.trigger, [&](const syntax::Name& topic) {
      const auto owner = owners.find(topic.text);
      if (owner == owners.end()) return;
      diagnostics.push_back(
          {Code::kUnknownName, Severity::kWarning, topic.span,
           "'" + topic.text + "' is the node of component '" + std::string(owner->second) +
               "', and is read as a topic here",
           "if it was exchanged with the component that the rule adapts, write each in the other's "
           "place"});
    });
  }
}

void check_rules_as_values(const syntax::File& file, std::vector<Diagnostic>& diagnostics) {
  const std::set<std::string_view> values = names_of_values(file);
  std::set<std::string_view> names;
  for (const syntax::Rule& rule : file.rules) {
    // A rule may be called like the signal that it reads.
    bool is_signal = values.contains(rule.name.text);
    if (rule.trigger)
      for_each_value(*rule.trigger, [&](const syntax::Name& value) {
        is_signal = is_signal || value.text == rule.name.text;
      });
    if (!is_signal) names.insert(rule.name.text);
  }
  const std::set<std::string_view> strategies = names_of_strategies(file);
  const auto check = [&](const syntax::Name& value) {
    const bool is_rule = names.contains(value.text);
    if (!is_rule && (!strategies.contains(value.text) || values.contains(value.text))) return;
    diagnostics.push_back(
        {Code::kUnknownName, Severity::kWarning, value.span,
         "'" + value.text + "' is a " + (is_rule ? "rule" : "strategy") +
             ", and is read as a signal here",
         is_rule ? "write the condition of its TRIGGER, or declare a SIGNAL of this name"
                 : "write a condition; one that holds for this strategy only stands behind WHEN on "
                   "its line"});
  };
  for (const syntax::Interlock& interlock : file.interlocks)
    for_each_value(interlock.condition, check);
  for (const syntax::Rule& rule : file.rules) {
    if (rule.trigger) for_each_value(*rule.trigger, check);
    for (const syntax::Strategy& strategy : rule.strategies) {
      if (strategy.when) for_each_value(*strategy.when, check);
    }
  }
}

void check_fields(const syntax::File& file, std::vector<Diagnostic>& diagnostics) {
  for (const syntax::Signal& signal : file.signals) {
    const auto* topic = std::get_if<syntax::TopicSource>(&signal.source);
    constexpr std::string_view kMessage = "msg.";
    if (topic == nullptr || !topic->field.text.starts_with(kMessage)) continue;
    const std::string rest = topic->field.text.substr(kMessage.size());
    diagnostics.push_back({Code::kUnknownName, Severity::kWarning, topic->field.span,
                           "'msg' is read as a field of the message",
                           "if it stands for the message itself, write " + rest,
                           Edit{topic->field.span, rest}});
  }
}

void check_signals_as_statuses(const syntax::File& file, std::vector<Diagnostic>& diagnostics) {
  std::set<std::string_view> statuses;
  for (const syntax::Signal& signal : file.signals) {
    if (const auto* source = std::get_if<syntax::DiagnosticSource>(&signal.source))
      statuses.insert(source->status.text);
  }
  const auto check = [&](const syntax::Name& status) {
    const auto signal = std::ranges::find_if(
        file.signals, [&](const syntax::Signal& each) { return each.name.text == status.text; });
    if (signal == file.signals.end() || statuses.contains(status.text)) return;
    const auto* source = std::get_if<syntax::DiagnosticSource>(&signal->source);
    diagnostics.push_back(
        {Code::kUnknownName, Severity::kWarning, status.span,
         "level(" + status.text + ") reads a diagnostic status of this name, and no signal",
         source != nullptr ? "write the status of the signal: level(" + source->status.text + ")"
                           : "write the signal by itself, as in " + status.text + " < 0.2"});
  };
  for (const syntax::Rule& rule : file.rules) {
    if (rule.trigger) for_each_argument(*rule.trigger, {"level"}, check);
    for (const syntax::Strategy& strategy : rule.strategies) {
      if (strategy.when) for_each_argument(*strategy.when, {"level"}, check);
    }
  }
}

void check_unused(const syntax::File& file, const RuleSet& rules,
                  std::vector<Diagnostic>& diagnostics) {
  // A misspelt name may refer to the unused component.
  const bool is_misspelt = std::ranges::any_of(
      diagnostics, [](const Diagnostic& d) { return d.code == Code::kUnknownName; });
  if (rules.rules.empty() || is_misspelt) return;
  std::vector<bool> is_used(rules.components.size());
  const auto use = [&](ComponentId id) { is_used[id.index] = true; };
  for (const Strategy& strategy : rules.strategies) {
    for (const ComponentId id : strategy.components) use(id);
  }
  for (const Input& input : rules.inputs) {
    using enum Input::Kind;
    const bool is_of_component = input.kind == kAlive || input.kind == kLifecycle ||
                                 input.kind == kCpu || input.kind == kMemory || input.kind == kLogs;
    if (is_of_component) use(input.component);
  }
  for (const Topic& topic : rules.topics) {
    if (topic.publisher) use(*topic.publisher);
  }
  for (std::size_t s = 0; s < rules.signals.size(); ++s) {
    if (const auto publisher = publisher_of(SignalId(s), rules)) use(*publisher);
  }
  for (const Group& group : rules.groups) {
    for (const ComponentId member : group.members) use(member);
    use(group.manager);
  }
  for (const Parameter& parameter : rules.parameters) use(parameter.component);
  for (const Dependency& dependency : rules.dependencies) {
    use(dependency.consumer);
    use(dependency.producer);
  }
  // Declared components come first, in the order of the file.
  for (std::size_t i = 0; i < file.components.size(); ++i) {
    const Component& component = rules.components[i];
    if (is_used[i] || component.is_required) continue;
    diagnostics.push_back(
        {Code::kUnused, Severity::kWarning, file.components[i].name.span,
         "no rule uses component '" + component.name + "'",
         "name it in a rule, as in !alive(" + component.name +
             "), or remove this line; with REQUIRED, culprit reports it if it is missing"});
  }
}

}  // namespace culprit
