// The graph of a text that is being written, so that it may have errors: what has them is drawn without its connections, or left out, and marked.
#pragma once

#include "base/expected.h"
#include "language/reuse/expansion.h"
#include "rule_graph/rule_graph.h"

namespace culprit::rule_graph {

struct Draft {
  RuleGraph graph;
  std::size_t errors = 0;
  std::size_t warnings = 0;
};

// The most components and rules of a draft, together, and the most dependencies: the failure of each rule spreads along them.
inline constexpr std::size_t kMostDrawn = 2000;
inline constexpr std::size_t kMostDependencies = 20'000;

// The graph is empty if the text cannot be put together (INCLUDE, USE). Errors: more than these.
Expected<Draft> graph_of_draft(const Expansion& rules);

}  // namespace culprit::rule_graph
