#include "knowledge/live_condensation.h"

#include <map>
#include <set>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "knowledge/condensation.h"

namespace culprit {
namespace {

using Vertex = LiveCondensation::Vertex;
using Scc = LiveCondensation::Scc;
using Edges = std::vector<LiveCondensation::Edge>;

LiveCondensation graph(std::size_t vertices, const Edges& edges) {
  LiveCondensation live;
  for (std::size_t v = 0; v < vertices; ++v) live.add_vertex();
  live.update({}, edges);
  return live;
}

// Enough edges beside what a test is about that a change is not much.
Edges with_a_chain(Edges edges, Vertex from, Vertex to) {
  for (Vertex v = from; v < to; ++v) edges.emplace_back(v, v + 1);
  return edges;
}

TEST(LiveCondensation, DrawsTogetherWhatAnEdgeClosesACircleOf) {
  LiveCondensation live = graph(100, with_a_chain({}, 0, 99));
  live.update({}, Edges{{30, 10}});
  EXPECT_EQ(live.scc_of(10), live.scc_of(30));
  EXPECT_EQ(live.scc_of(20), live.scc_of(30));
  EXPECT_NE(live.scc_of(9), live.scc_of(10));
  EXPECT_NE(live.scc_of(30), live.scc_of(31));
}

TEST(LiveCondensation, LetsACircleFallApartWhereItsEdgeGoes) {
  LiveCondensation live = graph(100, with_a_chain({{30, 10}}, 0, 99));
  live.update(Edges{{30, 10}}, {});
  std::set<Scc> sccs;
  for (Vertex v = 0; v < 100; ++v) sccs.insert(live.scc_of(v));
  EXPECT_EQ(sccs.size(), 100u);
}

TEST(LiveCondensation, LeavesACircleThatHoldsTogetherOtherwise) {
  LiveCondensation live = graph(100, with_a_chain({{30, 10}, {30, 10}, {25, 9}}, 0, 99));
  const Scc before = live.scc_of(20);
  live.update(Edges{{30, 10}}, {});
  EXPECT_EQ(live.scc_of(30), before) << "there were two of the edge";
  live.update(Edges{{30, 10}}, {});
  EXPECT_EQ(live.scc_of(25), before);
  EXPECT_NE(live.scc_of(30), before) << "it broke off";
}

TEST(LiveCondensation, TakesNoMorePlacesHoweverOftenCirclesComeAndGo) {
  LiveCondensation live = graph(200, with_a_chain({}, 0, 199));
  for (int i = 0; i < 1000; ++i) {
    const Vertex at = static_cast<Vertex>(i * 37 % 150);
    live.update({}, Edges{{at + 40, at}});
    live.update(Edges{{at + 40, at}}, {});
  }
  EXPECT_LE(live.places(), 400u);
}

// Everything that it says, beside what is found from nothing.
void check(const LiveCondensation& live, std::size_t vertices, const Edges& edges) {
  const Condensation anew(vertices, edges);
  std::map<Scc, Condensation::Scc> same;
  std::set<Scc> all;
  for (Vertex v = 0; v < vertices; ++v) {
    const auto known = same.emplace(live.scc_of(v), anew.scc_of(v));
    RC_ASSERT(known.first->second == anew.scc_of(v));
    all.insert(live.scc_of(v));
  }
  RC_ASSERT(all.size() == anew.size());

  std::multiset<std::pair<Scc, Scc>> between;
  for (const auto& [consumer, producer] : edges) {
    const std::pair sccs(live.scc_of(consumer), live.scc_of(producer));
    if (sccs.first != sccs.second) between.insert(sccs);
  }
  std::multiset<std::pair<Scc, Scc>> told;
  std::set<Scc> placed;
  for (std::size_t place = 0; place < live.places(); ++place) {
    const Scc scc = live.at(place);
    if (scc == LiveCondensation::kNone) continue;
    RC_ASSERT(live.place_of(scc) == place);
    RC_ASSERT(placed.insert(scc).second);
    for (const Scc producer : live.producers(scc)) {
      told.emplace(scc, producer);
      RC_ASSERT(live.place_of(producer) < place);
    }
  }
  RC_ASSERT(placed == all);
  RC_ASSERT(told == between);
}

RC_GTEST_PROP(LiveCondensation, AgreesWithOneFromNothingAfterEveryChange, ()) {
  const auto vertices = *rc::gen::inRange<std::size_t>(1, 60);
  const auto vertex = rc::gen::inRange<Vertex>(0, static_cast<Vertex>(vertices));
  const auto some = [&](std::size_t most) {
    const auto count = *rc::gen::inRange<std::size_t>(0, most);
    return *rc::gen::container<Edges>(count, rc::gen::pair(vertex, vertex));
  };
  Edges edges = some(2 * vertices + 2);
  LiveCondensation live = graph(vertices, edges);
  check(live, vertices, edges);
  const int changes = *rc::gen::inRange(0, 30);
  for (int c = 0; c < changes; ++c) {
    const Edges added = some(5);
    Edges removed;
    for (auto count = *rc::gen::inRange(0, 5); count > 0 && !edges.empty(); --count) {
      const auto at = *rc::gen::inRange<std::size_t>(0, edges.size());
      removed.push_back(edges[at]);
      edges.erase(edges.begin() + static_cast<std::ptrdiff_t>(at));
    }
    edges.insert(edges.end(), added.begin(), added.end());
    live.update(removed, added);
    check(live, vertices, edges);
  }
}

}  // namespace
}  // namespace culprit
