#include "plan/bayes/conflict_free_set.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace culprit::plan {

using namespace diagnose;
namespace {

// Choices at places of their own; which places are near which.
struct Problem {
  Problem(std::vector<std::pair<std::size_t, std::int64_t>> failures_and_worths,
          const std::vector<std::pair<std::size_t, std::size_t>>& conflicts)
      : takes(failures_and_worths.size(), failures_and_worths.size()),
        near(failures_and_worths.size(), failures_and_worths.size()) {
    for (std::size_t c = 0; c < failures_and_worths.size(); ++c) {
      set(takes[c], c);
      set(near[c], c);
    }
    for (const auto& [a, b] : conflicts) {
      set(near[a], b);
      set(near[b], a);
    }
    for (std::size_t c = 0; c < failures_and_worths.size(); ++c)
      items.push_back(
          {failures_and_worths[c].first, failures_and_worths[c].second, takes[c], near[c]});
  }

  std::int64_t worth(const std::vector<std::size_t>& chosen) const {
    std::int64_t sum = 0;
    for (const std::size_t c : chosen) sum += items[c].worth;
    return sum;
  }
  bool is_free(const std::vector<std::size_t>& chosen) const {
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (conflict(items[chosen[i]], items[chosen[j]])) return false;
      }
    }
    return true;
  }
  // Every subset is tried.
  std::int64_t best_worth() const {
    std::int64_t best = 0;
    for (std::size_t subset = 0; subset < std::size_t{1} << items.size(); ++subset) {
      std::vector<std::size_t> chosen;
      for (std::size_t c = 0; c < items.size(); ++c) {
        if ((subset >> c & 1) != 0) chosen.push_back(c);
      }
      if (is_free(chosen)) best = std::max(best, worth(chosen));
    }
    return best;
  }

  BitRows takes;
  BitRows near;
  std::vector<Item> items;
};

using Set = std::vector<std::size_t>;

TEST(ConflictFreeSet, HoldsOneChoiceForEachFailure) {
  const Problem problem({{0, 1}, {0, 2}, {1, 3}}, {});
  EXPECT_EQ(exact_set(problem.items), (Set{1, 2}));
  EXPECT_EQ(greedy_set(problem.items), (Set{1, 2}));
}

TEST(ConflictFreeSet, TakesTwoThatAreWorthMoreThanTheOneTheyConflictWith) {
  const Problem problem({{0, 5}, {1, 3}, {2, 3}}, {{0, 1}, {0, 2}});
  EXPECT_EQ(exact_set(problem.items), (Set{1, 2}));
}

TEST(ConflictFreeSet, GreedyIsImprovedBySwaps) {
  // 0 comes first and shuts out 1 and 2, which together are worth more.
  const Problem problem({{0, 5}, {1, 4}, {2, 4}}, {{0, 1}, {0, 2}});
  EXPECT_EQ(greedy_set(problem.items), (Set{1, 2}));
}

TEST(ConflictFreeSet, OfEquallyGoodOnesIsTheEarlier) {
  const Problem problem({{0, 1}, {1, 1}}, {{0, 1}});
  EXPECT_EQ(exact_set(problem.items), Set{0});
  EXPECT_EQ(greedy_set(problem.items), Set{0});
}

TEST(ConflictFreeSet, OfNothingIsEmpty) { EXPECT_EQ(best_conflict_free_set({}), Set{}); }

Problem random_problem(std::size_t most) {
  const auto count = *rc::gen::inRange<std::size_t>(1, most + 1);
  std::vector<std::pair<std::size_t, std::int64_t>> all;
  for (std::size_t c = 0; c < count; ++c)
    all.emplace_back(*rc::gen::inRange<std::size_t>(0, count), *rc::gen::inRange(1, 1000) / 8.0);
  const auto item = rc::gen::inRange<std::size_t>(0, count);
  return Problem(std::move(all),
                 *rc::gen::container<std::vector<std::pair<std::size_t, std::size_t>>>(
                     rc::gen::pair(item, item)));
}

RC_GTEST_PROP(ConflictFreeSet, IsAsGoodAsTheBestOfAllSubsets, ()) {
  const Problem problem = random_problem(12);
  const Set chosen = exact_set(problem.items);
  RC_ASSERT(problem.is_free(chosen));
  RC_ASSERT(problem.worth(chosen) == problem.best_worth());
}

RC_GTEST_PROP(ConflictFreeSet, GreedyIsFreeAndLeavesOutNothingThatFits, ()) {
  const Problem problem = random_problem(40);
  Set chosen = greedy_set(problem.items);
  RC_ASSERT(problem.is_free(chosen));
  for (std::size_t c = 0; c < problem.items.size(); ++c) {
    if (std::find(chosen.begin(), chosen.end(), c) != chosen.end()) continue;
    chosen.push_back(c);
    RC_ASSERT(!problem.is_free(chosen));
    chosen.pop_back();
  }
}

}  // namespace
}  // namespace culprit::plan
