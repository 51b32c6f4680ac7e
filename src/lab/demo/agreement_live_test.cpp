// The live SUNSET and its model are one robot: what culprit sees, blames and does is the same.
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "demo/sunset_demo.h"
#include "sunset_study/study.h"
#include "terminal/console.h"

namespace culprit::lab {
namespace {

// The outcome of one play without its order, which depends on the speed of a real machine's
// processes.
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

// On a busy machine a late message can add or remove a failure, so a story that differs is played
// again. A story that the model does not know differs every time.
constexpr int kPlays = 3;

class Agreement : public testing::Test {
 protected:
  Agreement() {
    SunsetDemo::Options options;
    options.on_event = [this](const Event& event, const RuleSet& rules, Time start) {
      transcript_ += line(event, rules, start, Colour::kOff) + "\n";
    };
    auto demo = SunsetDemo::start(std::move(options), stop_);
    if (demo) {
      demo_ = std::move(*demo);
    } else {
      ADD_FAILURE() << demo.error();
    }
  }

  Expected<Story> of_the_live_robot(const sunset::Scenario& scenario) {
    transcript_.clear();
    const auto outcome = demo_->play(*find_play(scenario.label()));
    if (!outcome) return Error{outcome.error()};
    return Story{{outcome->failures.begin(), outcome->failures.end()},
                 {outcome->strategies.begin(), outcome->strategies.end()}};
  }

  std::atomic<bool> stop_ = false;
  std::string transcript_;
  std::unique_ptr<SunsetDemo> demo_;
};

TEST_F(Agreement, TheModelTellsTheSameStoryAsTheLiveRobot) {
  study::Configuration live;
  live.profile = "live";
  const auto model = study::SunsetStudy::make({live}, 1);
  ASSERT_TRUE(model) << model.error();
  ASSERT_NE(demo_, nullptr);
  for (const sunset::Scenario& scenario : sunset::scenarios()) {
    const Story told = of_the_model(*model, scenario);
    Story seen;
    std::string transcripts;
    for (int i = 0; i < kPlays && seen != told; ++i) {
      const auto story = of_the_live_robot(scenario);
      ASSERT_TRUE(story) << scenario.name() << ": " << story.error();
      seen = *story;
      transcripts += transcript_ + "\n";
    }
    EXPECT_EQ(seen, told) << scenario.name() << "\n" << transcripts;
  }
}

}  // namespace
}  // namespace culprit::lab
