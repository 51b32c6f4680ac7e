#include "knowledge/live_condensation.h"

#include <algorithm>

#include "knowledge/condensation.h"

namespace culprit {
namespace {

// A change costs some so many times as much as an edge does in a condensation of the whole graph.
constexpr std::size_t kChangeIsAsDearAs = 8;

}  // namespace

LiveCondensation::Vertex LiveCondensation::add_vertex() {
  const auto vertex = static_cast<Vertex>(knot_of_.size());
  vertices_.resize(vertex + std::size_t{1});
  place_in_knot_.push_back(0);
  knot_of_.push_back(kNone);
  const Knot knot = new_knot();
  put(vertex, knot);
  order_.append(knot);
  return vertex;
}

LiveCondensation::Knot LiveCondensation::new_knot() {
  if (free_.empty()) {
    members_.emplace_back();
    knots_.resize(members_.size());
    return static_cast<Knot>(members_.size() - 1);
  }
  const Knot knot = free_.back();
  free_.pop_back();
  return knot;
}

void LiveCondensation::put(Vertex vertex, Knot knot) {
  if (knot_of_[vertex] != kNone) {
    auto& old = members_[knot_of_[vertex]];
    const std::size_t place = place_in_knot_[vertex];
    old[place] = old.back();
    place_in_knot_[old[place]] = place;
    old.pop_back();
  }
  knot_of_[vertex] = knot;
  place_in_knot_[vertex] = members_[knot].size();
  members_[knot].push_back(vertex);
}

void LiveCondensation::update(std::span<const Edge> removed, std::span<const Edge> added) {
  edges_ += added.size() - removed.size();
  std::map<Knot, std::vector<Edge>> gone;  // from inside of knots
  const bool is_much = kChangeIsAsDearAs * (removed.size() + added.size()) > edges_;
  for (const Edge& edge : removed) {
    vertices_.remove(edge.first, edge.second);
    if (is_much) continue;
    const Knot consumer = knot_of_[edge.first];
    const Knot producer = knot_of_[edge.second];
    if (consumer == producer) {
      gone[consumer].push_back(edge);
    } else {
      knots_.remove(consumer, producer);
    }
  }
  if (is_much) {
    for (const Edge& edge : added) vertices_.add(edge.first, edge.second);
    return condense_anew();
  }
  for (auto& [knot, edges] : gone) split(knot, std::move(edges));
  for (const Edge& edge : added) add(edge);
  if (order_.places() > 2 * knot_of_.size()) order_.close_gaps();
}

void LiveCondensation::add(const Edge& edge) {
  vertices_.add(edge.first, edge.second);
  const Knot consumer = knot_of_[edge.first];
  const Knot producer = knot_of_[edge.second];
  if (consumer == producer) return;
  const std::vector<Knot> circle = order_.add_edge(consumer, producer, knots_);
  knots_.add(consumer, producer);
  if (!circle.empty()) merge(circle);
}

// All become part of the one that has the most members.
void LiveCondensation::merge(std::span<const Knot> circle) {
  const Knot left = *std::max_element(circle.begin(), circle.end(), [&](Knot a, Knot b) {
    return members_[a].size() < members_[b].size();
  });
  order_.replace(circle.front(), left);
  for (const Knot knot : circle) {
    if (knot == left) continue;
    move_edges(knot, left);
    while (!members_[knot].empty()) put(members_[knot].back(), left);
    free_.push_back(knot);
  }
}

void LiveCondensation::move_edges(Knot from, Knot to) {
  const std::vector<Knot> producers(knots_.producers(from).begin(), knots_.producers(from).end());
  const std::vector<Knot> consumers(knots_.consumers(from).begin(), knots_.consumers(from).end());
  for (const Knot producer : producers) {
    knots_.remove(from, producer);
    if (producer != to) knots_.add(to, producer);
  }
  for (const Knot consumer : consumers) {
    knots_.remove(consumer, from);
    if (consumer != to) knots_.add(consumer, to);
  }
}

void LiveCondensation::split(Knot knot, std::vector<Edge> gone) {
  const CircleSplit::Parts parts =
      splitter_.split(vertices_, knot_of_, knot, members_[knot], std::move(gone));
  std::vector<Vertex> leaving;
  for (const auto* side : {&parts.before, &parts.after}) {
    for (const auto& part : *side) leaving.insert(leaving.end(), part.begin(), part.end());
  }
  std::sort(leaving.begin(), leaving.end());
  const auto for_each_edge = [&](auto visit) {
    for (const Vertex vertex : leaving) {
      for (const Vertex producer : vertices_.producers(vertex)) visit(vertex, producer);
      for (const Vertex consumer : vertices_.consumers(vertex)) {
        // Of those between two that leave, one end is enough.
        if (!std::binary_search(leaving.begin(), leaving.end(), consumer)) visit(consumer, vertex);
      }
    }
  };
  for_each_edge([&](Vertex consumer, Vertex producer) {
    if (knot_of_[consumer] != knot_of_[producer])
      knots_.remove(knot_of_[consumer], knot_of_[producer]);
  });
  const std::vector<Knot> before = knots_of(parts.before);
  const std::vector<Knot> after = knots_of(parts.after);
  for_each_edge([&](Vertex consumer, Vertex producer) {
    if (knot_of_[consumer] != knot_of_[producer])
      knots_.add(knot_of_[consumer], knot_of_[producer]);
  });
  order_.insert_after(knot, after);
  if (before.empty()) return;
  // The first takes the place of what is left, which comes after all of them.
  std::vector<Knot> behind(before.begin() + 1, before.end());
  behind.push_back(knot);
  order_.replace(knot, before.front());
  order_.insert_after(before.front(), behind);
}

std::vector<LiveCondensation::Knot> LiveCondensation::knots_of(
    const std::vector<std::vector<Vertex>>& parts) {
  std::vector<Knot> knots;
  for (const auto& part : parts) {
    knots.push_back(new_knot());
    for (const Vertex vertex : part) put(vertex, knots.back());
  }
  return knots;
}

void LiveCondensation::condense_anew() {
  std::vector<Edge> edges;
  edges.reserve(edges_);
  for (Vertex vertex = 0; vertex < knot_of_.size(); ++vertex) {
    for (const Vertex producer : vertices_.producers(vertex)) edges.emplace_back(vertex, producer);
  }
  const Condensation condensed(knot_of_.size(), edges);
  members_.assign(condensed.size(), {});
  knots_ = {};
  knots_.resize(condensed.size());
  order_.clear();
  free_.clear();
  for (Knot knot = 0; knot < condensed.size(); ++knot) {
    order_.append(knot);
    for (const Knot producer : condensed.producers(knot)) knots_.add(knot, producer);
  }
  std::fill(knot_of_.begin(), knot_of_.end(), kNone);
  for (Vertex vertex = 0; vertex < knot_of_.size(); ++vertex)
    put(vertex, condensed.knot_of(vertex));
}

}  // namespace culprit
