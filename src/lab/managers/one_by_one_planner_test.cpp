// The managers of others on SUNSET: one failure and one strategy at a time.
#include "managers/one_by_one_planner.h"

#include <gtest/gtest.h>

#include "sunset_study/study.h"

namespace culprit::study {
namespace {

class OneByOne : public testing::TestWithParam<const char*> {
 protected:
  Timeline explain(std::uint32_t run) const {
    const auto study =
        SunsetStudy::make({{{true, true, true}, GetParam(), "paper", Probabilities::kIdeal}}, 1);
    return study->explain({0, run});
  }
};
INSTANTIATE_TEST_SUITE_P(EachManager, OneByOne, testing::Values("bt", "metacontrol", "rosa"),
                         [](const auto& test) { return std::string(test.param); });

TEST_P(OneByOne, NeverHasTwoStrategiesUnderWay) {
  int chosen = 0;
  int resolved = 0;
  for (std::uint32_t run = 0; run < 18; ++run) {
    bool is_busy = false;
    for (const TimelineEntry& entry : explain(run).entries) {
      if (entry.kind == Happening::kBlame) {
        EXPECT_FALSE(is_busy) << GetParam() << ", run " << run << ": " << entry.text;
        is_busy = true;
        ++chosen;
      }
      const bool is_over =
          entry.kind == Happening::kGaveUp || (entry.kind == Happening::kResolved &&
                                               entry.text.find("resolved by") != std::string::npos);
      if (is_over) is_busy = false;
      resolved += entry.kind == Happening::kResolved ? 1 : 0;
    }
  }
  EXPECT_GT(chosen, 18);
  EXPECT_GT(resolved, 18);
}

}  // namespace
}  // namespace culprit::study
