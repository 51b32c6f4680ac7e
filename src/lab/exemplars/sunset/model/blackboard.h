// SUNSET's own monitoring, the node abstract_bb_setter: it turns topics and diagnostics
// into named values and publishes them now and then. A manager that reads them sees an outage only
// when the frequency of its topic has sunk, long after the last picture.
//
// Published as the diagnostic status "blackboard": segmentation_entropy, camera_autofocus_needed,
// and rgb_camera_freq, depth_camera_freq, sensors_fused_freq and segmentation_freq in Hz. The last
// value of a diagnostic is kept for ever.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "exemplars/sunset/model/managed_node.h"

namespace culprit::sunset::model {

// The exemplar's estimate of a topic's frequency from its last arrivals, newest first in time:
// the greatest of i / (now - t_i), t_i the i-th newest of `window`; 0 with fewer than `window`.
double frequency(const std::deque<Time>& arrivals, std::size_t window, Time now);

class Blackboard : public simulation::Node {
 public:
  Blackboard(simulation::World& world, Topics& topics, const Profile& profile);

 private:
  struct Heard {
    std::string key;
    std::deque<Time> arrivals;  // oldest first
    std::unique_ptr<simulation::Subscription<Frame>> subscription;
  };

  void on_activate() override;
  void hear(simulation::Topic<Frame>& topic, std::string key);
  void publish();
  void publish_again();

  const Profile& profile_;
  std::vector<std::unique_ptr<Heard>> heard_;
  std::map<std::string, Value> values_;
  simulation::Subscription<Heartbeat> diagnostics_;
  bool is_alarmed_ = false;
};

}  // namespace culprit::sunset::model
