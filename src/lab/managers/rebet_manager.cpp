#include "managers/rebet_manager.h"

#include <algorithm>

#include "exemplars/suave/model/functions.h"
#include "exemplars/suave/model/visibility.h"

namespace culprit::study {
namespace {

constexpr Duration kTreeTick = std::chrono::milliseconds(10);
constexpr Duration kAdaptationPeriod = std::chrono::seconds(10);  // adaptation_period of both trees
constexpr double kLowestAltitude = 1;
constexpr std::size_t kAltitudes = 3;

double altitude_of(std::size_t arm) { return kLowestAltitude + static_cast<double>(arm); }

}  // namespace

RebetManager::RebetManager(const Setting& setting, std::optional<BanditPolicy> policy,
                           Reward reward)
    : SuaveManager(setting), policy_(policy), reward_(reward), arms_(kAltitudes) {
  run(lead());
  run(adapt_altitude());
  run(recover_thrusters());
}

Routine RebetManager::lead() {
  while (!is_true("guided")) co_await news();
  const Request on = ChangeLifecycle{Transition::kActivate};
  const Request off = ChangeLifecycle{Transition::kDeactivate};
  (void)co_await ask("search_node", on, kServiceTimeout);
  is_searching_ = true;
  ring(searching_);
  while (!is_true("detected")) co_await sleep(kTreeTick);
  is_searching_ = false;
  (void)co_await ask("search_node", off, kServiceTimeout);
  (void)co_await ask("follow_node", on, kServiceTimeout);
}

Routine RebetManager::adapt_altitude() {
  while (!is_searching_) co_await hear(searching_);
  for (;;) {
    co_await sleep(kAdaptationPeriod);
    if (!is_searching_) co_return;
    const double wanted = next_altitude();
    if (wanted == altitude_ && !policy_) continue;
    co_await sleep(kTreeTick);
    const Request set = SetParameter{suave::model::kAltitude, wanted};
    const Reply reply = co_await ask("search_node", set, kServiceTimeout);
    if (reply.outcome == Outcome::kDone) altitude_ = wanted;
  }
}

Routine RebetManager::recover_thrusters() {
  const Request on = ChangeLifecycle{Transition::kActivate};
  const Request off = ChangeLifecycle{Transition::kDeactivate};
  for (bool is_recovering = false;;) {
    while (is_thruster_failed() == is_recovering) co_await news();
    co_await sleep(from_seconds(seconds(kTreeTick) * random().uniform()));
    is_recovering = !is_recovering;
    const Request& request = is_recovering ? on : off;
    (void)co_await ask("motion_node", request, kServiceTimeout);
  }
}

double RebetManager::internal_altitude() const {
  const double visibility = number("visibility", 0);
  const auto& modes = suave::model::kSearchModes;
  const auto best = std::find_if(modes.begin(), modes.end(),
                                 [&](const auto& mode) { return visibility >= mode.visibility; });
  return best == modes.end() ? kLowestAltitude : best->altitude;
}

double RebetManager::next_altitude() {
  if (!policy_) return internal_altitude();
  if (played_) arms_[*played_].add(reward_of(altitude_of(*played_)));
  played_ = ranked(*policy_, arms_, random()).front();
  return altitude_of(*played_);
}

double RebetManager::reward_of(double altitude) const {
  if (reward_ == Reward::kConstant) return 1;
  const auto& modes = suave::model::kSearchModes;
  const auto mode = std::find_if(modes.begin(), modes.end(),
                                 [&](const auto& each) { return each.altitude == altitude; });
  const bool is_seen = number("visibility", 0) >= mode->visibility;
  return is_seen ? altitude / altitude_of(kAltitudes - 1) : 0;
}

}  // namespace culprit::study
