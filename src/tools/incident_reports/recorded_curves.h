// The curves of numbers in a recording of an incident, those first that the failed rules read.
//
//     const auto shown = recorded_curves("rover_….mcap", {rules, {"LidarDead"}, {"lidar"}});
//     for (const Curve& curve : shown->curves) draw(curve);
//
// The file came from elsewhere and is not trusted: it is read from its beginning to its end, as far as that is whole
// (bag/bag_file.h), and each curve is thinned while it is read (bag/thinned_curve.h). So memory has an end, whatever the
// file says.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bag/thinned_curve.h"
#include "base/expected.h"
#include "language/rule_set.h"

namespace culprit::incident_reports {

struct Curve {
  std::string name{};            // "/odom twist.linear.x"; what it is, for people
  std::string about{};           // why it is shown: "read by LidarDead", "lidar publishes it"
  std::string unit{};            // "s"; empty: that of the message, which does not say
  std::vector<double> limits{};  // that the rules compare it with
  std::vector<bag::ThinnedCurve::Point> points{};
  std::int64_t longest_gap =
      0;  // ns: nobody knows what was between two points that are further apart
};

struct RecordedCurves {
  std::int64_t begin = 0;  // of the recording, nanoseconds since 1970
  std::int64_t end = 0;
  std::vector<Curve> curves;
  std::vector<std::string> remarks;  // sentences: what is not shown, and why
};

struct CurveWish {
  const RuleSet& rules;
  std::vector<std::string> failed;      // rules, the first first
  std::vector<std::string> components;  // that are concerned, likewise
};

struct CurveLimits {
  std::size_t most_curves = 24;
  std::size_t most_of_topic = 6;                     // that no rule names
  std::uint64_t most_file = std::uint64_t{8} << 30;  // bytes; a larger one is not read
  std::uint64_t most_messages = std::uint64_t{2}
                                << 30;  // bytes of messages; what comes then is not read
  std::size_t most_memory = std::size_t{64} << 20;  // bytes of a chunk or a message
};

// For each rule that failed: the signals, parameters and diagnostics that its trigger reads, and the rhythm of topics whose
// age or rate it reads. Then numbers that change in small messages that the components publish, or the rhythm of those
// messages that have none; and then numbers that the components hear (by /culprit/graph of the recording).
// Errors: there is no such file, it is no recording, or it is too large.
Expected<RecordedCurves> recorded_curves(const std::filesystem::path& recording,
                                         const CurveWish& wish, const CurveLimits& limits = {});

}  // namespace culprit::incident_reports
