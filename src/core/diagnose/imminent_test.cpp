#include "diagnose/imminent.h"

#include <gtest/gtest.h>

namespace culprit::diagnose {
namespace {

Input read_as(Input::Kind kind, bool only_compared) {
  Input input;
  input.kind = kind;
  input.only_compared = only_compared;
  input.thresholds = {0.5, 2};
  return input;
}

TEST(LongSilence, IsBeyondTheHighestThresholdOfWhatIsOnlyCompared) {
  for (const auto kind : {Input::Kind::kAge, Input::Kind::kPhi}) {
    EXPECT_TRUE(after_long_silence(read_as(kind, true)));
    EXPECT_FALSE(after_long_silence(read_as(kind, false))) << "its value matters";
    Input unbounded = read_as(kind, true);
    unbounded.thresholds.clear();
    EXPECT_FALSE(after_long_silence(unbounded));
  }
}

}  // namespace
}  // namespace culprit::diagnose
