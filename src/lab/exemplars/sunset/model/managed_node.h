// Base of the five managed nodes, the counterpart of exemplars/sunset/managed_node.h for live ones.
// It has a heartbeat from configuring on, fault parameters that heal by activating or by
// configuring, and parameters that may outlive the process.
#pragma once

#include <string>
#include <vector>

#include "exemplars/sunset/members.h"
#include "exemplars/sunset/model/frame.h"
#include "exemplars/sunset/model/profile.h"
#include "simulation/topic.h"

namespace culprit::sunset::model {

// The robot's topics. They outlive its nodes.
struct Topics {
  explicit Topics(simulation::World& world);

  simulation::Topic<Frame> rgb_raw;
  simulation::Topic<Frame> depth_raw;
  simulation::Topic<Frame> truth;
  simulation::Topic<Frame> rgb_camera;
  simulation::Topic<Frame> rgb_enhanced;
  simulation::Topic<Frame> depth_camera;
  simulation::Topic<Frame> sensors_fused;
  simulation::Topic<Frame> segmentation;
  simulation::Topic<Heartbeat> diagnostics;
};

// How long the fusion and the segmentation take to change their states.
simulation::NodeTraits processing_traits(const Profile& profile);

class ManagedNode : public simulation::Node {
 public:
  struct Faults {
    std::vector<std::string> cleared_by_configure = {};
    std::vector<std::string> cleared_by_activate = {};
  };

  ManagedNode(simulation::World& world, Topics& topics, Member member, const Profile& profile,
              Faults faults, simulation::NodeTraits traits);

 protected:
  const Profile& profile() const { return profile_; }

  template <class T>
  T get(const std::string& name) const {
    return std::get<T>(*parameter(name));
  }
  bool is_set(const std::string& fault) const { return get<bool>(fault); }

  // For the next heartbeat.
  void report(std::string key, Value value);

  void on_start() override;
  void on_configure() override;
  void on_activate() override;
  bool on_set(const std::string& name, const Value& value) override;

 private:
  void beat();
  void clear(const std::vector<std::string>& faults);

  const Profile& profile_;
  Faults faults_;
  simulation::Publisher<Heartbeat> heartbeats_;
  Heartbeat next_;
};

}  // namespace culprit::sunset::model
