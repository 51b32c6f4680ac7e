// The condensation of a graph whose edges come and go: circles are drawn together and fall apart
// one at a time, instead of all being found anew (knowledge/condensation.h says what an SCC is).
//
//   - An edge that comes changes the order of the SCCs between its ends, and merges those that it
//     closes a circle of (knowledge/scc_order.h).
//   - An edge that goes between two SCCs changes nothing but that. One that goes inside an SCC has
//     this one SCC examined (knowledge/circle_split.h).
//
// Which order the SCCs are in depends on the order of changes; who depends on whom does not. When
// much of the graph changes at once, it is condensed anew.
#pragma once

#include <map>

#include "knowledge/circle_split.h"
#include "knowledge/scc_order.h"

namespace culprit {

class LiveCondensation {
 public:
  using Vertex = Adjacency::Index;
  using Scc = SccOrder::Scc;
  using Edge = CircleSplit::Edge;
  static constexpr Scc kNone = SccOrder::kNone;

  // A vertex without edges. They are numbered from 0.
  Vertex add_vertex();
  // An edge may be there several times. @pre those that are removed are there
  void update(std::span<const Edge> removed, std::span<const Edge> added);

  // SCCs are numbers below this; not each of them is one.
  std::size_t size() const { return members_.size(); }
  Scc scc_of(Vertex vertex) const { return scc_of_[vertex]; }
  // What an SCC depends on directly, possibly more than once.
  std::span<const Scc> producers(Scc scc) const { return sccs_.producers(scc); }

  // The places of the order in which each SCC comes after all that it depends on.
  std::size_t places() const { return order_.places(); }
  // kNone: nothing is there.
  Scc at(std::size_t place) const { return order_.at(place); }
  std::size_t place_of(Scc scc) const { return order_.place_of(scc); }

 private:
  void add(const Edge& edge);
  void merge(std::span<const Scc> circle);
  void move_edges(Scc from, Scc to);
  void split(Scc scc, std::vector<Edge> gone);
  std::vector<Scc> sccs_of(const std::vector<std::vector<Vertex>>& parts);
  void condense_anew();
  Scc new_scc();
  void put(Vertex vertex, Scc scc);

  Adjacency vertices_;
  Adjacency sccs_;  // the edges between different SCCs
  SccOrder order_;
  CircleSplit splitter_;
  std::vector<Scc> scc_of_;
  std::vector<std::vector<Vertex>> members_;  // by SCC
  std::vector<std::size_t> place_in_scc_;     // by vertex
  std::vector<Scc> free_;                     // numbers that no SCC has
  std::size_t edges_ = 0;
};

}  // namespace culprit
