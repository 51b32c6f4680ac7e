#include "exemplars/sunset/model/managed_node.h"

#include "exemplars/sunset/node_options.h"

namespace culprit::sunset::model {
namespace {

// A picture's way from one node to another on one machine.
constexpr simulation::Transport kPictures{{std::chrono::microseconds(500), {}}, 0};
constexpr simulation::Transport kSmall{{std::chrono::microseconds(200), {}}, 0};

template <class Message>
simulation::Topic<Message> topic(simulation::World& world, std::string_view name,
                                 simulation::Transport transport) {
  return simulation::Topic<Message>(world, std::string(name), transport);
}

}  // namespace

simulation::NodeTraits processing_traits(const Profile& profile) {
  simulation::NodeTraits traits;
  traits.start = profile.start;
  traits.configure = profile.configure;
  traits.activation_delay = profile.processing_activation;
  traits.end = profile.end;
  return traits;
}

Topics::Topics(simulation::World& world)
    : rgb_raw(topic<Frame>(world, topics::kRgbRaw, kPictures)),
      depth_raw(topic<Frame>(world, topics::kDepthRaw, kPictures)),
      truth(topic<Frame>(world, topics::kTruth, kPictures)),
      rgb_camera(topic<Frame>(world, topics::kRgbCamera, kPictures)),
      rgb_enhanced(topic<Frame>(world, topics::kRgbEnhanced, kPictures)),
      depth_camera(topic<Frame>(world, topics::kDepthCamera, kPictures)),
      sensors_fused(topic<Frame>(world, topics::kSensorsFused, kPictures)),
      segmentation(topic<Frame>(world, topics::kSegmentation, kPictures)),
      diagnostics(topic<Heartbeat>(world, topics::kDiagnostics, kSmall)) {}

ManagedNode::ManagedNode(simulation::World& world, Topics& topics, Member member,
                         const Profile& profile, Faults faults, simulation::NodeTraits traits)
    : Node(world, sunset::node_of(member).full(), traits),
      profile_(profile),
      faults_(std::move(faults)),
      heartbeats_(*this, topics.diagnostics, simulation::Use::kAlways) {
  next_.node = name_of(member);
}

void ManagedNode::on_start() { next_.values.clear(); }

void ManagedNode::on_configure() {
  clear(faults_.cleared_by_configure);
  every(from_seconds(kHeartbeatPeriodSec), [this] { beat(); });
}

void ManagedNode::on_activate() { clear(faults_.cleared_by_activate); }

bool ManagedNode::on_set(const std::string& name, const Value& value) {
  if (profile_.keeps_parameters) set_default(name, value);
  return true;
}

void ManagedNode::report(std::string key, Value value) {
  next_.values.emplace_back(std::move(key), std::move(value));
}

void ManagedNode::beat() {
  heartbeats_.publish(next_);
  for (const auto& [key, value] : next_.values) world().diagnose(next_.node, key, value);
  next_.values.clear();
}

void ManagedNode::clear(const std::vector<std::string>& faults) {
  for (const std::string& fault : faults) {
    if (is_set(fault)) assign(fault, false);
  }
}

}  // namespace culprit::sunset::model
