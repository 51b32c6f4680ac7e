// The metrics of one run of a study.
//
// Twice: as the exemplar's own script computes it (what never recovers
// counts as no downtime, what is never resolved as no reaction time), and honestly.
//
// All numbers are finite; times are seconds of the robot, counts are not negative but where said.
#pragma once

#include <cstdint>
#include <vector>

namespace culprit::study {

// How often the root cause was asked for, and how often the answer was right.
struct RootCauses {
  std::int32_t asked = 0;
  std::int32_t top_right = 0;    // the component blamed most is a cause
  std::int32_t exact_right = 0;  // the components blamed are the causes: all, and no other

  bool operator==(const RootCauses&) const = default;
};

struct HonestMetrics {
  double downtime_s = 0;             // also what is missing at the beginning and at the end
  std::int32_t strategies = 0;       // executed
  std::int32_t faults = 0;           // that went in
  std::int32_t wrong_component = 0;  // adaptations of components that were well
  std::int32_t unresolved = 0;       // failures that were still there at the end
  // From the first fault until all was well again. If that did not happen, until the end, and the
  // run is censored: it would have taken at least this long.
  double recovery_s = 0;
  bool is_recovery_censored = false;
  RootCauses root_causes;

  bool operator==(const HonestMetrics&) const = default;
};

struct RunMetrics {
  // The script leaves some runs out of ratio, reaction times and downtime: logs it finds invalid,
  // and with D alone those with more than two unnecessary redeployments. It counts the
  // redeployments of all.
  bool is_left_out = false;
  double ratio = 0;                            // f_resolved / s_executed
  std::vector<double> reactions_s{};           // of each failure that was resolved
  double downtime_s = 0;                       // gaps between outputs
  std::int32_t unnecessary_redeployments = 0;  // negative if a necessary one is missing
  HonestMetrics honest{};

  bool operator==(const RunMetrics&) const = default;
};

}  // namespace culprit::study
