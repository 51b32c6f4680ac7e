#include "knowledge/knot_order.h"

#include <deque>

namespace culprit {

void KnotOrder::clear() {
  order_.clear();
  place_.clear();
}

void KnotOrder::append(Knot knot) {
  order_.push_back(kNone);
  put(order_.size() - 1, knot);
}

void KnotOrder::put(std::size_t place, Knot knot) {
  if (knot >= place_.size()) place_.resize(knot + std::size_t{1});
  order_[place] = knot;
  place_[knot] = place;
}

void KnotOrder::replace(Knot old, Knot knot) { put(place_[old], knot); }

void KnotOrder::close_gaps() {
  std::erase(order_, kNone);
  for (std::size_t place = 0; place < order_.size(); ++place) put(place, order_[place]);
}

// Whoever is in the way moves on, until there are as many empty places as are needed.
void KnotOrder::insert_after(Knot before, std::span<const Knot> knots) {
  std::deque<Knot> waiting(knots.begin(), knots.end());
  for (std::size_t place = place_[before] + 1; !waiting.empty(); ++place) {
    if (place == order_.size()) order_.push_back(kNone);
    if (order_[place] != kNone) waiting.push_back(order_[place]);
    put(place, waiting.front());
    waiting.pop_front();
  }
}

std::vector<KnotOrder::Knot> KnotOrder::found(Knot from, Knot bound, Towards towards,
                                              const Adjacency& edges) {
  const bool is_up = towards == Towards::kProducers;
  const std::size_t end = place_[bound];
  auto& marked = marks(towards);
  marked.resize(std::max(marked.size(), place_.size()), 0);
  std::vector<Knot> all(1, from);
  marked[from] = search_;
  for (std::size_t next = 0; next < all.size(); ++next) {
    for (const Knot knot : is_up ? edges.producers(all[next]) : edges.consumers(all[next])) {
      const bool is_beyond = is_up ? place_[knot] < end : place_[knot] > end;
      if (is_beyond || marked[knot] == search_) continue;
      marked[knot] = search_;
      all.push_back(knot);
    }
  }
  std::sort(all.begin(), all.end(), [&](Knot a, Knot b) { return place_[a] < place_[b]; });
  return all;
}

std::vector<KnotOrder::Knot> KnotOrder::add_edge(Knot consumer, Knot producer,
                                                 const Adjacency& edges) {
  if (place_[producer] < place_[consumer]) return {};
  ++search_;
  const auto above = found(producer, consumer, Towards::kProducers, edges);
  const auto below = found(consumer, producer, Towards::kConsumers, edges);

  std::vector<std::size_t> places;
  std::vector<Knot> first;   // what the producer depends on
  std::vector<Knot> circle;  // both
  for (const Knot knot : above) {
    places.push_back(place_[knot]);
    (is_marked(knot, Towards::kConsumers) ? circle : first).push_back(knot);
  }
  std::vector<Knot> last;  // what depends on the consumer
  for (const Knot knot : below) {
    if (is_marked(knot, Towards::kProducers)) continue;
    places.push_back(place_[knot]);
    last.push_back(knot);
  }
  std::sort(places.begin(), places.end());
  for (const std::size_t place : places) order_[place] = kNone;
  for (std::size_t i = 0; i < first.size(); ++i) put(places[i], first[i]);
  if (!circle.empty()) put(places[first.size()], circle.front());
  const std::size_t behind = places.size() - last.size();
  for (std::size_t i = 0; i < last.size(); ++i) put(places[behind + i], last[i]);
  return circle;
}

}  // namespace culprit
