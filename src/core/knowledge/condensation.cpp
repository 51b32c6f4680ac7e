#include "knowledge/condensation.h"

#include <algorithm>
#include <limits>

#include "base/invariant.h"

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
      : first(vertices + 2, 0), targets(edges.size()) {
    for (const Edge& edge : edges) ++first[edge.first + 2];
    for (std::size_t v = 0; v < vertices; ++v) first[v + 2] += first[v + 1];
    // Now first[v + 1] is where those of v begin; it comes to be where they end.
    for (const Edge& edge : edges) targets[first[edge.first + 1]++] = edge.second;
  }
  std::span<const Vertex> of(Vertex v) const {
    return std::span(targets).subspan(first[v], first[v + 1] - first[v]);
  }
};

// Tarjan's search, with its own stack: a long chain must not overflow the program's.
class Traversal {
 public:
  Traversal(std::size_t vertices, const Neighbours& neighbours, Condensation::Sccs& found)
      : neighbours_(neighbours), number_(vertices, kNone), low_(vertices), found_(found) {
    found_.of.assign(vertices, kNone);
    found_.first_producer.reserve(vertices + 1);
    found_.first_producer.push_back(0);
    found_.producers.reserve(neighbours.targets.size());
    open_.reserve(vertices);
    calls_.reserve(vertices);
  }

  void run() {
    for (Vertex v = 0; v < number_.size(); ++v) {
      if (number_[v] == kNone) visit_from(v);
    }
  }

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
      } else if (found_.of[target] == kNone) {
        lower(v, number_[target]);
      }
    }
  }

  void lower(Vertex v, std::uint32_t to) { low_[v] = std::min(low_[v], to); }

  // From `root` on, the open vertices are an SCC. All its dependencies are in one now.
  void close(Vertex root) {
    const auto scc = static_cast<Condensation::Scc>(found_.first_producer.size() - 1);
    const auto place = std::find(open_.rbegin(), open_.rend(), root);
    CULPRIT_ASSERT(place != open_.rend());
    const auto first = place.base() - 1;
    std::for_each(first, open_.end(), [&](Vertex member) { found_.of[member] = scc; });
    std::for_each(first, open_.end(), [&](Vertex member) {
      for (const Vertex target : neighbours_.of(member)) {
        // A consumer would be judged, and repaired, before what it depends on.
        CULPRIT_ASSERT(found_.of[target] <= scc);
        if (found_.of[target] != scc) found_.producers.push_back(found_.of[target]);
      }
    });
    found_.first_producer.push_back(static_cast<std::uint32_t>(found_.producers.size()));
    open_.erase(first, open_.end());
  }

  const Neighbours& neighbours_;
  std::vector<std::uint32_t> number_;  // in the order of visits
  std::vector<std::uint32_t> low_;     // the lowest number known to be reached
  Condensation::Sccs& found_;
  std::vector<Vertex> open_;  // visited, and in no SCC yet
  std::vector<Call> calls_;
  std::uint32_t count_ = 0;
};

}  // namespace

void ChannelEdges::add(std::span<const Vertex> producers, std::span<const Vertex> consumers) {
  CULPRIT_ASSERT(!producers.empty() && !consumers.empty());
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
  Traversal(vertices, neighbours, sccs_).run();
}

}  // namespace culprit
