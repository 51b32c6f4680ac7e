#include "exemplars/suave/model/spiral.h"

#include <numbers>
#include <utility>

namespace culprit::suave::model {
namespace {

constexpr double kStepAngle = 0.1;
constexpr int kPatience = 10;       // ticks without arriving
constexpr double kLowering = 0.25;  // metres

// Cut after a nanometre, so that the last bits of a C library's sine change nothing.
double cut(double x) { return std::round(x * 1e9) / 1e9; }

}  // namespace

void Spiral::restart(const Position& centre) {
  *this = {};
  has_begun_ = true;
  centre_ = centre;
}

std::optional<Position> Spiral::tick(const Position& vehicle, double altitude) {
  if (std::exchange(altitude_, altitude) != altitude) ++step_;
  const bool is_over_goal = goal_ && is_near(vehicle, *goal_, kTolerance);
  const bool is_at_depth = goal_ && std::abs(vehicle.z - goal_->z) <= kTolerance;
  if (!goal_ || (is_over_goal && is_at_depth)) {
    misses_ = 0;
    goal_ = next(altitude);
    return goal_;
  }
  if (++misses_ <= kPatience) return std::nullopt;
  misses_ = 0;
  if (is_over_goal) lowered_ += kLowering;
  goal_ = at_altitude(altitude);
  return goal_;
}

Position Spiral::next(double altitude) {
  const double width = 2 * altitude * kSeenPerMetre;
  const double angle = kStepAngle * static_cast<double>(step_);
  if (step_ > 0) radius_ += width * kStepAngle / (2 * std::numbers::pi);
  goal_ = Position{centre_.x + cut(radius_ * std::cos(angle)),
                   centre_.y + cut(radius_ * std::sin(angle)), 0};
  ++step_;
  return at_altitude(altitude);
}

Position Spiral::at_altitude(double altitude) const {
  return {goal_->x, goal_->y, kSeabed + altitude - lowered_};
}

}  // namespace culprit::suave::model
