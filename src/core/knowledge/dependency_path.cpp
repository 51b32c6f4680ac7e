#include "knowledge/dependency_path.h"

#include <algorithm>
#include <deque>
#include <map>

namespace culprit {

std::vector<DependencyGraph::Edge> dependency_path(std::span<const DependencyGraph::Edge> edges,
                                                   const std::string& consumer,
                                                   const std::string& producer) {
  using Link = DependencyGraph::Edge;
  std::multimap<std::string, const Link*> of_consumer;
  for (const Link& edge : edges) of_consumer.emplace(edge.consumer, &edge);
  std::map<std::string, const Link*> reached_by;  // the edge that led there
  std::deque<std::string> frontier{consumer};
  while (!frontier.empty() && !reached_by.contains(producer)) {
    const std::string here = std::move(frontier.front());
    frontier.pop_front();
    const auto [begin, end] = of_consumer.equal_range(here);
    for (auto each = begin; each != end; ++each) {
      const std::string& next = each->second->producer;
      if (next != consumer && reached_by.emplace(next, each->second).second)
        frontier.push_back(next);
    }
  }
  std::vector<Link> path;
  for (auto step = reached_by.find(producer); step != reached_by.end();
       step = reached_by.find(step->second->consumer))
    path.push_back(*step->second);
  std::ranges::reverse(path);
  return path;
}

}  // namespace culprit
