// Scenario files of the root-cause benchmark: whatever the bytes are, they are a scenario or
// refused with a reason. A scenario comes back from its own file, and a small one can be played.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

#include "plan/bayes/bayes_planner.h"
#include "rca_study/episode.h"
#include "rca_study/scenario_json.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace culprit::study::rca;
  auto scenario = scenario_from_json(std::string(reinterpret_cast<const char*>(data), size));
  if (!scenario) {
    if (scenario.error().empty()) __builtin_trap();
    return 0;
  }
  const std::string text = to_json(*scenario);
  const auto again = scenario_from_json(text);
  if (!again || to_json(*again) != text) __builtin_trap();
  constexpr double kShort_s = 5;
  scenario->horizon_s = std::min(scenario->horizon_s, kShort_s);
  scenario->reading_s = std::max(scenario->reading_s, 0.1);
  if (scenario->components.size() <= 10)
    (void)play(*scenario, std::make_unique<culprit::BayesPlanner>());
  return 0;
}
