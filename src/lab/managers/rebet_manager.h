// ReBeT on SUAVE, as in its repository's trees suave_offline.xml and suave_online.xml and the
// decorators in rebet_suave (EGAlberts/ReBeT, 2024). Alberts et al. (ACSOS 2024) describe the decorators
// in section III-C2: the internal plan in evaluate_condition(), asked while the child runs
// (AdaptOnConditionRunning), and external strategies with a utility. Check: both yield more than no
// adaptation, as their Table I has it (SuaveRebet, suave_study/campaign_test.cpp).
//
//   rebet          AdaptSpiralAltitudeOffline: every 10 s the altitude by the latest visibility, with
//                  SUAVE's thresholds
//   rebet-ucb      AdaptSpiralAltitudeOnline: every 10 s an altitude of 1, 2 or 3 m by UCB. Its
//                  utility is 1 whatever the altitude yields, so that all are played alike
//   rebet-greedy, rebet-random   the other policies in the same place
//   bandit         Thompson sampling in the same place, with a reward that tells: the share of the
//                  widest strip that the camera sees, 0 above what the water lets it see
//
// The thrusters are recovered as soon as the tree is ticked, by AdaptThrusterRecovery. The node
// begins at its own 2 m, though the decorator believes that it is at 1 m. The port does not handle the
// battery.
//
// Where its delays come from: ticks at 100 Hz, one to ask and one to see the answer.
#pragma once

#include <optional>

#include "managers/bandit.h"
#include "managers/suave_manager.h"

namespace culprit::study {

class RebetManager : public SuaveManager {
 public:
  enum class Reward : std::uint8_t { kConstant, kStrip };

  // Without a policy: the internal adaptation.
  RebetManager(const Setting& setting, std::optional<BanditPolicy> policy, Reward reward);

 private:
  Routine lead();
  Routine adapt_altitude();
  Routine recover_thrusters();
  // By the latest visibility.
  double internal_altitude() const;
  double next_altitude();
  double reward_of(double altitude) const;

  std::optional<BanditPolicy> policy_;
  Reward reward_;
  std::vector<BanditArm> arms_;  // altitudes of 1, 2 and 3 m
  std::optional<std::size_t> played_;
  double altitude_ = 1;
  bool is_searching_ = false;
  Bell searching_;
};

}  // namespace culprit::study
