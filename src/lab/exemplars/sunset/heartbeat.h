// A node's heartbeat on /diagnostics: one status, its hardware id the name of the node, carrying
// the keys that were set since the last one.
//
// The level is always OK: SUNSET's nodes do not notice their faults.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/expected.h"
#include "base/units.h"
#include "ros2/messages.h"
#include "ros2/node.h"
#include "ros2/timer.h"

namespace culprit::sunset {

class Heartbeat {
 public:
  // Beats until it is destroyed. The node outlives it.
  static Expected<std::unique_ptr<Heartbeat>> create(ros2::Node& node, Duration period);

  void set(std::string key, std::string value);

 private:
  Heartbeat(ros2::Node& node, ros2::Publisher<ros2::msg::DiagnosticArray> publisher,
            Duration period);
  void beat();

  const std::string name_;
  ros2::Publisher<ros2::msg::DiagnosticArray> publisher_;
  std::vector<ros2::msg::KeyValue> values_;
  ros2::Timer timer_;
};

}  // namespace culprit::sunset
