#include "exemplars/suave/model/metrics.h"

#include <algorithm>
#include <utility>

#include "exemplars/suave/model/visibility.h"

namespace culprit::suave::model {
namespace {

constexpr double kLowBattery = 0.25;

}  // namespace

Metrics::Metrics(simulation::World& world, Topics& topics) : world_(world), topics_(topics) {
  for (simulation::Topic<Data>* topic : {&topics.detected, &topics.distance}) {
    topic->set_watched(true);
    topic->watch_field("data");
  }
  world.watch(*this);
}

Metrics::~Metrics() { world_.unwatch(*this); }

void Metrics::on_field(const simulation::TopicBase& topic, const std::string&, const Value& value) {
  if (&topic == &topics_.detected) {
    if (value == Value(true) && !found_) found_ = world_.now();
  } else if (&topic == &topics_.distance) {
    const double told = std::get<double>(value);
    if (told < distance_) earlier_distance_ += distance_;
    distance_ = told;
  }
}

void Metrics::on_diagnostic(std::string_view, std::string_view key, const Value& value) {
  if (key == diagnostics::kVisibilityKey) {
    on_visibility(std::get<double>(value));
  } else if (key == diagnostics::kBatteryKey) {
    on_battery(std::get<double>(value));
  } else if (key.starts_with(diagnostics::kThrusterKey) &&
             value == Value(std::string(diagnostics::kFailed))) {
    if (!failed_thruster_) failed_thruster_ = world_.now();
  }
}

void Metrics::on_visibility(double metres) {
  const auto expected = std::find_if(kSearchModes.begin(), kSearchModes.end(),
                                     [&](const SearchMode& m) { return m.visibility <= metres; });
  if (expected == kSearchModes.end()) return;
  expected_altitude_ = expected->altitude;
  const simulation::Node* search = world_.node(nodes::kSearch);
  const Value* altitude = search->is_in_graph() ? search->parameter(kAltitude) : nullptr;
  if (altitude == nullptr || *altitude == Value(expected_altitude_)) return;
  if (mismatch_ || low_battery_) return;
  mismatch_ = world_.now();
  is_mismatch_over_ = !search->is_active();
}

void Metrics::on_battery(double level) {
  if (level > kLowBattery) {
    if (!is_battery_answered_) give_up(low_battery_, battery_);
    low_battery_.reset();
  } else if (level < kLowBattery && !low_battery_) {
    low_battery_ = world_.now();
    is_battery_answered_ = false;
    give_up_mismatch();
    mismatch_.reset();
  }
}

void Metrics::answer(std::optional<Time>& open, Reactions& reactions) {
  if (!open) return;
  reactions.answered_s.push_back(seconds(world_.now() - *open));
  open.reset();
}

void Metrics::on_parameter(const simulation::Node& node, const std::string& name,
                           const Value& value) {
  if (node.name() == nodes::kSearch && name == kAltitude && value == Value(expected_altitude_))
    answer(mismatch_, visibility_);
}

void Metrics::on_lifecycle(const simulation::Node& node) {
  if (!node.is_active()) {
    if (node.name() == nodes::kSearch) give_up_mismatch();
    return;
  }
  if (node.name() == nodes::kMotion) {
    answer(failed_thruster_, thruster_);
  } else if (node.name() == nodes::kRecharge && low_battery_) {
    battery_.answered_s.push_back(seconds(world_.now() - *low_battery_));
    is_battery_answered_ = true;
  }
}

void Metrics::give_up(const std::optional<Time>& open, Reactions& reactions) {
  if (open) reactions.unanswered_s.push_back(seconds(world_.now() - *open));
}

void Metrics::give_up_mismatch() {
  if (!std::exchange(is_mismatch_over_, true)) give_up(mismatch_, visibility_);
}

void Metrics::finish() {
  give_up_mismatch();
  give_up(failed_thruster_, thruster_);
  if (!is_battery_answered_) give_up(low_battery_, battery_);
}

}  // namespace culprit::suave::model
