// Compares what a manager learns about one robot of the benchmark over many faults with the truth.
//
// The robot stays the same; each episode has new faults and new luck, and begins with the beliefs
// and couplings that the last one ended with. First it learns. Then, while it goes on learning,
// every outcome that moves a belief or a coupling is held against what was believed just before:
//   - of a strategy that was executed: did it help?
//   - of a failure that was there when another was resolved: did it go away too?
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "plan/bayes/objective.h"
#include "rca_study/calibration.h"
#include "rca_study/generator.h"
#include "rca_study/rca_scenario.h"

namespace culprit::study::rca {

// The initial guesses of the rules.
enum class Priors : std::uint8_t {
  kRight,  // what the author knows of other robots, near the truth
  kOff,    // 20 % off, up and down by turns
  kFlat    // half, and hardly believed
};

struct LearningCampaign {
  RcaSetting setting{10, 1, 0, false};
  Objective objective = Objective::kBalanced;
  bool uses_paper_planner = false;
  Priors priors = Priors::kRight;
  std::uint32_t faults = 500;  // to learn from before anything is measured
  double forgetting = 1;
  // For the last quarter of these, and from then on, a restart helps as little as a configuration
  // did, and the other way round.
  bool has_drift = false;
  std::uint64_t seed = 1;

  // On how many faults it is measured: on few after a drift, because in the long run all learn.
  std::uint32_t measured() const { return has_drift ? faults : 4 * faults; }
};

// The outcomes of one strategy in all episodes, beside the belief about it.
struct LearnedRate {
  std::string strategy;  // "c3.restart"
  double prior = 0;
  int executed = 0;
  int helped = 0;  // in truth
  double believed = 0;
  double counted = 0;  // outcomes that were learned from
  int judged = 0;      // executions that these are of
  int judged_helped = 0;

  // Only for the executions that were learned from: beside another repair no outcome can be judged
  // (docs/planning.md).
  double truth() const { return judged == 0 ? 0 : static_cast<double>(judged_helped) / judged; }
};

// kappa(cause -> effect): learned, and in truth (docs/planning.md). The truth is known from the plant:
// an effect has no other source if no other failure that is there, and has a fault of its own or is
// being repaired, passes on to it; and it goes away if it has no fault of its own.
struct LearnedCoupling {
  std::string cause;
  std::string effect;
  int asked = 0;       // a strategy resolved `cause`, and `effect` was there without another source
  int cleared = 0;     // of these: it goes away
  double counted = 0;  // what was learned from
  double counted_cleared = 0;  // of these: it went away

  double truth() const { return asked == 0 ? 0 : static_cast<double>(cleared) / asked; }
  double learned() const { return counted == 0 ? 0 : counted_cleared / counted; }
};

struct LearningResult {
  std::uint32_t learned = 0;   // faults
  std::uint32_t measured = 0;  // faults
  Calibration success;
  Calibration rates;  // the same by strategy: is each believed in as often as it helps?
  Calibration kappa;
  std::vector<LearnedRate> strategies;
  std::vector<LearnedCoupling> couplings;
};

// Depends on nothing but the campaign. `is_stopped` is asked after each episode (null: never);
// where it stopped nothing is given.
std::optional<LearningResult> learn(const LearningCampaign& campaign,
                                    const std::function<bool()>& is_stopped);

}  // namespace culprit::study::rca
