#include "rule_graph/draft_graph.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <set>

#include "language/checker.h"
#include "language/parser.h"

namespace culprit::rule_graph {
namespace {

// Each leaves out what the errors of the one before were about; what is still wrong then is not drawn.
constexpr int kMostRounds = 4;

std::string_view first_word(std::string_view line) {
  const std::size_t begin = std::min(line.find_first_not_of(" \t"), line.size());
  return line.substr(begin, line.find_first_of(" \t\r", begin) - begin);
}

// Those of a rule's lines have other words.
bool begins_declaration(std::string_view line) {
  static constexpr std::array<std::string_view, 15> kWords = {
      "ROBOT", "CYCLE", "CONST",  "COMPONENT", "DEPENDENCY", "GROUP", "IGNORE", "INTERLOCK",
      "ABORT", "DRILL", "SIGNAL", "INCLUDE",   "TEMPLATE",   "END",   "USE"};
  return std::ranges::find(kWords, first_word(line)) != kWords.end();
}

// Finds the component or rule that a line belongs to.
class Statements {
 public:
  Statements(const syntax::File& file, const Source& source) : source_(source) {
    for (std::uint32_t line = 1; line <= source.line_count(); ++line) {
      if (first_word(source.text(source.line(line))) == "RULE") rules_[line] = "";
    }
    for (const syntax::Component& each : file.components)
      components_.emplace(line_of(each.name.span), each.name.text);
    for (const syntax::Rule& each : file.rules) rules_[line_of(each.name.span)] = each.name.text;
  }

  enum class Kind : std::uint8_t { kComponent, kRule, kOther };
  struct Statement {
    Kind kind = Kind::kOther;
    std::string name{};
    auto operator<=>(const Statement&) const = default;
  };
  std::uint32_t line_of(Span span) const { return source_.position(span.begin).line; }
  Statement of(const Diagnostic& diagnostic) const {
    const std::uint32_t line = line_of(diagnostic.span);
    if (const auto found = components_.find(line); found != components_.end())
      return {Kind::kComponent, found->second};
    const auto next = rules_.upper_bound(line);
    if (next == rules_.begin() || begins_declaration(source_.text(source_.line(line)))) return {};
    return {Kind::kRule, std::prev(next)->second};
  }

