// SUNSET as a discrete-event model: the managed system of the paper's evaluation, in robot time.
//
// The bag plays ten frames a second; five nodes make a segmentation of them; the blackboard watches.
// Pictures carry no pixels, only what the entropy of the segmentation depends on.
#pragma once

#include <memory>

#include "exemplars/sunset/model/blackboard.h"
#include "exemplars/sunset/model/camera.h"
#include "exemplars/sunset/model/evaluator.h"
#include "exemplars/sunset/model/image_enhancement.h"
#include "exemplars/sunset/model/segmentation.h"
#include "exemplars/sunset/model/sensor_fusion.h"
#include "exemplars/sunset/sunset_scenario.h"

namespace culprit::sunset::model {

class SunsetModel {
 public:
  // Starts all nodes. `profile` must outlive the model. The same seed, the same run.
  SunsetModel(const Profile& profile, std::uint64_t seed);

  simulation::World& world() { return world_; }
  const Profile& profile() const { return profile_; }
  Evaluator& evaluator() { return evaluator_; }
  simulation::Node& node(Member member);

  struct Injection {
    Time at;
    const Fault* fault = nullptr;
  };
  // Breaks it when the profile's evaluation does: the three faults in any order. Gives them by
  // time.
  std::vector<Injection> inject(const Scenario& scenario);

  // Whether the fault is in place now.
  bool has(const Fault& fault);

 private:
  void play_frame();

  const Profile& profile_;
  simulation::World world_;
  simulation::Random random_;
  Topics topics_;
  simulation::Node bag_;
  simulation::Publisher<Frame> rgb_;
  simulation::Publisher<Frame> depth_raw_;
  simulation::Publisher<Frame> truth_;
  Duration stamp_{};

  Camera camera_;
  DepthCamera depth_;
  ImageEnhancement enhancement_;
  SensorFusion fusion_;
  Segmentation segmentation_;
  std::unique_ptr<Blackboard> blackboard_;
  Evaluator evaluator_;
};

}  // namespace culprit::sunset::model
