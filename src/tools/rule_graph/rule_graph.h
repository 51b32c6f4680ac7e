// A rule file as a graph: the components, their declared dependencies, which components each rule reads and adapts, and which ones its failure may spread to.
// No robot is asked: subscriptions are not in a file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "json/json.h"
#include "language/diagnostic.h"
#include "language/rule_set.h"
#include "language/source.h"

namespace culprit::rule_graph {

struct RuleGraph {
  struct Place {
    std::string file;  // as it was opened
    Position at;
  };
  struct Component {
    std::string name;
    std::string node;                   // empty: whichever has that name
    bool is_declared = true;            // else `place` is where it is named first
    std::optional<Place> place;         // nothing if nobody has written it
    std::optional<Severity> mistake{};  // the worst in its declaration
  };
  struct Rule {
    std::string name;
    Criticality criticality = Criticality::kNonCritical;
    // Components, each once, ascending. A topic has no publisher until a robot runs.
    std::vector<ComponentId> reads;  // whether they live, their lifecycle, their parameters
    std::vector<ComponentId> adapts;
    std::vector<ComponentId> spreads;  // depend on what it is about, directly or through others
    Place place;
    std::optional<Severity> mistake{};  // the worst in its lines
  };
  std::vector<Component> components;  // by ComponentId
  std::vector<Dependency> dependencies;
  std::vector<Rule> rules;
};

// Where a part of the text is written.
RuleGraph::Place place_of(Span span, const Source& source);

// `source` is what `rules` were read from.
RuleGraph graph_of(const RuleSet& rules, const Source& source);

std::string as_text(const RuleGraph& graph);
// {"components": [{name, node, declared, file, line, column}], "dependencies": [{consumer, producer}], "rules": [{name,
// criticality, reads: [component], adapts: [component], spreads: [component], file, line, column}]}. Lines and columns count
// from 1, columns in characters. Those with a mistake have the member "mistake": "error" or "warning".
Json as_json(const RuleGraph& graph);
// For Graphviz.
std::string as_dot(const RuleGraph& graph);

// A text as Graphviz takes it, in quotes.
std::string in_dot(const std::string& text);

}  // namespace culprit::rule_graph
