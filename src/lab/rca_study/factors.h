// The constants of the generator that differ from robot to robot, and what each may be.
//
// With the values here robots are those of docs/study-rca.md. Each factor is an option of
// `culprit study rca`; files and reports have those that were chosen.
#pragma once

#include <string>
#include <string_view>

#include "base/expected.h"
#include "json/json.h"

namespace culprit::study::rca {

// Uniform between the two, in seconds.
struct RangeOfSeconds {
  double low = 0;
  double high = 0;
  bool operator==(const RangeOfSeconds&) const = default;
};

struct RcaFactors {
  static constexpr double kLongest_s = 30;       // of latencies and delays
  static constexpr double kMostUnwatched = 0.9;  // so that a rule is left
  static constexpr std::size_t kMostCommonCauses = 10;
  static constexpr double kMostFalseAlarms = 60;
  static constexpr std::size_t kMostFaultsBefore = 1000;

  RangeOfSeconds detector_latency_s{0, 0.4};  // from a change until a detector shows it
  bool states_latency = false;       // impacts include the latency of the component's detector
  double pass = 0.9;                 // probability that an ordinary subscription passes failures on
  RangeOfSeconds delay_s{0.1, 0.8};  // until a subscription does
  double unwatched = 0;              // share of components without a rule
  double hidden = 0;                 // share of true dependencies that the graph does not show
  std::size_t common_causes = 0;     // each makes two components ill and is in neither
  double false_alarms = 0;           // of each detector in a minute, in the mean
  std::size_t faults_before = 0;     // in earlier episodes, from which managers learn latencies

  bool operator==(const RcaFactors&) const = default;
};

// "0..3s", "500ms..2s", "1s". Errors name the mistake and the remedy.
Expected<RangeOfSeconds> parse_range(std::string_view text);
// "30%" or "0.3". Errors as above, also if it is more than `most`.
Expected<double> parse_share(std::string_view text, double most);

// The factors that are not as above, for titles: "detectors 0 to 3 s late, stated in impacts";
// empty if there are none.
std::string describe(const RcaFactors& factors);
// The same as options: " --detector-latency 0..3s --stated".
std::string options_of(const RcaFactors& factors);
// The same as JSON: {"detector_latency_s": [0, 3], "stated": true}.
Json to_json(const RcaFactors& factors);
// A factor that is missing is as above. Errors: "hidden is not between 0 and 1".
Expected<RcaFactors> factors_from_json(const Json& json);

}  // namespace culprit::study::rca
