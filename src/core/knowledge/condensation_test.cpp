#include "knowledge/condensation.h"

#include <set>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace culprit {
namespace {

using Edges = std::vector<std::pair<Condensation::Vertex, Condensation::Vertex>>;

TEST(Condensation, PutsProducersFirst) {
  const Condensation chain(3, Edges{{0, 1}, {1, 2}});
  EXPECT_EQ(chain.size(), 3u);
  EXPECT_LT(chain.scc_of(2), chain.scc_of(1));
  EXPECT_LT(chain.scc_of(1), chain.scc_of(0));
}

TEST(Condensation, DrawsACircleTogether) {
  const Condensation circle(4, Edges{{0, 1}, {1, 2}, {2, 0}, {3, 0}});
  EXPECT_EQ(circle.size(), 2u);
  EXPECT_EQ(circle.scc_of(0), circle.scc_of(1));
  EXPECT_EQ(circle.scc_of(1), circle.scc_of(2));
  EXPECT_EQ(circle.producers(circle.scc_of(3)).size(), 1u);
}

TEST(Condensation, EndsOnALongChain) {
  Edges edges;
  for (Condensation::Vertex v = 0; v + 1 < 200'000; ++v) edges.emplace_back(v, v + 1);
  EXPECT_EQ(Condensation(200'000, edges).size(), 200'000u);
}

// The vertices that are reached from `from`, found the slow way; itself only through a loop.
std::set<Condensation::Vertex> reached(Condensation::Vertex from, const Edges& edges) {
  std::set<Condensation::Vertex> found;
  for (bool grows = true; grows;) {
    grows = false;
    for (const auto& [consumer, producer] : edges) {
      if (consumer == from || found.contains(consumer)) grows |= found.insert(producer).second;
    }
  }
  return found;
}

RC_GTEST_PROP(Condensation, AgreesWithASlowSearch, ()) {
  const auto vertices = *rc::gen::inRange<Condensation::Vertex>(1, 12);
  const auto vertex = rc::gen::inRange<Condensation::Vertex>(0, vertices);
  const auto edges = *rc::gen::container<Edges>(rc::gen::pair(vertex, vertex));
  const Condensation condensed(vertices, edges);
  for (Condensation::Vertex a = 0; a < vertices; ++a) {
    const auto from_a = reached(a, edges);
    for (const auto b : from_a) {
      const bool is_mutual = a == b || reached(b, edges).contains(a);
      RC_ASSERT((condensed.scc_of(a) == condensed.scc_of(b)) == is_mutual);
      RC_ASSERT(condensed.scc_of(b) <= condensed.scc_of(a));
    }
  }
  for (Condensation::Scc scc = 0; scc < condensed.size(); ++scc) {
    for (const auto producer : condensed.producers(scc)) RC_ASSERT(producer < scc);
  }
}

}  // namespace
}  // namespace culprit
