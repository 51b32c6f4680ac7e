// A topological order of SCCs that changes a little at a time: each SCC has a place, and comes
// after all that it depends on.
//
// A new edge that contradicts the order has only those SCCs change places that lie between its
// ends and depend on one or are depended on by the other; those that it closes a circle of are
// told, to be drawn together. Places that merging leaves empty are used again when a circle falls
// apart.
//
// Source: Pearce and Kelly, A Dynamic Topological Sort Algorithm for Directed Acyclic Graphs, 2007.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "knowledge/adjacency.h"

namespace culprit {

class SccOrder {
 public:
  using Scc = Adjacency::Index;
  static constexpr Scc kNone = std::numeric_limits<Scc>::max();

  // How many places there are, with the empty ones.
  std::size_t places() const { return order_.size(); }
  // kNone: an empty one.
  Scc at(std::size_t place) const { return order_[place]; }
  std::size_t place_of(Scc scc) const { return place_[scc]; }

  void clear();
  // As the last.
  void append(Scc scc);
  // Right behind `before`, in the order given.
  void insert_after(Scc before, std::span<const Scc> sccs);
  // Leaves no place empty.
  void close_gaps();
  // Where `old` is comes `scc`, which has no place.
  void replace(Scc old, Scc scc);

  // `edges` has, or will have, the new edge besides. Gives the SCCs that all depend on each other
  // with it, if there are any: they are to be merged. The first that is given has a place, the
  // others have none any more.
  std::vector<Scc> add_edge(Scc consumer, Scc producer, const Adjacency& edges);

 private:
  enum class Towards : std::uint8_t { kProducers, kConsumers };

  void put(std::size_t place, Scc scc);
  // Those reached from `from` whose places are not beyond that of `bound`; marked, by place.
  std::vector<Scc> found(Scc from, Scc bound, Towards towards, const Adjacency& edges);
  std::vector<std::uint32_t>& marks(Towards towards) {
    return marks_[static_cast<std::size_t>(towards)];
  }
  bool is_marked(Scc scc, Towards towards) { return marks(towards)[scc] == search_; }

  std::vector<Scc> order_;                           // by place
  std::vector<std::size_t> place_;                   // by SCC
  std::array<std::vector<std::uint32_t>, 2> marks_;  // by Towards
  std::uint32_t search_ = 0;
};

}  // namespace culprit
