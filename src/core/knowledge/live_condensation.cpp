#include "knowledge/live_condensation.h"

#include <algorithm>

#include "knowledge/condensation.h"

namespace culprit {
namespace {

// A change costs some so many times as much as an edge does in a condensation of the whole graph.
constexpr std::size_t kChangeIsAsDearAs = 8;

}  // namespace

LiveCondensation::Vertex LiveCondensation::add_vertex() {
  const auto vertex = static_cast<Vertex>(scc_of_.size());
  vertices_.resize(vertex + std::size_t{1});
  place_in_scc_.push_back(0);
  scc_of_.push_back(kNone);
  const Scc scc = new_scc();
  put(vertex, scc);
  order_.append(scc);
  return vertex;
}

LiveCondensation::Scc LiveCondensation::new_scc() {
  if (free_.empty()) {
    members_.emplace_back();
    sccs_.resize(members_.size());
    return static_cast<Scc>(members_.size() - 1);
  }
  const Scc scc = free_.back();
  free_.pop_back();
  return scc;
}

void LiveCondensation::put(Vertex vertex, Scc scc) {
  if (scc_of_[vertex] != kNone) {
    auto& old = members_[scc_of_[vertex]];
    const std::size_t place = place_in_scc_[vertex];
    old[place] = old.back();
    place_in_scc_[old[place]] = place;
    old.pop_back();
  }
  scc_of_[vertex] = scc;
  place_in_scc_[vertex] = members_[scc].size();
  members_[scc].push_back(vertex);
}

void LiveCondensation::update(std::span<const Edge> removed, std::span<const Edge> added) {
  edges_ += added.size() - removed.size();
  std::map<Scc, std::vector<Edge>> gone;  // from inside of SCCs
  const bool is_much = kChangeIsAsDearAs * (removed.size() + added.size()) > edges_;
  for (const Edge& edge : removed) {
    vertices_.remove(edge.first, edge.second);
    if (is_much) continue;
    const Scc consumer = scc_of_[edge.first];
    const Scc producer = scc_of_[edge.second];
    if (consumer == producer) {
      gone[consumer].push_back(edge);
    } else {
      sccs_.remove(consumer, producer);
    }
  }
  if (is_much) {
    for (const Edge& edge : added) vertices_.add(edge.first, edge.second);
    return condense_anew();
  }
  for (auto& [scc, edges] : gone) split(scc, std::move(edges));
  for (const Edge& edge : added) add(edge);
  if (order_.places() > 2 * scc_of_.size()) order_.close_gaps();
}

void LiveCondensation::add(const Edge& edge) {
  vertices_.add(edge.first, edge.second);
  const Scc consumer = scc_of_[edge.first];
  const Scc producer = scc_of_[edge.second];
  if (consumer == producer) return;
  const std::vector<Scc> circle = order_.add_edge(consumer, producer, sccs_);
  sccs_.add(consumer, producer);
  if (!circle.empty()) merge(circle);
}

// All become part of the one that has the most members.
void LiveCondensation::merge(std::span<const Scc> circle) {
  const Scc left = *std::max_element(circle.begin(), circle.end(), [&](Scc a, Scc b) {
    return members_[a].size() < members_[b].size();
  });
  order_.replace(circle.front(), left);
  for (const Scc scc : circle) {
    if (scc == left) continue;
    move_edges(scc, left);
    while (!members_[scc].empty()) put(members_[scc].back(), left);
    free_.push_back(scc);
  }
}

void LiveCondensation::move_edges(Scc from, Scc to) {
  const std::vector<Scc> producers(sccs_.producers(from).begin(), sccs_.producers(from).end());
  const std::vector<Scc> consumers(sccs_.consumers(from).begin(), sccs_.consumers(from).end());
  for (const Scc producer : producers) {
    sccs_.remove(from, producer);
    if (producer != to) sccs_.add(to, producer);
  }
  for (const Scc consumer : consumers) {
    sccs_.remove(consumer, from);
    if (consumer != to) sccs_.add(consumer, to);
  }
}

void LiveCondensation::split(Scc scc, std::vector<Edge> gone) {
  const CircleSplit::Parts parts =
      splitter_.split(vertices_, scc_of_, scc, members_[scc], std::move(gone));
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
    if (scc_of_[consumer] != scc_of_[producer]) sccs_.remove(scc_of_[consumer], scc_of_[producer]);
  });
  const std::vector<Scc> before = sccs_of(parts.before);
  const std::vector<Scc> after = sccs_of(parts.after);
  for_each_edge([&](Vertex consumer, Vertex producer) {
    if (scc_of_[consumer] != scc_of_[producer]) sccs_.add(scc_of_[consumer], scc_of_[producer]);
  });
  order_.insert_after(scc, after);
  if (before.empty()) return;
  // The first takes the place of what is left, which comes after all of them.
  std::vector<Scc> behind(before.begin() + 1, before.end());
  behind.push_back(scc);
  order_.replace(scc, before.front());
  order_.insert_after(before.front(), behind);
}

std::vector<LiveCondensation::Scc> LiveCondensation::sccs_of(
    const std::vector<std::vector<Vertex>>& parts) {
  std::vector<Scc> sccs;
  for (const auto& part : parts) {
    sccs.push_back(new_scc());
    for (const Vertex vertex : part) put(vertex, sccs.back());
  }
  return sccs;
}

void LiveCondensation::condense_anew() {
  std::vector<Edge> edges;
  edges.reserve(edges_);
  for (Vertex vertex = 0; vertex < scc_of_.size(); ++vertex) {
    for (const Vertex producer : vertices_.producers(vertex)) edges.emplace_back(vertex, producer);
  }
  const Condensation condensed(scc_of_.size(), edges);
  members_.assign(condensed.size(), {});
  sccs_ = {};
  sccs_.resize(condensed.size());
  order_.clear();
  free_.clear();
  for (Scc scc = 0; scc < condensed.size(); ++scc) {
    order_.append(scc);
    for (const Scc producer : condensed.producers(scc)) sccs_.add(scc, producer);
  }
  std::fill(scc_of_.begin(), scc_of_.end(), kNone);
  for (Vertex vertex = 0; vertex < scc_of_.size(); ++vertex) put(vertex, condensed.scc_of(vertex));
}

}  // namespace culprit
