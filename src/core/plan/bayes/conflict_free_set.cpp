#include "plan/bayes/conflict_free_set.h"

#include <algorithm>
#include <numeric>

#include "base/invariant.h"

namespace culprit::plan {

using namespace diagnose;
namespace {

// The items in the order of their worth, highest first, equal ones as they came.
std::vector<std::size_t> by_worth(std::span<const Item> items) {
  std::vector<std::size_t> order(items.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return items[a].worth > items[b].worth; });
  return order;
}

class BranchAndBound {
 public:
  explicit BranchAndBound(std::span<const Item> items) : items_(items) {
    for (const std::size_t c : by_worth(items)) {
      const auto same = std::find_if(groups_.begin(), groups_.end(), [&](const auto& group) {
        return items[group.front()].failure == items[c].failure;
      });
      if (same == groups_.end()) {
        groups_.emplace_back(1, c);
      } else {
        same->push_back(c);
      }
    }
    bounds_.assign(groups_.size() + 1, 0);
    for (std::size_t g = groups_.size(); g-- > 0;)
      bounds_[g] = bounds_[g + 1] + items[groups_[g].front()].worth;
  }

  std::vector<std::size_t> run() {
    branch(0, 0);
    std::sort(best_.begin(), best_.end());
    return best_;
  }

 private:
  // Decides about the failures from `group` on, given those before it.
  void branch(std::size_t group, std::int64_t worth) {
    if (worth > best_worth_) {
      best_worth_ = worth;
      best_ = taken_;
    }
    if (group == groups_.size() || worth + bounds_[group] <= best_worth_) return;
    for (const std::size_t c : groups_[group]) {
      const bool is_free = std::none_of(taken_.begin(), taken_.end(), [&](std::size_t t) {
        return conflict(items_[c], items_[t]);
      });
      if (!is_free) continue;
      taken_.push_back(c);
      branch(group + 1, worth + items_[c].worth);
      taken_.pop_back();
    }
    branch(group + 1, worth);
  }

  std::span<const Item> items_;
  std::vector<std::vector<std::size_t>> groups_;  // by failure, the most worth first
  std::vector<std::int64_t> bounds_;              // what the groups from here on can add at most
  std::vector<std::size_t> taken_;
  std::vector<std::size_t> best_;
  std::int64_t best_worth_ = 0;
};

class Greedy {
 public:
  explicit Greedy(std::span<const Item> items) : items_(items), is_chosen_(items.size(), false) {
    std::size_t failures = 0;
    for (const Item& item : items) failures = std::max(failures, item.failure + 1);
    of_failure_.assign(failures, kNone);
    taken_.assign(items.front().takes.size(), 0);
    at_place_.assign(taken_.size() * kWordBits, kNone);
  }

  std::vector<std::size_t> run() {
    const auto order = by_worth(items_);
    fill(order);
    constexpr int kPasses = 3;
    for (int pass = 0; pass < kPasses && improve(order); ++pass) fill(order);
    std::vector<std::size_t> chosen;
    for (std::size_t c = 0; c < items_.size(); ++c) {
      if (is_chosen_[c]) chosen.push_back(c);
    }
    return chosen;
  }

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  static constexpr std::size_t kSeveral = static_cast<std::size_t>(-2);

  void fill(const std::vector<std::size_t>& order) {
    for (const std::size_t c : order) {
      if (!is_chosen_[c] && rival(c) == kNone) choose(c);
    }
  }

  // The chosen one that conflicts with `c`; kNone, or kSeveral.
  std::size_t rival(std::size_t c) const {
    std::size_t only = of_failure_[items_[c].failure];
    const bool is_another = any_common(items_[c].near, taken_, [&](std::size_t place) {
      if (only == kNone) only = at_place_[place];
      return at_place_[place] != only;
    });
    return is_another ? kSeveral : only;
  }

  // Lets chosen ones go for those that only they shut out, where these are worth more together.
  bool improve(const std::vector<std::size_t>& order) {
    std::vector<std::vector<std::size_t>> shut_out(items_.size());
    for (const std::size_t c : order) {
      const std::size_t by = is_chosen_[c] ? kNone : rival(c);
      if (by != kNone && by != kSeveral) shut_out[by].push_back(c);
    }
    bool is_better = false;
    for (const std::size_t c : order) {
      if (is_chosen_[c]) is_better |= swap(c, shut_out[c]);
    }
    return is_better;
  }

  bool swap(std::size_t leaving, const std::vector<std::size_t>& shut_out) {
    std::vector<std::size_t> coming;
    std::int64_t worth = 0;
    for (const std::size_t c : shut_out) {
      const bool is_free = rival(c) == leaving &&  // also after other swaps
                           std::none_of(coming.begin(), coming.end(), [&](std::size_t other) {
                             return conflict(items_[c], items_[other]);
                           });
      if (!is_free) continue;
      coming.push_back(c);
      worth += items_[c].worth;
    }
    if (worth <= items_[leaving].worth) return false;
    put(leaving, kNone);
    for (const std::size_t c : coming) choose(c);
    return true;
  }

  void choose(std::size_t c) {
    CULPRIT_ASSERT(of_failure_[items_[c].failure] == kNone);  // two strategies for one failure
    put(c, c);
  }
  void put(std::size_t c, std::size_t holder) {
    is_chosen_[c] = holder != kNone;
    of_failure_[items_[c].failure] = holder;
    for_each(items_[c].takes, [&](std::size_t place) {
      at_place_[place] = holder;
      holder != kNone ? set(taken_, place) : clear(taken_, place);
    });
  }

  std::span<const Item> items_;
  std::vector<bool> is_chosen_;
  std::vector<std::size_t> of_failure_;  // the chosen one
  std::vector<Word> taken_;              // places
  std::vector<std::size_t> at_place_;    // the chosen one that takes it
};

}  // namespace

bool conflict(const Item& a, const Item& b) {
  return a.failure == b.failure || meet(a.takes, b.near);
}

std::vector<std::size_t> best_conflict_free_set(std::span<const Item> items) {
  return items.size() <= kExact ? exact_set(items) : greedy_set(items);
}

std::vector<std::size_t> exact_set(std::span<const Item> items) {
  return BranchAndBound(items).run();
}

std::vector<std::size_t> greedy_set(std::span<const Item> items) {
  return items.empty() ? std::vector<std::size_t>() : Greedy(items).run();
}

}  // namespace culprit::plan