 private:
  const Source& source_;
  std::map<std::uint32_t, std::string> components_;  // by line
  std::map<std::uint32_t, std::string> rules_;       // by their first line
};

// Leaves out the statements that `errors` are about.
void leave_out(const std::vector<Diagnostic>& errors, const Source& source, syntax::File& file) {
  const Statements statements(file, source);
  std::set<std::uint32_t> lines;
  std::set<std::string> rules;
  for (const Diagnostic& each : errors) {
    if (each.severity != Severity::kError) continue;
    lines.insert(statements.line_of(each.span));
    const auto statement = statements.of(each);
    if (statement.kind == Statements::Kind::kRule) rules.insert(statement.name);
  }
  const auto is_wrong = [&](Span span) { return lines.contains(statements.line_of(span)); };
  std::erase_if(file.rules, [&](const auto& each) { return rules.contains(each.name.text); });
  std::erase_if(file.components, [&](const auto& each) { return is_wrong(each.name.span); });
  std::erase_if(file.constants, [&](const auto& each) { return is_wrong(each.name.span); });
  std::erase_if(file.dependencies, [&](const auto& each) { return is_wrong(each.consumer.span); });
  std::erase_if(file.groups, [&](const auto& each) { return is_wrong(each.name.span); });
  std::erase_if(file.signals, [&](const auto& each) { return is_wrong(each.name.span); });
  std::erase_if(file.interlocks, [&](const auto& each) { return is_wrong(each.condition.span); });
  std::erase_if(file.aborts, [&](const auto& each) { return is_wrong(each.condition.span); });
  std::erase_if(file.drills, [&](const auto& each) { return is_wrong(each.component.span); });
}

// Those rules of the text that the graph lacks, with what they adapt as far as the graph has it.
void add_left_out(const syntax::File& file, const Source& source, RuleGraph& graph) {
  std::map<std::string, ComponentId> known;
  for (std::size_t c = 0; c < graph.components.size(); ++c)
    known.emplace(graph.components[c].name, ComponentId(c));
  for (const syntax::Component& each : file.components) {
    if (!known.emplace(each.name.text, ComponentId(graph.components.size())).second) continue;
    graph.components.push_back(
        {each.name.text, each.node ? each.node->text : "", true, place_of(each.name.span, source)});
  }
  std::set<std::string> drawn;
  for (const RuleGraph::Rule& each : graph.rules) drawn.insert(each.name);
  for (const syntax::Rule& each : file.rules) {
    if (each.name.text.empty() || !drawn.insert(each.name.text).second) continue;
    std::set<ComponentId> adapts;
    for (const syntax::Strategy& strategy : each.strategies) {
      for (const syntax::Adaptation& adaptation : strategy.adaptations) {
        if (const auto found = known.find(adaptation.component.text); found != known.end())
          adapts.insert(found->second);
      }
    }
    graph.rules.push_back({each.name.text,
                           each.policies ? each.policies->criticality : Criticality::kNonCritical,
                           {},
                           {adapts.begin(), adapts.end()},
                           {},
                           place_of(each.name.span, source)});
  }
}

void mark(const std::vector<Diagnostic>& said, const Statements& statements, Draft& draft) {
  std::map<Statements::Statement, Severity> worst;
  for (const Diagnostic& each : said) {
    const bool is_error = each.severity == Severity::kError;
    ++(is_error ? draft.errors : draft.warnings);
    const auto [entry, is_new] = worst.emplace(statements.of(each), each.severity);
    if (is_error) entry->second = Severity::kError;
  }
  const auto mark_as = [&](Statements::Kind kind, auto& all) {
    for (auto& each : all) {
      if (const auto found = worst.find({kind, each.name}); found != worst.end())
        each.mistake = found->second;
    }
  };
  mark_as(Statements::Kind::kComponent, draft.graph.components);
  mark_as(Statements::Kind::kRule, draft.graph.rules);
}

Error too_much(std::size_t most, const char* what) {
  return {"the graph is not drawn: these are more than " + std::to_string(most) + what};
}

// Error: too much to draw.
Expected<void> fits(std::size_t nodes, std::size_t dependencies) {
  if (nodes > kMostDrawn) return too_much(kMostDrawn, " components and rules");
  if (dependencies > kMostDependencies) return too_much(kMostDependencies, " dependencies");
  return {};
}

}  // namespace

Expected<Draft> graph_of_draft(const Expansion& rules) {
  Draft draft;
  if (!rules.mistakes.empty()) {
    draft.errors = rules.mistakes.size();
    return draft;
  }
  Parsed whole = parse_whole(rules.source);
  const syntax::File written = whole.file;
  if (auto few = fits(written.components.size() + written.rules.size(), 0); !few)
    return Error{few.error()};
  Checked checked = check(rules, whole);
  const std::vector<Diagnostic> said = checked.diagnostics;
  for (int round = 0; !checked.rules && round < kMostRounds; ++round) {
    leave_out(checked.diagnostics, rules.source, whole.file);
    whole.said.clear();
    checked = check(rules, whole);
  }
  if (checked.rules) {
    const RuleSet& all = *checked.rules;
    if (auto few = fits(all.components.size() + all.rules.size(), all.dependencies.size()); !few)
      return Error{few.error()};
    draft.graph = graph_of(all, rules.source);
  }
  add_left_out(written, rules.source, draft.graph);
  mark(said, Statements(written, rules.source), draft);
  return draft;
}

}  // namespace culprit::rule_graph
