// Where the frames of a robot are, as /tf and /tf_static say (REP 105): a tree, of which each frame has its newest transform.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/time.h"
#include "ros2/navigation_messages.h"

namespace culprit::link {

// The point `p` of the frame that is at `place`, in the frame that `place` is given in.
ros2::msg::Vector3 moved_by(const ros2::msg::Transform& place, const ros2::msg::Vector3& p);
// About the z axis, in (-pi, pi].
double yaw_of(const ros2::msg::Quaternion& rotation);
// Its numbers are finite, and the quaternion is a rotation.
bool is_valid(const ros2::msg::Transform& transform);

class FrameTree {
 public:
  // The network decides how many there are, and what they are called.
  static constexpr std::size_t kMostFrames = 10'000;
  static constexpr std::size_t kLongestName = 256;

  enum class Kind : std::uint8_t { kMoving, kStatic };
  // Transforms that are not valid, or between frames with longer names, and new frames behind the limit, are dropped.
  void add(const ros2::msg::TFMessage& message, Kind kind, Time now);

  struct Placed {
    ros2::msg::Transform transform;
    Duration age{};  // of the oldest transform in between that is not static
  };
  // The place of `frame` in `ancestor`. Nothing: transforms do not lead there.
  std::optional<Placed> place(const std::string& frame, const std::string& ancestor,
                              Time now) const;

  // The frames with this name behind their last '/'.
  std::vector<std::string> called(std::string_view name) const;

 private:
  struct Edge {
    std::string parent;
    ros2::msg::Transform transform;
    std::optional<Time> arrived;  // nothing: it is static
  };
  std::map<std::string, Edge> edges_;  // by child
};

}  // namespace culprit::link
