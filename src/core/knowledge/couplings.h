// How surely a failure clears when another one is resolved: kappa(j -> i), learned for each ordered
// pair of rules (docs/planning.md, which also defines its true value).
//
//     kappa(j -> i) = (n0 kappa0 + cleared) / (n0 + cleared + stayed + spared)
//
//   cleared  how often i cleared after a strategy had resolved j, without a repair of its own
//   stayed   how often it was still there when its signals could have shown the recovery
//   spared   for how many times kUsualDelay it was seen to be well while j was there (exposure); kMostSpared
//            at most: j may be of another kind the next time, so exposure alone must not outweigh an outcome.
//            With 50 of it, kappa is 0.037, and i has a cause of its own (diagnose/diagnosis.h: from
//            kappa < 0.053 on); one outcome in which i cleared with j makes it 0.055
//   kappa0   the expectation before any outcome: kUsual if i depends on j, kRare otherwise
//   n0       how many outcomes that expectation weighs: kWeight
//
// Only the counts are stored: whether i depends on j is asked of the graph at the time.
#pragma once

#include <span>
#include <vector>

#include "language/rule_set.h"

namespace culprit {

struct Coupling {
  static constexpr double kUsual = 0.95;
  static constexpr double kRare = 0.05;
  static constexpr double kWeight = 2;
  static constexpr double kMostSpared = 50;

  double cleared = 0;
  double stayed = 0;
  double spared = 0;

  double mean(double expected) const {
    return (kWeight * expected + cleared) / (kWeight + cleared + stayed + spared);
  }
  // The same by outcomes alone. A failure that came with j may clear with it, although it once stayed away.
  double clears(double expected) const {
    return (kWeight * expected + cleared) / (kWeight + cleared + stayed);
  }
  bool operator==(const Coupling&) const = default;
};

class Couplings {
 public:
  // With forgetting below 1, earlier outcomes weigh that much less with each new outcome.
  explicit Couplings(const RuleSet& rules);
  void set_forgetting(double forgetting) { forgetting_ = forgetting; }

  void cleared(RuleId cause, RuleId effect) { learn(cause, effect, {1, 0, 0}); }
  void stayed(RuleId cause, RuleId effect) { learn(cause, effect, {0, 1, 0}); }
  // The effect was seen to be well for `times` the usual delay, although the cause was there.
  void stayed_away(RuleId cause, RuleId effect, double times) {
    learn(cause, effect, {0, 0, times});
  }
  void set(RuleId cause, RuleId effect, Coupling coupling);

  struct Learned {
    RuleId cause;
    Coupling coupling;
  };
  // All causes that `effect` was seen to clear with, or not.
  std::span<const Learned> of(RuleId effect) const { return by_effect_[effect.index]; }
  // Nothing learned: all counts are zero.
  Coupling of(RuleId cause, RuleId effect) const;

 private:
  Coupling& place(RuleId cause, RuleId effect);
  void learn(RuleId cause, RuleId effect, Coupling outcome);

  std::vector<std::vector<Learned>> by_effect_;
  double forgetting_ = 1;
};

}  // namespace culprit
