// A rule file as a graph: the components, their declared dependencies, and which components each rule reads and adapts. No robot is asked: subscriptions are
// not in a file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "language/rule_set.h"
#include "language/source.h"

namespace culprit::cli {

struct RuleGraph {
  struct Place {
    std::string file;  // as it was opened
    Position at;
  };
  struct Component {
    std::string name;
    std::string node;            // empty: whichever has that name
    bool is_declared = true;     // else `place` is where it is named first
    std::optional<Place> place;  // nothing if nobody has written it
  };
  struct Rule {
    std::string name;
    Criticality criticality = Criticality::kNonCritical;
    // Components, each once, ascending. A topic has no publisher until a robot runs.
    std::vector<ComponentId> reads;  // whether they live, their lifecycle, their parameters
    std::vector<ComponentId> adapts;
    Place place;
  };
  std::vector<Component> components;  // by ComponentId
  std::vector<Dependency> dependencies;
  std::vector<Rule> rules;
};

// `source` is what `rules` were read from.
RuleGraph graph_of(const RuleSet& rules, const Source& source);

std::string as_text(const RuleGraph& graph);
// {"components": [{name, node, declared, file, line, column}], "dependencies": [{consumer, producer}], "rules": [{name,
// criticality, reads: [component], adapts: [component], file, line, column}]}. Lines and columns count from 1, columns in
// characters. Invalid UTF-8 becomes U+FFFD.
std::string as_json(const RuleGraph& graph);
// For Graphviz.
std::string as_dot(const RuleGraph& graph);

// A text as Graphviz takes it, in quotes.
std::string in_dot(const std::string& text);

}  // namespace culprit::cli
