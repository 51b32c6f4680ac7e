#include "knowledge/scc_order.h"

#include <deque>

namespace culprit {

void SccOrder::clear() {
  order_.clear();
  place_.clear();
}

void SccOrder::append(Scc scc) {
  order_.push_back(kNone);
  put(order_.size() - 1, scc);
}

void SccOrder::put(std::size_t place, Scc scc) {
  if (scc >= place_.size()) place_.resize(scc + std::size_t{1});
  order_[place] = scc;
  place_[scc] = place;
}

void SccOrder::replace(Scc old, Scc scc) { put(place_[old], scc); }

void SccOrder::close_gaps() {
  std::erase(order_, kNone);
  for (std::size_t place = 0; place < order_.size(); ++place) put(place, order_[place]);
}

// Whoever is in the way moves on, until there are as many empty places as are needed.
void SccOrder::insert_after(Scc before, std::span<const Scc> sccs) {
  std::deque<Scc> waiting(sccs.begin(), sccs.end());
  for (std::size_t place = place_[before] + 1; !waiting.empty(); ++place) {
    if (place == order_.size()) order_.push_back(kNone);
    if (order_[place] != kNone) waiting.push_back(order_[place]);
    put(place, waiting.front());
    waiting.pop_front();
  }
}

std::vector<SccOrder::Scc> SccOrder::found(Scc from, Scc bound, Towards towards,
                                           const Adjacency& edges) {
  const bool is_up = towards == Towards::kProducers;
  const std::size_t end = place_[bound];
  auto& marked = marks(towards);
  marked.resize(std::max(marked.size(), place_.size()), 0);
  std::vector<Scc> all(1, from);
  marked[from] = search_;
  for (std::size_t next = 0; next < all.size(); ++next) {
    for (const Scc scc : is_up ? edges.producers(all[next]) : edges.consumers(all[next])) {
      const bool is_beyond = is_up ? place_[scc] < end : place_[scc] > end;
      if (is_beyond || marked[scc] == search_) continue;
      marked[scc] = search_;
      all.push_back(scc);
    }
  }
  std::sort(all.begin(), all.end(), [&](Scc a, Scc b) { return place_[a] < place_[b]; });
  return all;
}

std::vector<SccOrder::Scc> SccOrder::add_edge(Scc consumer, Scc producer, const Adjacency& edges) {
  if (place_[producer] < place_[consumer]) return {};
  ++search_;
  const auto above = found(producer, consumer, Towards::kProducers, edges);
  const auto below = found(consumer, producer, Towards::kConsumers, edges);

  std::vector<std::size_t> places;
  std::vector<Scc> first;   // what the producer depends on
  std::vector<Scc> circle;  // both
  for (const Scc scc : above) {
    places.push_back(place_[scc]);
    (is_marked(scc, Towards::kConsumers) ? circle : first).push_back(scc);
  }
  std::vector<Scc> last;  // what depends on the consumer
  for (const Scc scc : below) {
    if (is_marked(scc, Towards::kProducers)) continue;
    places.push_back(place_[scc]);
    last.push_back(scc);
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
