// The experimenter's view of the modelled robot: when segmentations came that could be judged,
// and when something was wrong with them.
#pragma once

#include <optional>

#include "exemplars/sunset/downtime.h"
#include "exemplars/sunset/model/managed_node.h"
#include "exemplars/sunset/truth_buffer.h"

namespace culprit::sunset::model {

class Evaluator : public simulation::Node {
 public:
  // Two frame periods: longer gaps between outputs are downtime.
  static constexpr Duration kTolerated = std::chrono::milliseconds(200);
  // Without a fault for so long at the end, the robot is well.
  static constexpr Duration kCalm = std::chrono::milliseconds(1500);

  // `camera` is asked whether it needs to focus. It must outlive the evaluator.
  Evaluator(simulation::World& world, Topics& topics, const simulation::Node& camera);

  // Earlier output does not count.
  void restart();

  const Downtime& downtime() const { return downtime_; }

  // When the robot was seen unwell last: no segmentation, an unsure one, or a picture out of focus.
  // Nothing: never.
  std::optional<Time> last_unwell() const;
  bool is_well() const;

 private:
  void judge();

  BasicTruthBuffer<Frame> buffer_;
  Downtime downtime_;
  Time last_output_;
  std::optional<Time> last_unwell_;
  const simulation::Node& camera_;
  simulation::Subscription<Frame> truths_;
  simulation::Subscription<Frame> predictions_;
};

}  // namespace culprit::sunset::model
