// Does a circle hold together without some of its edges? If not: into which it falls apart.
//
// Every member reached every other before, so all that has to be shown is that the consumer of each
// edge that is gone still reaches its producer. Two searches, one from either end, mostly meet
// after a few steps. Where one of them ends instead, it has found a part that broke off: what the
// consumer still depends on, or what still depends on the producer. Then whoever needed that part
// has to reach by other ways what it reached through it. Only when this gets longer than looking at
// the whole circle, Tarjan's algorithm does that.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "knowledge/adjacency.h"

namespace culprit {

class CircleSplit {
 public:
  using Vertex = Adjacency::Index;
  using Edge = std::pair<Vertex, Vertex>;  // consumer, producer

  // Circles, each of vertices that depend on each other; or of one. All of them together, and what
  // is left of the old one, are in an order in which each comes after all that it depends on.
  struct Parts {
    std::vector<std::vector<Vertex>> before;  // what is left
    std::vector<std::vector<Vertex>> after;
  };

  // `edges` are those that are left, also out of the circle, whose `members` are those of which
  // scc_of[member] is `scc`; `gone` led from members to members.
  Parts split(const Adjacency& edges, std::span<const std::uint32_t> scc_of, std::uint32_t scc,
              std::span<const Vertex> members, std::vector<Edge> gone);

 private:
  // One of the two searches.
  struct Search {
    std::vector<std::uint32_t> marks;  // by vertex, of which search
    std::vector<Vertex> found;
    std::size_t next = 0;  // of those found, the first whose neighbours were not looked at

    void begin(Vertex at, std::uint32_t mark);
    bool is_over() const { return next == found.size(); }
  };
  enum class End : std::uint8_t { kMet, kConsumerBrokeOff, kProducerBrokeOff };

  bool is_in(Vertex vertex) const { return scc_of_[vertex] == scc_ && out_[vertex] != run_; }
  End search(Vertex consumer, Vertex producer);
  bool step(Search& search, const Search& other, bool is_upward);
  void take_out(const std::vector<Vertex>& part, bool is_upward);
  std::vector<std::vector<Vertex>> circles_of(std::span<const Vertex> members);
  void look_at_all(std::span<const Vertex> members);

  const Adjacency* edges_ = nullptr;
  std::span<const std::uint32_t> scc_of_;
  std::uint32_t scc_ = 0;
  std::vector<Edge> needed_;  // the consumer has to reach the producer
  Parts parts_;
  std::size_t steps_ = 0;

  std::uint32_t run_ = 0;
  std::vector<std::uint32_t> out_;  // by vertex: the run in which it was taken out
  std::uint32_t mark_ = 0;
  Search up_;                   // from a consumer to what it depends on
  Search down_;                 // from a producer to what depends on it
  std::vector<Vertex> number_;  // of circles_of(): by vertex
};

}  // namespace culprit
