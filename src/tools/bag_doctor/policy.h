// Requirements on a recording, for pipelines that check each one (`culprit doctor BAG --policy FILE`):
//
//     # a comment
//     TOPIC /scan RATE 9..11 GAP 500ms COVERAGE 95%
//     TOPIC /imu RATE 90..
//     TOPIC /map
//     PAIR /left/image /right/image OFFSET 20ms
//
//   TOPIC     is there, with a message at least
//   RATE      its mean rate in Hz, between its first and its last message: least, `..`, most; either may be left out
//   GAP       no pause is longer, from the beginning of the recording to its end
//   COVERAGE  this share of the recording, at least, is within twice its usual pause of a message
//   PAIR      each message of the first has one of the second so near, by header stamps where both have them
//   OFFSET    that 95 of 100 keep
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bag_doctor/recording_course.h"
#include "base/units.h"
#include "doctor/finding.h"

namespace culprit::bag_doctor {

struct Policy {
  struct Wish {
    std::string topic;
    std::optional<double> least_rate{}, most_rate{};  // Hz
    std::optional<Duration> gap{};
    std::optional<double> coverage{};  // 0..1
  };
  struct Pair {
    std::string first, second;
    Duration offset{};
  };
  std::vector<Wish> topics{};
  std::vector<Pair> pairs{};
};

// Errors name the line and what is wrong with it.
Expected<Policy> parse_policy(std::string_view text);

// One finding (D214, an error) for each wish that the recording does not keep.
std::vector<doctor::Finding> breaches(const Policy& policy, const BagCourse& course);

}  // namespace culprit::bag_doctor
