// The modelled camera and depth camera.
#pragma once

#include "exemplars/sunset/model/managed_node.h"

namespace culprit::sunset::model {

class Camera : public ManagedNode {
 public:
  Camera(simulation::World& world, Topics& topics, const Profile& profile);

 private:
  void on_activate() override;
  void on_frame(Frame frame);

  simulation::Publisher<Frame> pictures_;
  simulation::Subscription<Frame> raw_;
};

class DepthCamera : public ManagedNode {
 public:
  DepthCamera(simulation::World& world, Topics& topics, const Profile& profile);

 private:
  void on_frame(Frame frame);

  simulation::Publisher<Frame> pictures_;
  simulation::Subscription<Frame> raw_;
};

}  // namespace culprit::sunset::model
