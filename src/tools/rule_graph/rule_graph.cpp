#include "rule_graph/rule_graph.h"

#include <algorithm>
#include <map>
#include <variant>

#include <fmt/core.h>

#include "diagnose/touched.h"
#include "knowledge/describe.h"
#include "language/occurrences.h"
#include "language/parser.h"

namespace culprit::rule_graph {
namespace {

// Where each component is declared, or else named first.
std::map<std::string, Span> spans_of_components(const Source& source) {
  std::vector<Diagnostic> known;  // whoever checked the rules has said so
  std::map<std::string, Span> spans;
  std::map<std::string, Span> declared;
  for (const Occurrence& each : occurrences(parse(source, known), source)) {
    if (each.kind != Occurrence::Kind::kComponent) continue;
    (each.declares ? declared : spans).emplace(each.name, each.span);
  }
  for (const auto& [name, span] : declared) spans[name] = span;
  return spans;
}

std::vector<ComponentId> read_by(const Rule& rule, const RuleSet& rules) {
  std::vector<ComponentId> all;
  const auto of_parameter = [&](ParameterId id) { all.push_back(rules[id].component); };
  for (const InputId id : rule.inputs) {
    const Input& input = rules[id];
    switch (input.subject()) {
      case Input::Subject::kComponent:
        all.push_back(input.component);
        break;
      case Input::Subject::kParameter:
        of_parameter(input.parameter);
        break;
      case Input::Subject::kSignal:
        if (const auto* parameter = std::get_if<ParameterId>(&rules[input.signal].source))
          of_parameter(*parameter);
        if (const auto publisher = publisher_of(input.signal, rules)) all.push_back(*publisher);
        break;
      case Input::Subject::kTopic:
        if (input.kind == Input::Kind::kGoals || input.kind == Input::Kind::kGoalAge) break;
        if (const auto& publisher = rules[input.topic].publisher) all.push_back(*publisher);
        break;
      case Input::Subject::kDiagnostic:
        break;
    }
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

// By producer.
using Consumers = std::vector<std::vector<ComponentId>>;
Consumers consumers_in(const RuleSet& rules) {
  Consumers consumers(rules.components.size());
  for (const Dependency& each : rules.dependencies)
    consumers[each.producer.index].push_back(each.consumer);
  return consumers;
}

std::vector<ComponentId> reached_by(RuleId rule, const Consumers& consumers,
                                    const Knowledge& knowledge) {
  std::vector<ComponentId> path = diagnose::spreads_from(rule, knowledge);
  const std::size_t own = path.size();
  std::vector<bool> seen(consumers.size());
  for (const ComponentId c : path) seen[c.index] = true;
  for (std::size_t i = 0; i < path.size(); ++i) {
    for (const ComponentId next : consumers[path[i].index]) {
      if (!seen[next.index]) path.push_back(next);
      seen[next.index] = true;
    }
  }
  path.erase(path.begin(), path.begin() + static_cast<std::ptrdiff_t>(own));
  std::sort(path.begin(), path.end());
  return path;
}

Json with_mistake(Json entry, const std::optional<Severity>& mistake) {
  if (mistake) entry["mistake"] = *mistake == Severity::kError ? "error" : "warning";
  return entry;
}

Json with_place(Json entry, const RuleGraph::Place& place) {
  entry["file"] = place.file;
  entry["line"] = place.at.line;
  entry["column"] = place.at.column;
  return entry;
}

std::string listed_components(const std::vector<ComponentId>& components, const RuleGraph& graph) {
  std::string text;
  for (const ComponentId id : components)
    text += (text.empty() ? "" : ", ") + graph.components[id.index].name;
  return text;
}

}  // namespace

RuleGraph::Place place_of(Span span, const Source& source) {
  const auto written = source.origin(span).place;
  const Source& file = source.file(written.file);
  return {file.name(), file.position(written.span.begin)};
}

RuleGraph graph_of(const RuleSet& rules, const Source& source) {
  RuleGraph graph;
  const std::map<std::string, Span> spans = spans_of_components(source);
  for (const culprit::Component& each : rules.components) {
    RuleGraph::Component component{each.name, each.node, each.declared, std::nullopt};
    if (const auto found = spans.find(each.name); found != spans.end())
      component.place = place_of(found->second, source);
    graph.components.push_back(std::move(component));
  }
  graph.dependencies = rules.dependencies;
  const Knowledge knowledge(rules);
  const Consumers consumers = consumers_in(rules);
  for (std::size_t r = 0; r < rules.rules.size(); ++r) {
    const culprit::Rule& each = rules.rules[r];
    graph.rules.push_back({each.name, each.policies.criticality, read_by(each, rules),
                           each.components, reached_by(RuleId(r), consumers, knowledge),
                           place_of(each.declaration.span, source)});
  }
  return graph;
}

std::string as_text(const RuleGraph& graph) {
  if (graph.components.empty() && graph.rules.empty()) return "no components and no rules\n";
  std::vector<std::string> needs(graph.components.size());
  for (const Dependency& each : graph.dependencies)
    needs[each.consumer.index] += "  needs " + graph.components[each.producer.index].name + "\n";
  std::string text;
  for (std::size_t c = 0; c < graph.components.size(); ++c) {
    const RuleGraph::Component& each = graph.components[c];
    text += each.name + (each.node.empty() ? "" : "  (" + each.node + ")") + "\n" + needs[c];
  }
  for (const RuleGraph::Rule& rule : graph.rules) {
    text += fmt::format("{}  ({})\n", rule.name, to_string(rule.criticality));
    if (!rule.reads.empty()) text += "  looks at " + listed_components(rule.reads, graph) + "\n";
    text += rule.adapts.empty() ? "  adapts nothing\n"
                                : "  adapts " + listed_components(rule.adapts, graph) + "\n";
    if (!rule.spreads.empty())
      text += "  may spread to " + listed_components(rule.spreads, graph) + "\n";
  }
  return text;
}

Json as_json(const RuleGraph& graph) {
  Json components = Json::array();
  for (const RuleGraph::Component& each : graph.components) {
    Json entry = with_mistake(
        {{"name", each.name}, {"node", each.node}, {"declared", each.is_declared}}, each.mistake);
    components.push_back(each.place ? with_place(std::move(entry), *each.place) : entry);
  }
  const auto name_of = [&](ComponentId id) { return graph.components[id.index].name; };
  Json dependencies = Json::array();
  for (const Dependency& each : graph.dependencies)
    dependencies.push_back(
        {{"consumer", name_of(each.consumer)}, {"producer", name_of(each.producer)}});
  const auto names = [&](const std::vector<ComponentId>& all) {
    Json list = Json::array();
    for (const ComponentId id : all) list.push_back(name_of(id));
    return list;
  };
  Json rules = Json::array();
  for (const RuleGraph::Rule& each : graph.rules)
    rules.push_back(with_mistake(with_place({{"name", each.name},
                                             {"criticality", to_string(each.criticality)},
                                             {"reads", names(each.reads)},
                                             {"adapts", names(each.adapts)},
                                             {"spreads", names(each.spreads)}},
                                            each.place),
                                 each.mistake));
  return {{"components", std::move(components)},
          {"dependencies", std::move(dependencies)},
          {"rules", std::move(rules)}};
}

std::string in_dot(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

// A rule may have the same name as a component: a prefix distinguishes them.
std::string as_dot(const RuleGraph& graph) {
  std::string text = "digraph rules {\n  rankdir=LR;\n";
  const auto component = [&](ComponentId id) {
    return in_dot("component " + graph.components[id.index].name);
  };
  for (std::size_t c = 0; c < graph.components.size(); ++c)
    text += fmt::format("  {} [shape=box, label={}];\n", component(ComponentId(c)),
                        in_dot(graph.components[c].name));
  for (const Dependency& each : graph.dependencies)
    text += fmt::format("  {} -> {};\n", component(each.producer), component(each.consumer));
  for (const RuleGraph::Rule& each : graph.rules) {
    const std::string rule = in_dot("rule " + each.name);
    text += fmt::format("  {} [shape=ellipse, label={}];\n", rule, in_dot(each.name));
    for (const ComponentId id : each.reads)
      text += fmt::format("  {} -> {} [style=dotted];\n", component(id), rule);
    for (const ComponentId id : each.adapts)
      text += fmt::format("  {} -> {} [style=dashed];\n", rule, component(id));
  }
  return text + "}\n";
}

}  // namespace culprit::rule_graph
