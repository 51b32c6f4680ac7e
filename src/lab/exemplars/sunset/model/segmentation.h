// The modelled segmentation: a picture in, how unsure it is and a picture out.
#pragma once

#include "exemplars/sunset/model/entropy.h"
#include "exemplars/sunset/model/managed_node.h"

namespace culprit::sunset::model {

class Segmentation : public ManagedNode {
 public:
  Segmentation(simulation::World& world, Topics& topics, const Profile& profile);

 private:
  void on_frame(const Frame& frame);

  Entropy entropy_;
  simulation::Publisher<Frame> segmented_;
  simulation::Subscription<Frame> fused_;
};

}  // namespace culprit::sunset::model
