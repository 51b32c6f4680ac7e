// The modelled image enhancement: idle until it is activated. It undoes a degraded picture exactly,
// and washes out a healthy one.
#pragma once

#include "exemplars/sunset/model/managed_node.h"

namespace culprit::sunset::model {

class ImageEnhancement : public ManagedNode {
 public:
  ImageEnhancement(simulation::World& world, Topics& topics, const Profile& profile);

 private:
  simulation::Publisher<Frame> pictures_;
  simulation::Subscription<Frame> camera_;
};

}  // namespace culprit::sunset::model
