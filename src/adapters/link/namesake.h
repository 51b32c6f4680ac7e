// Another node that has the name of ours. It may be our own of before, which is just leaving when rules are
// reloaded: then it is no other node.
#pragma once

#include <optional>
#include <string>

#include "base/time.h"
#include "ros2/graph.h"

namespace culprit::link {

class Namesake {
 public:
  // A namesake that is still there after that is another node.
  static constexpr Duration kLeaves = std::chrono::seconds(2);

  void joined(const ros2::GraphNode& node, Time now);
  void left() { text_.reset(); }
  // The message for a person, once.
  std::optional<std::string> due(Time now);

 private:
  std::optional<std::string> text_;  // while one is there
  Time since_{};
  bool is_told_ = false;
};

}  // namespace culprit::link
