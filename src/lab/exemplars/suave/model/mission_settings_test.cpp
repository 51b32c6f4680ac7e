#include "exemplars/suave/model/mission_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "exemplars/suave/model/visibility.h"

namespace culprit::suave::model {
namespace {

using testing::HasSubstr;

const MissionPlan& standard() { return **find_mission_plan("standard"); }

TEST(MissionSettings, ThatAreThePlansOwnChangeNothing) {
  const MissionPlan plan = drawn(standard(), settings_of(standard()), 7, 3);
  EXPECT_EQ(settings_of(plan), settings_of(standard()));
  EXPECT_FALSE(plan.start_y_m);
}

TEST(MissionSettings, AreDrawnFromRangesAnewInEachRun) {
  MissionSettings settings = settings_of(standard());
  settings.visibility_shift_s = {0, 120};
  settings.start_y_m = Range{2, 3};
  settings.thruster_events = {{3, true, {100, 200}}, {1, true, {0, 50}}};
  const MissionPlan one = drawn(standard(), settings, 1, 0);
  const MissionPlan other = drawn(standard(), settings, 2, 0);
  EXPECT_NE(one.visibility_shift_s, other.visibility_shift_s);
  for (const MissionPlan* plan : {&one, &other}) {
    EXPECT_THAT(plan->visibility_shift_s, testing::AllOf(testing::Ge(0), testing::Lt(120)));
    EXPECT_THAT(*plan->start_y_m, testing::AllOf(testing::Ge(2), testing::Lt(3)));
    ASSERT_EQ(plan->thruster_events.size(), 2u);
    EXPECT_EQ(plan->thruster_events[0].thruster, 1) << "in the order of their times";
  }
  EXPECT_EQ(settings_of(drawn(standard(), settings, 1, 0)), settings_of(one));
}

TEST(MissionSettings, ThatAreGivenByTurnsGoTogether) {
  MissionSettings settings = settings_of(standard());
  settings.start_y_m = *parse_range("2.8,3.15");
  settings.thruster_events = {{1, true, *parse_range("24.8,60")}};
  for (std::uint32_t run = 0; run < 4; ++run) {
    const MissionPlan plan = drawn(standard(), settings, 7 + run, run);
    EXPECT_EQ(*plan.start_y_m, run % 2 == 0 ? 2.8 : 3.15);
    EXPECT_EQ(plan.thruster_events.front().at, std::chrono::seconds(run % 2 == 0 ? 25 : 60));
  }
}

TEST(MissionSettings, AreRefusedWhereNoMissionCanHaveThem) {
  MissionSettings settings = settings_of(standard());
  settings.visibility_period_s = 0;
  EXPECT_THAT(check(settings).error(), HasSubstr("period"));
  settings = settings_of(standard());
  settings.thruster_events = {{7, true, {0, 0}}};
  EXPECT_EQ(check(settings).error(), "there is no thruster 7; they are 1 to 6");
  settings = settings_of(standard());
  settings.visibility_shift_s = {20, 10};
  EXPECT_THAT(check(settings).error(), HasSubstr("the lower end first"));
  settings = settings_of(standard());
  settings.start_y_m = *parse_range("1,1001");
  EXPECT_THAT(check(settings).error(), HasSubstr("-1000 to 1000 m"));
  settings = settings_of(standard());
  settings.least_visibility_m = 4;
  EXPECT_THAT(check(settings).error(), HasSubstr("the visibility must be"));
}

TEST(MissionSettings, AreReadAsTheyAreWritten) {
  for (const char* text : {"35", "0..120", "-0.5..2.25", "2.8,3.15,-1"})
    EXPECT_EQ(to_string(*parse_range(text)), text);
  for (const char* text : {"1:fails@35", "3:recovers@0..200"})
    EXPECT_EQ(to_string(*parse_thruster(text)), text);
  for (const char* text : {"", "..", "1..", "x", "inf", "1..2..3", "1,", ",", "1,2..3"})
    EXPECT_FALSE(parse_range(text)) << text;
  for (const char* text : {"", "1", "1:fails", "fails@3", "0:fails@3", "9:fails@3", "1.5:fails@3",
                           "1:breaks@3", "@:", "1@3:fails"})
    EXPECT_THAT(parse_thruster(text).error(), HasSubstr("1:fails@35")) << text;
}

TEST(Visibility, IsAsFarInItsPeriodAsItsShiftSays) {
  EXPECT_EQ(water_visibility(0, 120, 60), 1.25);
  EXPECT_EQ(water_visibility(60, 120, 60), 3.75);
  EXPECT_EQ(water_visibility(17, 120, 0, 2.5, 2.5), 2.5) << "water that stays as it is";
}

}  // namespace
}  // namespace culprit::suave::model
