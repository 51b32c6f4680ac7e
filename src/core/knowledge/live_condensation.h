// The condensation of a graph whose edges come and go: circles are drawn together and fall apart
// one at a time, instead of all being found anew (knowledge/condensation.h says what a knot is).
//
//   - An edge that comes changes the order of the knots between its ends, and merges those that it
//     closes a circle of (knowledge/knot_order.h).
//   - An edge that goes between two knots changes nothing but that. One that goes inside a knot has
//     this one knot examined (knowledge/circle_split.h).
//
// Which order the knots are in depends on the order of changes; who depends on whom does not. When
// much of the graph changes at once, it is condensed anew.
#pragma once

#include <map>

#include "knowledge/circle_split.h"
#include "knowledge/knot_order.h"

namespace culprit {

class LiveCondensation {
 public:
  using Vertex = Adjacency::Index;
  using Knot = KnotOrder::Knot;
  using Edge = CircleSplit::Edge;
  static constexpr Knot kNone = KnotOrder::kNone;

  // A vertex without edges. They are numbered from 0.
  Vertex add_vertex();
  // An edge may be there several times. @pre those that are removed are there
  void update(std::span<const Edge> removed, std::span<const Edge> added);

  // Knots are numbers below this; not each of them is one.
  std::size_t size() const { return members_.size(); }
  Knot knot_of(Vertex vertex) const { return knot_of_[vertex]; }
  // What a knot depends on directly, possibly more than once.
  std::span<const Knot> producers(Knot knot) const { return knots_.producers(knot); }

  // The places of the order in which each knot comes after all that it depends on.
  std::size_t places() const { return order_.places(); }
  // kNone: nothing is there.
  Knot at(std::size_t place) const { return order_.at(place); }
  std::size_t place_of(Knot knot) const { return order_.place_of(knot); }

 private:
  void add(const Edge& edge);
  void merge(std::span<const Knot> circle);
  void move_edges(Knot from, Knot to);
  void split(Knot knot, std::vector<Edge> gone);
  std::vector<Knot> knots_of(const std::vector<std::vector<Vertex>>& parts);
  void condense_anew();
  Knot new_knot();
  void put(Vertex vertex, Knot knot);

  Adjacency vertices_;
  Adjacency knots_;  // the edges between different knots
  KnotOrder order_;
  CircleSplit splitter_;
  std::vector<Knot> knot_of_;
  std::vector<std::vector<Vertex>> members_;  // by knot
  std::vector<std::size_t> place_in_knot_;    // by vertex
  std::vector<Knot> free_;                    // numbers that no knot has
  std::size_t edges_ = 0;
};

}  // namespace culprit
