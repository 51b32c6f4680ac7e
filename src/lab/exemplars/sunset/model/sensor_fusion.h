// The modelled sensor fusion: pairs pictures of both inputs.
#pragma once

#include "exemplars/sunset/fusion_buffer.h"
#include "exemplars/sunset/model/managed_node.h"

namespace culprit::sunset::model {

class SensorFusion : public ManagedNode {
 public:
  SensorFusion(simulation::World& world, Topics& topics, const Profile& profile);

 private:
  void on_start() override;
  bool on_set(const std::string& name, const Value& value) override;
  void take_rgb_from(std::string_view topic);
  void on_arrival();
  void fuse(const Frame& rgb, const Frame& depth);

  Topics& topics_;
  BasicFusionBuffer<Frame> buffer_;
  simulation::Publisher<Frame> fused_;
  simulation::Subscription<Frame> rgb_;
  simulation::Subscription<Frame> depth_;
};

}  // namespace culprit::sunset::model
