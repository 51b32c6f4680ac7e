#include "exemplars/suave/model/autopilot.h"

namespace culprit::suave::model {
namespace {

constexpr double kStartX = -17;
constexpr double kStartZ = -18.5;
constexpr Duration kFirstPoseSpread = std::chrono::seconds(1);
constexpr Duration kUndetectedPeriod = std::chrono::seconds(1);

Position start_of(const VehicleTraits& traits, simulation::Random random) {
  return {kStartX, traits.centre_y + traits.centre_y_sd * random.normal(), kStartZ};
}

}  // namespace

Autopilot::Autopilot(simulation::World& world, Topics& topics, const VehicleTraits& traits,
                     Time guided)
    : Node(world, nodes::kAutopilot, {}),
      guided_(guided),
      first_pose_(later(
          guided,
          simulation::Span{from_seconds(traits.first_pose_s), kFirstPoseSpread}.draw(random()))),
      centre_(start_of(traits, world.random("start"))),
      vehicle_(traits, centre_, world.random("vehicle")),
      state_(*this, topics.guided, simulation::Use::kAlways) {}

std::optional<Position> Autopilot::centre() const {
  if (world().now() < first_pose_) return std::nullopt;
  return centre_;
}

void Autopilot::on_start() {
  world().at(guided_, [this] {
    state_.publish({true});
    step();
  });
}

void Autopilot::step() {
  vehicle_.advance();
  if (on_pose) on_pose();
  world().after(Vehicle::kStep, [this] { step(); });
}

Detector::Detector(simulation::World& world, Topics& topics, const Generation& generation,
                   Autopilot& autopilot)
    : Node(world, nodes::kDetector, {}),
      generation_(generation),
      autopilot_(autopilot),
      detected_(*this, topics.detected, simulation::Use::kAlways) {
  world.watch(*this);
  autopilot_.on_pose = [this] { look(); };
}

Detector::~Detector() { world().unwatch(*this); }

void Detector::on_start() {
  if (!generation_.tells_undetected) return;
  every(kUndetectedPeriod, [this] {
    if (!found_) detected_.publish({false});
  });
}

void Detector::on_diagnostic(std::string_view, std::string_view key, const Value& value) {
  if (key == diagnostics::kVisibilityKey) visibility_ = std::get<double>(value);
}

void Detector::look() {
  if (found_ || !visibility_) return;
  found_ = seen_point(autopilot_.vehicle().seen(), generation_.pipeline_height, *visibility_);
  if (!found_) return;
  autopilot_.on_pose = nullptr;
  detected_.publish({true});
}

}  // namespace culprit::suave::model
