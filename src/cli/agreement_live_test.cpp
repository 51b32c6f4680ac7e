// The live SUNSET and its model are one robot: what culprit sees, blames and does is the same.
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/console.h"
#include "cli/sunset_demo.h"
#include "study/sunset/study.h"

namespace culprit::cli {
namespace {

// Of one play, whatever its order: how fast the processes of a real machine are shifts it.
struct Story {
  std::set<std::string> failures;
  std::set<std::string> strategies;  // and by them the components that were blamed
  bool operator==(const Story&) const = default;
};

void PrintTo(const Story& story, std::ostream* out) {
  *out << "failures " << testing::PrintToString(story.failures) << ", strategies "
       << testing::PrintToString(story.strategies);
}

Story of_the_model(const study::SunsetStudy& model, const sunset::Scenario& scenario) {
  const study::SunsetRun run = model.play({0, static_cast<std::uint32_t>(scenario.number - 1)});
  const RuleSet& rules = model.rules(0);
  Story story;
  for (const Event& event : run.events) {
    if (const auto* detected = std::get_if<FailureDetected>(&event.what))
      story.failures.insert(rules[detected->rule].name);
    if (const auto* chosen = std::get_if<StrategyChosen>(&event.what))
      story.strategies.insert(rules[chosen->strategy].name);
  }
  return story;
}

TEST(Agreement, TheModelTellsTheSameStoryAsTheLiveRobot) {
  study::Configuration live;
  live.profile = "live";
  const auto model = study::SunsetStudy::make({live}, 1);
  ASSERT_TRUE(model) << model.error();

  const std::atomic<bool> stop = false;
  std::string transcript;
  SunsetDemo::Options options;
  options.on_event = [&](const Event& event, const RuleSet& rules, Time start) {
    transcript += line(event, rules, start, Colour::kOff) + "\n";
  };
  const auto demo = SunsetDemo::start(std::move(options), stop);
  ASSERT_TRUE(demo) << demo.error();
  for (const sunset::Scenario& scenario : sunset::scenarios()) {
    transcript.clear();
    const auto outcome = (*demo)->play(*find_play(scenario.label()));
    ASSERT_TRUE(outcome) << scenario.name() << ": " << outcome.error();
    const Story story{{outcome->failures.begin(), outcome->failures.end()},
                      {outcome->strategies.begin(), outcome->strategies.end()}};
    EXPECT_EQ(story, of_the_model(*model, scenario)) << scenario.name() << "\n" << transcript;
  }
}

}  // namespace
}  // namespace culprit::cli
