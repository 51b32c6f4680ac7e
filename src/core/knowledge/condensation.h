// The dependency graph with every feedback loop condensed into one node, to answer questions about many components at once.
//
// An SCC is a node, or several that all depend on each other (a strongly connected component). The
// SCCs are numbered so that each comes after all that it depends on: one pass from the first to
// the last carries anything from producers to all their consumers.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace culprit {

// The edges of channels with several ends: a channel with p producers and c consumers takes p + c
// of them, not p * c.
class ChannelEdges {
 public:
  using Vertex = std::uint32_t;

  explicit ChannelEdges(std::size_t vertices) : vertices_(vertices) {}
  // Room for channels with so many ends in all.
  void reserve(std::size_t ends) { edges_.reserve(ends); }
  // Neither is empty.
  void add(std::span<const Vertex> producers, std::span<const Vertex> consumers);

  std::size_t vertices() const { return vertices_; }  // with those that stand for channels
  std::span<const std::pair<Vertex, Vertex>> edges() const { return edges_; }

 private:
  std::size_t vertices_;
  std::vector<std::pair<Vertex, Vertex>> edges_;
};

class Condensation {
 public:
  using Scc = std::uint32_t;
  using Vertex = std::uint32_t;

  // `edges` lead from a consumer to a producer; both are below `vertices`. Tarjan's algorithm.
  Condensation(std::size_t vertices, std::span<const std::pair<Vertex, Vertex>> edges);

  std::size_t size() const { return sccs_.first_producer.size() - 1; }
  Scc scc_of(Vertex vertex) const { return sccs_.of[vertex]; }
  // The direct dependencies of an SCC: lower numbers, possibly more than once.
  std::span<const Scc> producers(Scc scc) const {
    const auto& first = sccs_.first_producer;
    return std::span(sccs_.producers).subspan(first[scc], first[scc + 1] - first[scc]);
  }

  // The result of the search.
  struct Sccs {
    std::vector<Scc> of;                        // by vertex
    std::vector<std::uint32_t> first_producer;  // by SCC, and the end
    std::vector<Scc> producers;
  };

 private:
  Sccs sccs_;
};

}  // namespace culprit
