#include "knowledge/condensation.h"

#include <algorithm>
#include <limits>

namespace culprit {
namespace {

using Vertex = Condensation::Vertex;
using Edge = std::pair<Vertex, Vertex>;

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// Neighbours in one array: those of v are targets[first[v]] to targets[first[v + 1]].
struct Neighbours {
  std::vector<std::uint32_t> first;
  std::vector<Vertex> targets;

  Neighbours(std::size_t vertices, std::span<const Edge> edges)
      : first(vertices + 1, 0), targets(edges.size()) {
    for (const Edge& edge : edges) ++first[edge.first + 1];
    for (std::size_t v = 0; v < vertices; ++v) first[v + 1] += first[v];
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (const Edge& edge : edges) targets[next[edge.first]++] = edge.second;
  }
};

// Tarjan's search, with its own stack: a long chain must not overflow the program's.
class Traversal {
 public:
  explicit Traversal(const Neighbours& neighbours)
      : neighbours_(neighbours),
        number_(neighbours.first.size() - 1, kNone),
        low_(number_.size()),
        scc_of_(number_.size(), kNone) {}

  std::vector<Condensation::Scc> run() {
    for (Vertex v = 0; v < number_.size(); ++v) {
      if (number_[v] == kNone) visit_from(v);
    }
    return std::move(scc_of_);
  }
  std::uint32_t sccs() const { return sccs_; }

 private:
  struct Call {
    Vertex vertex;
    std::uint32_t next;  // of its edges
  };

  void enter(Vertex v) {
    number_[v] = low_[v] = count_++;
    open_.push_back(v);
    calls_.push_back({v, neighbours_.first[v]});
  }

  void visit_from(Vertex root) {
    enter(root);
    while (!calls_.empty()) {
      Call& call = calls_.back();
      const Vertex v = call.vertex;
      if (call.next == neighbours_.first[v + 1]) {
        calls_.pop_back();
        if (!calls_.empty()) lower(calls_.back().vertex, low_[v]);
        if (low_[v] == number_[v]) close(v);
        continue;
      }
      const Vertex target = neighbours_.targets[call.next++];
      if (number_[target] == kNone) {
        enter(target);
      } else if (scc_of_[target] == kNone) {
        lower(v, number_[target]);
      }
    }
  }

  void lower(Vertex v, std::uint32_t to) { low_[v] = std::min(low_[v], to); }

  void close(Vertex root) {
    Vertex v = kNone;
    do {
      v = open_.back();
      open_.pop_back();
      scc_of_[v] = sccs_;
    } while (v != root);
    ++sccs_;
  }

  const Neighbours& neighbours_;
  std::vector<std::uint32_t> number_;  // in the order of visits
  std::vector<std::uint32_t> low_;     // the lowest number known to be reached
  std::vector<Condensation::Scc> scc_of_;
  std::vector<Vertex> open_;  // visited, and in no SCC yet
  std::vector<Call> calls_;
  std::uint32_t count_ = 0;
  std::uint32_t sccs_ = 0;
};

}  // namespace

void ChannelEdges::add(std::span<const Vertex> producers, std::span<const Vertex> consumers) {
  // Most channels have one producer, which then stands for the channel.
  Vertex middle = producers.front();
  if (producers.size() > 1) {
    middle = static_cast<Vertex>(vertices_++);
    for (const Vertex producer : producers) edges_.emplace_back(middle, producer);
  }
  for (const Vertex consumer : consumers) edges_.emplace_back(consumer, middle);
}

Condensation::Condensation(std::size_t vertices, std::span<const Edge> edges) {
  const Neighbours neighbours(vertices, edges);
  Traversal search(neighbours);
  scc_of_ = search.run();
  std::vector<Edge> between;
  between.reserve(edges.size());
  for (const Edge& edge : edges) {
    const Edge sccs(scc_of_[edge.first], scc_of_[edge.second]);
    if (sccs.first != sccs.second) between.push_back(sccs);
  }
  Neighbours condensed(search.sccs(), between);
  first_producer_ = std::move(condensed.first);
  producers_ = std::move(condensed.targets);
}

}  // namespace culprit
