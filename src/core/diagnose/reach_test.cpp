#include "diagnose/reach.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "plan/bayes/test_scene.h"

namespace culprit::diagnose {
namespace {

using plan::failure_of;
using plan::Scene;

// More than a word's worth of them, with loops.
TEST(Reach, AgreesWithTheGraphAboutEachComponent) {
  constexpr std::size_t kComponents = 200;
  std::string text;
  for (std::size_t c = 0; c < kComponents; ++c)
    text += failure_of("c" + std::to_string(c), "R" + std::to_string(c));
  Scene scene(text);
  for (std::size_t c = 0; c < kComponents; ++c) {
    const std::string name = "c" + std::to_string(c);
    scene.link("c" + std::to_string(c * 7 / 8), name);
    if (c % 10 == 9) scene.link(name, "c" + std::to_string(c - 3));
  }
  std::vector<ComponentId> some;
  for (std::size_t c = 0; c < kComponents; c += 2) some.emplace_back(c);
  const Reach reach(*scene, some);
  for (std::size_t p = 0; p < reach.size(); ++p) {
    const std::vector<ComponentId> upstream = scene->graph.upstream(reach[p]);
    EXPECT_EQ(reach.dependents(p), scene->graph.downstream(reach[p]).size());
    for (std::size_t other = 0; other < reach.size(); ++other) {
      const bool is_upstream =
          std::find(upstream.begin(), upstream.end(), reach[other]) != upstream.end();
      if (other == p) continue;
      EXPECT_EQ(has(reach.upstream(p), other), is_upstream) << p << " " << other;
      EXPECT_EQ(has(reach.downstream(other), p), is_upstream) << p << " " << other;
    }
  }
}

}  // namespace
}  // namespace culprit::diagnose
