#include "monitor/loss_meter.h"

#include <gtest/gtest.h>

namespace culprit::monitor {
namespace {

using namespace std::chrono_literals;

TEST(LossMeter, SaysNothingOfFewMessages) {
  LossMeter meter;
  for (int i = 1; i <= 4; ++i) meter.add(Time(i * 1s), 2);
  EXPECT_FALSE(meter.share(Time(4s)));
}

TEST(LossMeter, CountsWhatWasSentAndDidNotCome) {
  LossMeter meter;
  for (int i = 1; i <= 40; ++i) meter.add(Time(i * 100ms), i % 4 == 0 ? 2 : 1);
  EXPECT_DOUBLE_EQ(*meter.share(Time(4s)), 0.2);
}

TEST(LossMeter, OfFewMessagesTheLossMayBeLarger) {
  LossMeter meter;
  for (int i = 1; i <= 49; ++i) meter.add(Time(i * 100ms), i == 10 ? 2 : 1);
  EXPECT_NEAR(*meter.share(Time(4900ms)), 0.02, 1e-9);
  EXPECT_NEAR(meter.at_most(Time(4900ms)), 0.075, 0.001);
  LossMeter whole;
  for (int i = 1; i <= 49; ++i) whole.add(Time(i * 100ms), 1);
  EXPECT_EQ(whole.at_most(Time(4900ms)), 0);
}

TEST(LossMeter, ForgetsAfterTenSecondsAtMost) {
  LossMeter meter;
  for (int i = 1; i <= 40; ++i) meter.add(Time(i * 100ms), 2);
  for (int i = 41; i <= 160; ++i) meter.add(Time(i * 100ms), 1);
  EXPECT_DOUBLE_EQ(*meter.share(Time(16s)), 0.0);
}

TEST(LossMeter, KnowsNothingWhereNothingComes) {
  LossMeter meter;
  for (int i = 1; i <= 40; ++i) meter.add(Time(i * 100ms), 1);
  EXPECT_TRUE(meter.share(Time(8s)));
  EXPECT_FALSE(meter.share(Time(20s)));
}

TEST(LossMeter, DoesNotKnowTheRobotsLossWhileWeDroppedSomeOfIt) {
  LossMeter meter;
  for (int i = 1; i <= 40; ++i) meter.add(Time(i * 100ms), i % 4 == 0 ? 2 : 1, i == 20);
  EXPECT_FALSE(meter.share(Time(4s)));
  EXPECT_DOUBLE_EQ(*meter.share_with_ours(Time(4s)), 0.2);
  EXPECT_GT(meter.at_most(Time(4s)), 0.2) << "a silence may be that, whoever lost it";
  for (int i = 41; i <= 160; ++i) meter.add(Time(i * 100ms), 1);
  EXPECT_DOUBLE_EQ(*meter.share(Time(16s)), 0.0);
}

TEST(LossMeter, ForgetsWhatCameBeforeARestart) {
  LossMeter meter;
  for (int i = 1; i <= 40; ++i) meter.add(Time(i * 100ms), 2);
  meter.restart(Time(4s));
  EXPECT_FALSE(meter.share(Time(4s)));
}

}  // namespace
}  // namespace culprit::monitor
