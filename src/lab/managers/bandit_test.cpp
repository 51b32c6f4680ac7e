#include "managers/bandit.h"

#include <gtest/gtest.h>

namespace culprit::study {
namespace {

std::vector<BanditArm> arms(std::vector<std::pair<int, int>> plays_and_successes) {
  std::vector<BanditArm> arms;
  for (const auto& [plays, successes] : plays_and_successes) {
    BanditArm& arm = arms.emplace_back();
    for (int i = 0; i < plays; ++i) arm.add(i < successes ? 1 : 0);
  }
  return arms;
}

TEST(Bandits, OfUcbPlayEachArmOnceAndThenTheHighestBound) {
  simulation::Random random(1);
  EXPECT_EQ(ranked(BanditPolicy::kUcb, arms({{0, 0}, {0, 0}, {0, 0}}), random).front(), 0u);
  EXPECT_EQ(ranked(BanditPolicy::kUcb, arms({{1, 1}, {0, 0}, {0, 0}}), random).front(), 1u);
  EXPECT_EQ(ranked(BanditPolicy::kUcb, arms({{100, 90}, {100, 10}}), random).front(), 0u);
  // With equal means, the arm that was played less.
  EXPECT_EQ(ranked(BanditPolicy::kUcb, arms({{100, 50}, {10, 5}}), random).front(), 1u);
}

// masced_bandits 1.0.1, UCB "TN": rewards 1, 0, 1, 1 for arm 0 and 0, 1 for arm 1 bound them at
// 1.463 and 1.693.
TEST(Bandits, OfUcbHaveThePublishedBound) {
  simulation::Random random(1);
  EXPECT_EQ(ranked(BanditPolicy::kUcb, arms({{4, 3}, {2, 1}}), random).front(), 1u);
  EXPECT_EQ(ranked(BanditPolicy::kUcb, arms({{4, 3}, {4, 2}}), random).front(), 0u);
}

// Half of the time the best mean, half of the time any of two: three quarters.
TEST(Bandits, OfTheGreedyKindExploreHalfOfTheTime) {
  simulation::Random random(7);
  const std::vector<BanditArm> two = arms({{10, 2}, {10, 8}});
  int best = 0;
  for (int i = 0; i < 4000; ++i)
    best += ranked(BanditPolicy::kGreedy, two, random).front() == 1 ? 1 : 0;
  EXPECT_NEAR(best / 4000.0, 0.75, 0.03);
}

TEST(Bandits, OfChanceArePlayedAlike) {
  simulation::Random random(7);
  std::vector<int> first(3);
  for (int i = 0; i < 3000; ++i)
    ++first[ranked(BanditPolicy::kRandom, arms({{9, 9}, {9, 0}, {0, 0}}), random).front()];
  for (const int count : first) EXPECT_NEAR(count, 1000, 100);
}

// Beta(a, b) has mean a / (a + b) and variance a b / ((a + b)^2 (a + b + 1)).
TEST(Bandits, DrawFromBetaDistributions) {
  simulation::Random random(3);
  for (const auto& [a, b] : {std::pair(4.0, 6.0), {0.5, 10.0}, {30.0, 2.0}}) {
    double sum = 0;
    double squares = 0;
    constexpr int kDraws = 20000;
    for (int i = 0; i < kDraws; ++i) {
      const double x = draw_beta(a, b, random);
      sum += x;
      squares += x * x;
    }
    const double mean = sum / kDraws;
    EXPECT_NEAR(mean, a / (a + b), 0.01) << a;
    EXPECT_NEAR(squares / kDraws - mean * mean, a * b / ((a + b) * (a + b) * (a + b + 1)), 0.003)
        << a;
  }
}

// The published check of Thompson sampling: it soon plays the better arm nearly always.
TEST(Bandits, OfThompsonSettleOnTheBetterArm) {
  simulation::Random random(5);
  std::vector<BanditArm> two(2);
  int better = 0;
  for (int round = 0; round < 1000; ++round) {
    const std::size_t arm = ranked(BanditPolicy::kThompson, two, random).front();
    two[arm].add(random.chance(arm == 0 ? 0.3 : 0.6) ? 1 : 0);
    if (round >= 500) better += arm == 1 ? 1 : 0;
  }
  EXPECT_GT(better, 450);
}

}  // namespace
}  // namespace culprit::study
