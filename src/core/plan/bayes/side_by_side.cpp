#include "plan/bayes/side_by_side.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "plan/ties.h"

namespace culprit::plan {
namespace {

// So many combinations are tried.
constexpr std::size_t kFew = 256;
// With more sides only two are compared: a change at one hardly matters.
constexpr std::size_t kMany = 64;

// The try of a round: the first comes before all others, which keep their order.
const Try& try_of(const Side& side, std::size_t begin, std::size_t round) {
  if (round == 0) return side.tries[begin];
  return side.tries[round <= begin ? round - 1 : round];
}

std::vector<std::size_t> usual(std::span<const Side> sides) {
  std::vector<std::size_t> begins;
  for (const Side& side : sides) begins.push_back(side.firsts.front());
  return begins;
}

// The first strategy of the side if time cost nothing, because others take longer anyway.
std::size_t timeless(Side side) {
  for (Try& tried : side.tries) {
    tried.cost -= tried.time;
    tried.time = 0;
  }
  const auto cost = [&](std::size_t first) {
    return parts(joint_cost(std::span(&side, 1), std::span(&first, 1)));
  };
  return *std::min_element(side.firsts.begin(), side.firsts.end(),
                           [&](std::size_t a, std::size_t b) { return cost(a) < cost(b); });
}

class Search {
 public:
  explicit Search(std::span<const Side> sides)
      : sides_(sides), best_(usual(sides)), cost_(parts(joint_cost(sides, best_))) {}

  std::vector<std::size_t> run() {
    std::size_t combinations = 1;
    for (const Side& side : sides_)
      combinations = std::min(combinations * side.firsts.size(), kFew + 1);
    if (combinations <= kFew) {
      std::vector<std::size_t> begins = best_;
      try_all(0, begins);
    } else {
      descend();
    }
    return best_;
  }

 private:
  bool consider(const std::vector<std::size_t>& begins) {
    const std::int64_t cost = parts(joint_cost(sides_, begins));
    if (cost >= cost_) return false;
    best_ = begins;
    cost_ = cost;
    return true;
  }

  void try_all(std::size_t side, std::vector<std::size_t>& begins) {
    if (side == sides_.size()) {
      consider(begins);
      return;
    }
    for (const std::size_t first : sides_[side].firsts) {
      begins[side] = first;
      try_all(side + 1, begins);
    }
  }

  // From the usual ones, and from what each would begin with if time cost nothing.
  void descend() {
    std::vector<std::size_t> begins;
    for (const Side& side : sides_) begins.push_back(timeless(side));
    consider(begins);
    constexpr int kPasses = 3;
    bool is_better = sides_.size() <= kMany;
    for (int pass = 0; pass < kPasses && is_better; ++pass) {
      is_better = false;
      for (std::size_t side = 0; side < sides_.size(); ++side) {
        for (const std::size_t first : sides_[side].firsts) {
          std::vector<std::size_t> changed = best_;
          changed[side] = first;
          is_better |= consider(changed);
        }
      }
    }
  }

  std::span<const Side> sides_;
  std::vector<std::size_t> best_;
  std::int64_t cost_;
};

}  // namespace

double joint_cost(std::span<const Side> sides, std::span<const std::size_t> begins) {
  std::size_t rounds = 0;
  for (const Side& side : sides) rounds = std::max(rounds, side.tries.size());
  std::vector<StillThere> still_there(sides.size());
  std::vector<std::pair<double, double>> times;  // t, p
  double sum = 0;
  for (std::size_t round = 0; round < rounds; ++round) {
    times.clear();
    for (std::size_t i = 0; i < sides.size(); ++i) {
      if (round >= sides[i].tries.size()) continue;
      const Try& tried = try_of(sides[i], begins[i], round);
      const double chance = still_there[i].chance();
      sum += chance * (tried.cost - tried.time);
      times.emplace_back(tried.time, chance);
      still_there[i].fails(tried);
    }
    std::sort(times.begin(), times.end(), std::greater<>());
    double none_longer = 1;
    for (const auto& [time, p] : times) {
      sum += time * p * none_longer;
      none_longer *= 1 - p;
    }
  }
  return sum;
}

std::vector<std::size_t> side_by_side(std::span<const Side> sides) {
  if (sides.size() < 2) return usual(sides);
  return Search(sides).run();
}

}  // namespace culprit::plan
