#include "exemplars/sunset/health_watch.h"

#include <gtest/gtest.h>

#include "exemplars/sunset/downtime.h"

namespace culprit::sunset {
namespace {

using namespace std::chrono_literals;

Time at(Duration since_begin) { return Time(Duration(100s)) + since_begin; }

TEST(Downtime, IsTheSumOfTheLongGaps) {
  Downtime downtime(at(0s), 200ms);
  for (const auto t : {100ms, 200ms, 300ms, 500ms, 800ms, 900ms, 1900ms}) downtime.on_output(at(t));
  EXPECT_EQ(downtime.between_outputs(), 300ms + 1000ms) << "200 ms are tolerated";
  EXPECT_EQ(downtime.total(at(2s)), 1300ms);
}

TEST(Downtime, OfTheWholeTimeCountsAlsoTheGapsAtItsEnds) {
  Downtime downtime(at(0s), 200ms);
  downtime.on_output(at(1s));
  downtime.on_output(at(1100ms));
  EXPECT_EQ(downtime.between_outputs(), 0s);
  EXPECT_EQ(downtime.total(at(1200ms)), 1s);
  EXPECT_EQ(downtime.total(at(4100ms)), 4s);
}

TEST(Downtime, IsEverythingWithoutAnyOutput) {
  const Downtime downtime(at(0s), 200ms);
  EXPECT_EQ(downtime.between_outputs(), 0s);
  EXPECT_EQ(downtime.total(at(5s)), 5s);
}

// Two seconds of a pipeline that does well.
class WellPipeline {
 public:
  WellPipeline() {
    for (const Member member : kManagedMembers) watch.on_state(member, LifecycleState::kActive);
    run(2s);
  }

  void run(Duration time, double entropy = 0.03, double iou = 0.8) {
    for (const Time end = now + time; now < end; now += 100ms) {
      watch.on_segmentation(now);
      watch.on_entropy(entropy, now);
      watch.on_iou(iou, now);
    }
  }
  std::string complaint() const { return watch.complaint(now); }

  HealthWatch watch{at(0s), 1s};
  Time now = at(0s);
};

TEST(HealthWatch, HasNothingToComplainAboutWhenAllIsWell) {
  EXPECT_EQ(WellPipeline().complaint(), "");
}

TEST(HealthWatch, DoesNotMindAnInactiveEnhancement) {
  WellPipeline pipeline;
  pipeline.watch.on_state(Member::kImageEnhancement, LifecycleState::kInactive);
  EXPECT_EQ(pipeline.complaint(), "");
}

TEST(HealthWatch, ComplainsAboutNodes) {
  WellPipeline pipeline;
  pipeline.watch.on_state(Member::kDepth, std::nullopt);
  EXPECT_EQ(pipeline.complaint(), "depth does not answer");
  pipeline.watch.on_state(Member::kDepth, LifecycleState::kInactive);
  EXPECT_EQ(pipeline.complaint(), "depth is inactive");
}

TEST(HealthWatch, ComplainsAboutSilenceAndWaitsForAWhileAfterIt) {
  WellPipeline pipeline;
  pipeline.now += 1s;
  EXPECT_EQ(pipeline.complaint(), "no segmentation for 1.100 s");
  pipeline.run(1s);
  EXPECT_EQ(pipeline.complaint(), "the segmentation has only just come back");
  pipeline.run(1s);
  EXPECT_EQ(pipeline.complaint(), "");
}

TEST(HealthWatch, ComplainsForAWhileAboutASingleUnsureFrame) {
  WellPipeline pipeline;
  pipeline.run(100ms, 0.07);
  pipeline.run(1s);
  EXPECT_EQ(pipeline.complaint(), "the segmentation is unsure: entropy 0.070");
  pipeline.run(1s);
  EXPECT_EQ(pipeline.complaint(), "");
}

TEST(HealthWatch, ComplainsAboutWrongSegmentationsAndAboutAMissingEvaluator) {
  WellPipeline pipeline;
  pipeline.run(1s, 0.03, 0.2);
  EXPECT_EQ(pipeline.complaint(), "the segmentation is wrong: IoU 0.200");
  for (int frame = 0; frame < 30; ++frame) {
    pipeline.now += 100ms;
    pipeline.watch.on_segmentation(pipeline.now);
  }
  EXPECT_EQ(pipeline.complaint(), "the evaluator says nothing");
}

TEST(HealthWatch, ComplainsAboutABlurUntilTheCameraIsSharp) {
  WellPipeline pipeline;
  pipeline.watch.on_autofocus(true);
  EXPECT_EQ(pipeline.complaint(), "the camera is out of focus");
  pipeline.watch.on_autofocus(false);
  EXPECT_EQ(pipeline.complaint(), "");
}

TEST(HealthWatch, CountsInRobotTime) {
  HealthWatch watch(at(0s), 500ms);
  for (const Member member : kManagedMembers) watch.on_state(member, LifecycleState::kActive);
  for (Duration t = 0s; t < 1s; t += 50ms) {
    watch.on_segmentation(at(t));
    watch.on_iou(0.8, at(t));
  }
  EXPECT_EQ(watch.complaint(at(1s)), "");
}

}  // namespace
}  // namespace culprit::sunset
