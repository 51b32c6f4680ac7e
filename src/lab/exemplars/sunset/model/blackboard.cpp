#include "exemplars/sunset/model/blackboard.h"

#include <algorithm>
#include <limits>

namespace culprit::sunset::model {
namespace {

// Beyond these limits the newest version publishes more often.
constexpr double kLowFrequency = 1;
constexpr double kHighEntropy = 0.06;
constexpr int kAlarming = 2;

}  // namespace

double frequency(const std::deque<Time>& arrivals, std::size_t window, Time now) {
  if (arrivals.size() < window) return 0;
  double best = 0;
  for (std::size_t i = 1; i <= window; ++i) {
    const double age = seconds(now - arrivals[arrivals.size() - i]);
    if (age <= 0) return std::numeric_limits<double>::infinity();
    best = std::max(best, static_cast<double>(i) / age);
  }
  return best;
}

Blackboard::Blackboard(simulation::World& world, Topics& topics, const Profile& profile)
    : Node(world, std::string(kManagedNamespace) + "/abstract_bb_setter", {}),
      profile_(profile),
      diagnostics_(*this, topics.diagnostics, [this](const Heartbeat& beat) {
        for (const auto& [key, value] : beat.values) values_[beat.node + "_" + key] = value;
      }) {
  hear(topics.rgb_camera, "rgb_camera_freq");
  hear(topics.depth_camera, "depth_camera_freq");
  hear(topics.sensors_fused, "sensors_fused_freq");
  hear(topics.segmentation, "segmentation_freq");
}

void Blackboard::hear(simulation::Topic<Frame>& topic, std::string key) {
  auto heard = std::make_unique<Heard>();
  heard->key = std::move(key);
  heard->subscription = std::make_unique<simulation::Subscription<Frame>>(
      *this, topic, [this, raw = heard.get()](const Frame&) {
        raw->arrivals.push_back(world().now());
        if (raw->arrivals.size() > profile_.frequency_window) raw->arrivals.pop_front();
      });
  heard_.push_back(std::move(heard));
}

void Blackboard::on_activate() { publish_again(); }

void Blackboard::publish_again() {
  const bool is_fast = is_alarmed_ && profile_.alarmed_period > Duration::zero();
  world().after(is_fast ? profile_.alarmed_period : profile_.blackboard_period, [this] {
    publish();
    publish_again();
  });
}

void Blackboard::publish() {
  int alarming = 0;
  for (const auto& [key, value] : values_) {
    world().diagnose("blackboard", key, value);
    const auto* number = std::get_if<double>(&value);
    if (number && key.ends_with("entropy") && *number > kHighEntropy) ++alarming;
  }
  for (const auto& heard : heard_) {
    const double hertz = frequency(heard->arrivals, profile_.frequency_window, world().now());
    world().diagnose("blackboard", heard->key, hertz);
    if (hertz < kLowFrequency) ++alarming;
  }
  is_alarmed_ = is_alarmed_ || alarming >= kAlarming;
}

}  // namespace culprit::sunset::model
