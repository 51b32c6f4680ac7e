#include "knowledge/circle_split.h"

#include <algorithm>
#include <iterator>

#include "knowledge/condensation.h"

namespace culprit {

void CircleSplit::Search::begin(Vertex at, std::uint32_t mark) {
  found.assign(1, at);
  next = 0;
  marks[at] = mark;
}

CircleSplit::Parts CircleSplit::split(const Adjacency& edges, std::span<const std::uint32_t> scc_of,
                                      std::uint32_t scc, std::span<const Vertex> members,
                                      std::vector<Edge> gone) {
  edges_ = &edges;
  scc_of_ = scc_of;
  scc_ = scc;
  needed_ = std::move(gone);
  parts_ = {};
  steps_ = 0;
  ++run_;
  for (auto* by_vertex : {&out_, &up_.marks, &down_.marks, &number_})
    by_vertex->resize(edges.size(), 0);
  while (!needed_.empty()) {
    if (steps_ > members.size()) {
      look_at_all(members);
      break;
    }
    const auto [consumer, producer] = needed_.back();
    switch (search(consumer, producer)) {
      case End::kMet:
        needed_.pop_back();
        break;
      case End::kConsumerBrokeOff:
        take_out(up_.found, true);
        break;
      case End::kProducerBrokeOff:
        take_out(down_.found, false);
        break;
    }
  }
  std::reverse(parts_.after.begin(), parts_.after.end());
  return std::move(parts_);
}

CircleSplit::End CircleSplit::search(Vertex consumer, Vertex producer) {
  if (consumer == producer) return End::kMet;
  ++mark_;
  up_.begin(consumer, mark_);
  down_.begin(producer, mark_);
  for (;;) {
    if (up_.is_over()) return End::kConsumerBrokeOff;
    if (step(up_, down_, true)) return End::kMet;
    if (down_.is_over()) return End::kProducerBrokeOff;
    if (step(down_, up_, false)) return End::kMet;
  }
}

// Looks at the neighbours of one more vertex. Has the other search found one of them?
bool CircleSplit::step(Search& search, const Search& other, bool is_upward) {
  const Vertex at = search.found[search.next++];
  const auto neighbours = is_upward ? edges_->producers(at) : edges_->consumers(at);
  steps_ += 1 + neighbours.size();
  for (const Vertex vertex : neighbours) {
    if (search.marks[vertex] == mark_ || !is_in(vertex)) continue;
    if (other.marks[vertex] == mark_) return true;
    search.marks[vertex] = mark_;
    search.found.push_back(vertex);
  }
  return false;
}

// Who leads into the part has to reach by itself what the part led to. A part that was found
// upwards leads to nothing any more but where it is needed; one that was found downwards is led to
// by nothing else.
void CircleSplit::take_out(const std::vector<Vertex>& part, bool is_upward) {
  for (const Vertex vertex : part) out_[vertex] = run_;
  std::vector<Vertex> near;  // the ends of edges that cross its border
  for (const Vertex vertex : part) {
    for (const Vertex other : is_upward ? edges_->consumers(vertex) : edges_->producers(vertex)) {
      if (is_in(other)) near.push_back(other);
    }
  }
  std::vector<Vertex> far;  // what is needed across its border, the other way
  std::vector<Edge> kept;
  for (const auto& [consumer, producer] : needed_) {
    const Vertex from = is_upward ? consumer : producer;
    const Vertex to = is_upward ? producer : consumer;
    if (is_in(from) && is_in(to)) kept.emplace_back(consumer, producer);
    if (!is_in(from) && is_in(to)) far.push_back(to);
    if (is_in(from) && !is_in(to)) near.push_back(from);
  }
  needed_ = std::move(kept);
  for (auto* ends : {&near, &far}) {
    std::sort(ends->begin(), ends->end());
    ends->erase(std::unique(ends->begin(), ends->end()), ends->end());
  }
  for (const Vertex a : near) {
    for (const Vertex b : far) needed_.push_back(is_upward ? Edge(a, b) : Edge(b, a));
  }
  steps_ += near.size() * far.size();
  auto circles = circles_of(part);
  if (is_upward) {
    std::move(circles.begin(), circles.end(), std::back_inserter(parts_.before));
  } else {
    std::move(circles.rbegin(), circles.rend(), std::back_inserter(parts_.after));
  }
}

// In their order.
std::vector<std::vector<CircleSplit::Vertex>> CircleSplit::circles_of(
    std::span<const Vertex> members) {
  if (members.size() == 1) return {{members.front()}};
  ++mark_;
  for (std::size_t m = 0; m < members.size(); ++m) {
    number_[members[m]] = static_cast<Vertex>(m);
    up_.marks[members[m]] = mark_;
  }
  std::vector<Edge> inside;
  for (std::size_t m = 0; m < members.size(); ++m) {
    for (const Vertex producer : edges_->producers(members[m])) {
      if (up_.marks[producer] == mark_)
        inside.emplace_back(static_cast<Vertex>(m), number_[producer]);
    }
  }
  const Condensation condensed(members.size(), inside);
  std::vector<std::vector<Vertex>> circles(condensed.size());
  for (std::size_t m = 0; m < members.size(); ++m)
    circles[condensed.scc_of(static_cast<Vertex>(m))].push_back(members[m]);
  return circles;
}

// The largest part is what is left.
void CircleSplit::look_at_all(std::span<const Vertex> members) {
  std::vector<Vertex> left;
  std::copy_if(members.begin(), members.end(), std::back_inserter(left),
               [&](Vertex vertex) { return is_in(vertex); });
  auto circles = circles_of(left);
  const auto largest =
      std::max_element(circles.begin(), circles.end(),
                       [](const auto& a, const auto& b) { return a.size() < b.size(); });
  std::move(circles.begin(), largest, std::back_inserter(parts_.before));
  const std::reverse_iterator behind(largest + 1);
  std::move(circles.rbegin(), behind, std::back_inserter(parts_.after));
}

}  // namespace culprit
