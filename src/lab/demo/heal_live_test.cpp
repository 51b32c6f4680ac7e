// Culprit heals the live SUNSET: real processes, real DDS, real pixels.
//
// CULPRIT_HEAL_ROUNDS plays everything so many times over (1 unless set), CULPRIT_HEAL_SPEED makes
// the robot live faster (2 unless set).
#include <cstdlib>
#include <sstream>

#include <gtest/gtest.h>

#include "demo/sunset_demo.h"
#include "terminal/console.h"

namespace culprit::lab {
namespace {

double setting(const char* name, double otherwise) {
  const char* value = std::getenv(name);
  return value == nullptr ? otherwise : std::atof(value);
}

class Heal : public testing::Test {
 protected:
  Heal() {
    SunsetDemo::Options options;
    options.speed = setting("CULPRIT_HEAL_SPEED", 2);
    options.on_event = [this](const Event& event, const RuleSet& rules, Time start) {
      transcript_ << line(event, rules, start, Colour::kOff) << "\n";
    };
    auto demo = SunsetDemo::start(std::move(options), stop_);
    if (demo) {
      demo_ = std::move(*demo);
    } else {
      ADD_FAILURE() << demo.error();
    }
  }

  // Plays them one after the other, as often as wanted; each must heal.
  void heals(const std::vector<std::string>& plays) {
    const int rounds = static_cast<int>(setting("CULPRIT_HEAL_ROUNDS", 1));
    for (int round = 0; round < rounds; ++round) {
      for (const std::string& name : plays) {
        if (demo_ == nullptr) return;
        transcript_.str("");
        const auto play = find_play(name);
        ASSERT_TRUE(play) << play.error();
        const auto outcome = demo_->play(*play);
        ASSERT_TRUE(outcome) << name << ": " << outcome.error() << "\n" << transcript_.str();
        EXPECT_TRUE(outcome->is_resolved()) << name << ": " << outcome->complaint << "\n"
                                            << transcript_.str();
        EXPECT_FALSE(outcome->failures.empty()) << name << " showed no failure\n"
                                                << transcript_.str();
        last_ = *outcome;
      }
    }
  }

  std::string transcript() const { return transcript_.str(); }

  std::atomic<bool> stop_ = false;
  std::ostringstream transcript_;
  std::unique_ptr<SunsetDemo> demo_;
  PlayOutcome last_;
};

std::vector<std::string> of_every_node(const std::string& fault) {
  std::vector<std::string> plays;
  for (const sunset::Member member : sunset::kManagedMembers)
    plays.push_back(fault + ":" + std::string(sunset::name_of(member)));
  return plays;
}

TEST_F(Heal, EveryCombinationOfFaults) {
  std::vector<std::string> plays;
  for (const sunset::Scenario& scenario : sunset::scenarios()) plays.push_back(scenario.label());
  ASSERT_EQ(plays.size(), 18u);
  heals(plays);
}

TEST_F(Heal, EveryNodeThatIsKilled) { heals(of_every_node("kill")); }

TEST_F(Heal, EveryNodeThatIsStopped) { heals(of_every_node("stop")); }

TEST_F(Heal, EveryNodeThatCrashesAtStart) { heals(of_every_node("crash")); }

TEST_F(Heal, TwoNodesThatAreKilledAtOnce) {
  heals({"kill:camera+segmentation", "kill:sensor_fusion+image_enhancement"});
}

TEST_F(Heal, ACascadeByAdaptingItsRootAlone) {
  heals({"kill:camera"});
  EXPECT_EQ(last_.strategies.size(), 1) << transcript();
  EXPECT_EQ(last_.unnecessary_redeployments, 0) << transcript();
}

}  // namespace
}  // namespace culprit::lab
