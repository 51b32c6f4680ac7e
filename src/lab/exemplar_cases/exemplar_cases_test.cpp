#include "exemplar_cases/exemplar_cases.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::study {
namespace {

using rca::RcaCase;
using testing::ElementsAre;

const std::vector<RcaCase>& of_sunset() {
  static const std::vector<RcaCase> kCases = sunset_cases(1, 1);
  return kCases;
}

const std::vector<RcaCase>& of_rover() {
  static const std::vector<RcaCase> kCases = rover_cases(1, 1);
  return kCases;
}

const std::string& name_of(const RcaCase& made, std::size_t component) {
  return made.scenario.components[component].name;
}

std::string cause_of(const RcaCase& made) {
  return name_of(made, made.truth.causes.front().fault.component);
}

// As docs/study-rca.md promises of each case.
void expect_a_case(const RcaCase& made) {
  ASSERT_EQ(made.truth.causes.size(), 1U);
  const rca::CaseCause& cause = made.truth.causes.front();
  SCOPED_TRACE(cause.kind);
  ASSERT_FALSE(made.truth.effects.empty());
  for (const rca::CaseEffect& effect : made.truth.effects) {
    EXPECT_NE(effect.component, cause.fault.component);
    EXPECT_GE(effect.since_s, cause.fault.at_s);
  }
  ASSERT_EQ(made.times_s.size(), made.readings.size());
  EXPECT_GE(cause.fault.at_s - made.times_s.front(), 8);
  for (std::size_t t = 0; t < made.times_s.size(); ++t) {
    ASSERT_EQ(made.readings[t].size(), made.watched.size());
    const bool is_well = std::ranges::none_of(made.readings[t], [](bool is_ill) { return is_ill; });
    EXPECT_TRUE(is_well || made.times_s[t] >= cause.fault.at_s) << made.times_s[t];
  }
  EXPECT_FALSE(made.scenario.topics.empty());
  EXPECT_FALSE(made.rules.empty());
  EXPECT_EQ(made.advice.size(), 2U);
}

TEST(SunsetCases, HaveACauseThatShowsElsewhere) {
  ASSERT_FALSE(of_sunset().empty());
  for (const RcaCase& made : of_sunset()) expect_a_case(made);
}

TEST(SunsetCases, HaveTheRobotsGraphAndTheEffectsDownstream) {
  const auto made = std::ranges::find_if(of_sunset(), [](const RcaCase& each) {
    return each.truth.causes.front().kind == "camera_driver_issue";
  });
  ASSERT_NE(made, of_sunset().end());
  EXPECT_EQ(cause_of(*made), "camera");
  EXPECT_THAT(made->truth.causes.front().repairs,
              ElementsAre(rca::Repair::kRestart, rca::Repair::kRedeploy));
  std::vector<std::string> effects;
  for (const rca::CaseEffect& effect : made->truth.effects)
    effects.push_back(name_of(*made, effect.component));
  EXPECT_THAT(effects, testing::IsSupersetOf({"fusion", "segmentation"}));
  const auto fused = std::ranges::find(made->scenario.topics, "/managed_subsystem/sensors_fused",
                                       &rca::RcaTopic::name);
  ASSERT_NE(fused, made->scenario.topics.end());
  ASSERT_EQ(fused->publishers.size(), 1U);
  EXPECT_EQ(name_of(*made, fused->publishers.front()), "fusion");
  ASSERT_FALSE(made->advice.at("bayes").ranked.empty());
  EXPECT_EQ(name_of(*made, made->advice.at("bayes").ranked.front()), "camera");
}

TEST(SunsetCases, AreTheSameEachTime) {
  const std::vector<RcaCase> again = sunset_cases(1, 1);
  ASSERT_EQ(again.size(), of_sunset().size());
  for (std::size_t i = 0; i < again.size(); ++i)
    EXPECT_EQ(again[i].readings, of_sunset()[i].readings);
}

// Else the number of a hidden case would tell its fault.
TEST(SunsetCases, AreOfOtherFaultsInAnotherOrderIfTheseAreDrawn) {
  const auto kinds_of = [](const std::vector<RcaCase>& cases) {
    std::vector<std::string> kinds;
    for (const RcaCase& made : cases) kinds.push_back(made.truth.causes.front().kind);
    return kinds;
  };
  const std::vector<RcaCase> drawn = sunset_cases(5, 1, Faults::kDrawn);
  ASSERT_FALSE(drawn.empty());
  for (const RcaCase& made : drawn) expect_a_case(made);
  EXPECT_NE(kinds_of(drawn), kinds_of(of_sunset()));
  EXPECT_NE(kinds_of(drawn), kinds_of(sunset_cases(6, 1, Faults::kDrawn)));
}

TEST(RoverCases, HaveACauseThatShowsElsewhere) {
  EXPECT_GE(of_rover().size(), 10U);
  for (const RcaCase& made : of_rover()) expect_a_case(made);
}

TEST(RoverCases, ShowTheExitOfAKilledProcess) {
  for (const RcaCase& made : of_rover()) {
    const rca::CaseCause& cause = made.truth.causes.front();
    if (!cause.kind.starts_with("kill:")) continue;
    EXPECT_TRUE(std::ranges::any_of(made.events, [&](const rca::CaseEvent& event) {
      return event.component == cause.fault.component && event.kind == rca::CaseEventKind::kExited;
    })) << cause.kind;
  }
}

TEST(RoverCases, AreMostlyAnsweredRightByBayes) {
  const auto right = std::ranges::count_if(of_rover(), [](const RcaCase& made) {
    const std::vector<std::size_t>& ranked = made.advice.at("bayes").ranked;
    return !ranked.empty() && ranked.front() == made.truth.causes.front().fault.component;
  });
  EXPECT_GE(2 * static_cast<std::size_t>(right), of_rover().size());
}

}  // namespace
}  // namespace culprit::study
