#include "exemplars/suave/model/vehicle.h"

#include <algorithm>

namespace culprit::suave::model {
namespace {

constexpr double kStepSec = std::chrono::duration<double>(Vehicle::kStep).count();

// The speed towards what is `distance` away on one axis.
double towards(double distance, double gain, double limit) {
  return std::clamp(gain * distance, -limit, limit);
}

}  // namespace

Vehicle::Vehicle(const VehicleTraits& traits, const Position& start, simulation::Random random)
    : traits_(traits), random_(random), position_(start), goal_(start) {}

void Vehicle::advance() {
  const double forget = kStepSec / traits_.drift_time_s;
  const double stir = std::sqrt(2 * forget);
  for (double* axis : {&drift_.x, &drift_.y, &drift_.z})
    *axis += -forget * *axis + stir * random_.normal();
  if (!has_power_) return;

  double gain = traits_.gain_per_s;
  double cruise = traits_.cruise;
  for (int failed = failed_thrusters(); failed > 0; --failed) {
    cruise *= failed == 1 ? traits_.failed_speed : traits_.failed_again;
    if (failed == 1) gain *= traits_.failed_gain;
  }
  const double dx = goal_.x - position_.x;
  const double dy = goal_.y - position_.y;
  const double distance = std::sqrt(dx * dx + dy * dy);
  const double speed = distance > 0 ? std::min(gain, cruise / distance) : 0;
  const double keep = kStepSec / traits_.lag_s;
  velocity_.x += keep * (speed * dx - velocity_.x);
  velocity_.y += keep * (speed * dy - velocity_.y);
  velocity_.z += keep * (towards(goal_.z - position_.z, gain, traits_.climb) - velocity_.z);
  position_.x += kStepSec * velocity_.x;
  position_.y += kStepSec * velocity_.y;
  position_.z += kStepSec * velocity_.z;
}

Position Vehicle::seen() const {
  const double sd = traits_.drift_sd;
  return {position_.x + sd * drift_.x, position_.y + sd * drift_.y, position_.z + sd * drift_.z};
}

void Vehicle::set_failed(int thruster, bool is_failed) {
  failed_.at(static_cast<std::size_t>(thruster - 1)) = is_failed;
}

int Vehicle::failed_thrusters() const {
  return static_cast<int>(std::count(failed_.begin(), failed_.end(), true));
}

}  // namespace culprit::suave::model
