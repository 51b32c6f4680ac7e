#include "managers/bandit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace culprit::study {
namespace {

constexpr double kExploring = 0.5;  // epsilon of masced_bandits' egreedy

// Gamma(shape, 1), shape >= 1 (Marsaglia and Tsang: "A Simple Method for Generating Gamma
// Variables", 2000).
double draw_gamma(double shape, simulation::Random& random) {
  const double d = shape - 1.0 / 3;
  const double c = 1 / std::sqrt(9 * d);
  for (;;) {
    const double x = random.normal();
    const double root = 1 + c * x;
    if (root <= 0) continue;
    const double v = root * root * root;
    if (std::log(1 - random.uniform()) < 0.5 * x * x + d - d * v + d * std::log(v)) return d * v;
  }
}

double tuned_bound(const BanditArm& arm, double all_plays) {
  if (arm.plays == 0) return std::numeric_limits<double>::infinity();
  const double share = std::log(all_plays) / arm.plays;
  const double variance = arm.squared_rewards / arm.plays - arm.mean() * arm.mean();
  return arm.mean() + std::sqrt(share * (variance + std::sqrt(2 * share)));
}

void shuffle(std::vector<std::size_t>& order, simulation::Random& random) {
  for (std::size_t i = order.size(); i > 1; --i)
    std::swap(order[i - 1], order[static_cast<std::size_t>(random.below(static_cast<int>(i)))]);
}

}  // namespace

void BanditArm::add(double reward) {
  plays += 1;
  rewards += reward;
  squared_rewards += reward * reward;
}

double draw_beta(double alpha, double beta, simulation::Random& random) {
  // For shapes below 1, Gamma(a) = Gamma(a + 1) U^(1/a).
  const auto gamma = [&](double shape) {
    return shape >= 1 ? draw_gamma(shape, random)
                      : draw_gamma(shape + 1, random) * std::pow(1 - random.uniform(), 1 / shape);
  };
  const double a = gamma(alpha);
  return a / (a + gamma(beta));
}

std::vector<std::size_t> ranked(BanditPolicy policy, const std::vector<BanditArm>& arms,
                                simulation::Random& random) {
  std::vector<std::size_t> order(arms.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const double all_plays = std::accumulate(
      arms.begin(), arms.end(), 0.0, [](double sum, const auto& arm) { return sum + arm.plays; });
  const bool is_by_chance = policy == BanditPolicy::kRandom ||
                            (policy == BanditPolicy::kGreedy && random.chance(kExploring));
  if (is_by_chance) {
    shuffle(order, random);
    return order;
  }
  std::vector<double> worth;
  for (const BanditArm& arm : arms) {
    worth.push_back(policy == BanditPolicy::kUcb ? tuned_bound(arm, all_plays)
                    : policy == BanditPolicy::kGreedy
                        ? arm.mean()
                        : draw_beta(arm.prior_alpha + arm.rewards,
                                    arm.prior_beta + arm.plays - arm.rewards, random));
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return worth[a] > worth[b]; });
  return order;
}

}  // namespace culprit::study
