// The live condensation of nodes that are joined by channels, worked in when it is asked for: what
// changed several times in between, or changed back, costs once or nothing.
//
// Whose ends a channel may have changed is only noted. When asked, its edges are made again and
// compared with those that the condensation has.
#pragma once

#include <optional>

#include "knowledge/live_condensation.h"

namespace culprit {

class ChannelCondensation {
 public:
  using Vertex = LiveCondensation::Vertex;

  // Nodes and channels are numbered from 0; a channel is there once it is noted.
  void add_node() { nodes_.push_back(condensation_.add_vertex()); }
  void add_dependency(std::size_t consumer, std::size_t producer);
  // Its ends may have changed.
  void note(std::size_t channel);

  // `ends(channel, producers, consumers)` fills in the nodes that are the ends of a channel now.
  template <class GetEnds>
  const LiveCondensation& up_to_date(GetEnds ends);
  // @pre it is up to date
  LiveCondensation::Scc scc_of(std::size_t node) const {
    return condensation_.scc_of(nodes_[node]);
  }

 private:
  using Edges = std::vector<LiveCondensation::Edge>;
  struct Channel {
    bool is_noted = false;
    // What stands for it, once there were several producers: p + c edges then, not p * c.
    std::optional<Vertex> vertex;
    Edges edges;  // that the condensation has of it; sorted
  };

  void change(std::size_t channel, std::vector<Vertex>& producers, std::vector<Vertex>& consumers);
  void work_in();

  LiveCondensation condensation_;
  std::vector<Vertex> nodes_;
  std::vector<Channel> channels_;
  std::vector<std::size_t> noted_;
  Edges removed_;  // not worked in yet
  Edges added_;
};

template <class GetEnds>
const LiveCondensation& ChannelCondensation::up_to_date(GetEnds ends) {
  std::vector<Vertex> producers;
  std::vector<Vertex> consumers;
  for (const std::size_t channel : noted_) {
    producers.clear();
    consumers.clear();
    ends(channel, producers, consumers);
    change(channel, producers, consumers);
  }
  noted_.clear();
  work_in();
  return condensation_;
}

}  // namespace culprit
