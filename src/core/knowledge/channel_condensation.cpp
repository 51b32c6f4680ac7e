#include "knowledge/channel_condensation.h"

#include <algorithm>
#include <iterator>

namespace culprit {

void ChannelCondensation::add_dependency(std::size_t consumer, std::size_t producer) {
  added_.emplace_back(nodes_[consumer], nodes_[producer]);
}

void ChannelCondensation::note(std::size_t channel) {
  if (channel >= channels_.size()) channels_.resize(channel + 1);
  if (std::exchange(channels_[channel].is_noted, true)) return;
  noted_.push_back(channel);
}

// The ends are numbers of nodes, and are turned into vertices here.
void ChannelCondensation::change(std::size_t channel, std::vector<Vertex>& producers,
                                 std::vector<Vertex>& consumers) {
  Channel& known = channels_[channel];
  known.is_noted = false;
  for (auto* ends : {&producers, &consumers}) {
    for (Vertex& end : *ends) end = nodes_[end];
  }
  Edges edges;
  if (!producers.empty() && !consumers.empty()) {
    if (producers.size() > 1 && !known.vertex) known.vertex = condensation_.add_vertex();
    const Vertex middle = known.vertex.value_or(producers.front());
    for (const Vertex consumer : consumers) edges.emplace_back(consumer, middle);
    for (const Vertex producer : producers) {
      if (producer != middle) edges.emplace_back(middle, producer);
    }
  }
  std::sort(edges.begin(), edges.end());
  std::set_difference(known.edges.begin(), known.edges.end(), edges.begin(), edges.end(),
                      std::back_inserter(removed_));
  std::set_difference(edges.begin(), edges.end(), known.edges.begin(), known.edges.end(),
                      std::back_inserter(added_));
  known.edges = std::move(edges);
}

void ChannelCondensation::work_in() {
  if (removed_.empty() && added_.empty()) return;
  condensation_.update(removed_, added_);
  removed_.clear();
  added_.clear();
}

}  // namespace culprit
