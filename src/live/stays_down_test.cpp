#include "live/stays_down.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit::live {
namespace {

using testing::ElementsAre;

TEST(StaysDown, AComponentWithAnotherNodeInTheFileIsAnother) {
  const RuleSet rules =
      *check(Source("test.rules", "COMPONENT camera NODE /front\nCOMPONENT lidar NODE /lidar\n"))
           .rules;
  const ComponentId camera(0u);
  const ComponentId lidar(1u);
  KnownRobot known;
  const auto saw = [&](const std::string& component, const std::string& node) {
    KnownRobot::Part& part = known.parts.emplace_back();
    part.component = component;
    part.node = node;
  };
  saw("camera", "/camera");
  saw("lidar", "/lidar");
  const History past{Event{Time{}, ComponentFound{camera, 7}},
                     Event{Time{}, StaysDown{{camera, lidar}, StaysDown::Why::kPerson, 50}}};
  History kept = past;
  forget_the_renamed(known, rules, kept);
  EXPECT_EQ(kept.size(), 1u);
  EXPECT_THAT(that_stay_down(kept), ElementsAre(lidar));
  saw("camera", "/front");  // since then
  kept = past;
  forget_the_renamed(known, rules, kept);
  EXPECT_EQ(kept.size(), 2u);
  EXPECT_THAT(that_stay_down(kept), ElementsAre(camera, lidar));
}

}  // namespace
}  // namespace culprit::live
