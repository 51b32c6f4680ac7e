#include "live/situation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "manager/test_robot.h"

namespace culprit::live {
namespace {

using namespace std::chrono_literals;
using test::TestRobot;
using testing::HasSubstr;

constexpr const char* kSituationRules = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT fusion NODE /fusion LAUNCH "fusion"
COMPONENT lamp   NODE /lamp
RULE CameraSilent
  POLICIES ERROR ATTEMPTS 2
  TRIGGER age(/rgb) > 300ms
    STRATEGY redeploy_camera 90 10
      ADAPTATION camera redeploy 20
RULE FusionSilent
  POLICIES WARNING
  TRIGGER age(/fused) > 300ms
    STRATEGY restart_fusion 90 10
      ADAPTATION fusion restart 10
RULE Dark
  POLICIES NON_CRITICAL
  TRIGGER brightness < 0.5
    STRATEGY light 90 10
      ADAPTATION lamp set_parameter on 1 2
)";

// A camera, what needs it, and a lamp that has nothing to do with either.
struct Watched {
  explicit Watched(Approval approval = Approval::kNone, Autonomy autonomy = Autonomy::kAct,
                   const std::string& host_of_camera = "") {
    Manager::Options options;
    options.governor.approval = approval;
    options.autonomy = autonomy;
    robot.emplace(kSituationRules, std::make_unique<BayesPlanner>(), options);
    robot->add("camera", {}, "/rgb").host = host_of_camera;
    robot->add("fusion", {"camera"}, "/fused").hears = {};
    robot->add("lamp").parameters["on"] = Value(std::int64_t{0});
    robot->after_step = [this] { situation.take(robot->manager().events(), robot->rules()); };
    robot->discover();
    robot->signal("brightness", Value(1.0));
    robot->run_for(8s);
  }
  std::vector<Incident> incidents() const { return situation.incidents(robot->manager()); }
  std::vector<std::string> names(const std::vector<RuleId>& rules) const {
    std::vector<std::string> all;
    for (const RuleId rule : rules) all.push_back(robot->rules()[rule].name);
    return all;
  }

  Situation situation;
  mutable std::optional<TestRobot> robot;
};

TEST(Situation, IsEmptyWhileAllIsWell) { EXPECT_TRUE(Watched().incidents().empty()); }

TEST(Situation, IsOneIncidentForOneFaultWithWhatSuffersFromIt) {
  Watched watched;
  watched.robot->kill("camera");
  watched.robot->run_for(500ms);
  const auto incidents = watched.incidents();
  ASSERT_EQ(incidents.size(), 1u) << transcript(*watched.robot);
  const Incident& incident = incidents[0];
  EXPECT_EQ(watched.robot->rules()[incident.root].name, "CameraSilent");
  EXPECT_THAT(watched.names(incident.consequences), testing::ElementsAre("FusionSilent"));
  EXPECT_EQ(incident.components, std::vector{ComponentId(0)});
  EXPECT_TRUE(incident.is_certain);
  EXPECT_EQ(incident.criticality, Criticality::kError);
  EXPECT_EQ(incident.headline, "camera is dead");
  EXPECT_EQ(incident.doing, "being repaired: redeploy camera");
  EXPECT_FALSE(incident.needs_person());
  watched.robot->run_for(10s);
  EXPECT_TRUE(watched.incidents().empty()) << transcript(*watched.robot);
}

TEST(Situation, IsOneIncidentForAPersonWhereAComputerIsNotHeard) {
  Watched watched(Approval::kNone, Autonomy::kAct, "rover2");
  watched.robot->cut("rover2");
  watched.robot->run_for(60s);
  const auto incidents = watched.incidents();
  ASSERT_EQ(incidents.size(), 1u) << transcript(*watched.robot);
  EXPECT_EQ(incidents[0].headline, "rover2, where camera ran, is unreachable");
  EXPECT_EQ(incidents[0].host, "rover2");
  EXPECT_EQ(incidents[0].components, std::vector{ComponentId(0)});
  EXPECT_EQ(incidents[0].consequences.size(), 1u);
  EXPECT_TRUE(incidents[0].needs_person());
  EXPECT_FALSE(incidents[0].is_exhausted);
  watched.robot->mend("rover2");
  watched.robot->run_for(5s);
  EXPECT_TRUE(watched.incidents().empty()) << transcript(*watched.robot);
}

TEST(Situation, SaysWhatComesNextAndWhen) {
  Watched watched;
  watched.robot->kill("camera");
  watched.robot->run_for(500ms);
  EXPECT_EQ(watched.incidents().at(0).next, "redeploy_camera is being carried out");
  auto& camera = (*watched.robot)["camera"];
  camera.fault = "nothing helps";
  for (int i = 0; i < 100 && watched.incidents().at(0).next.find("if the symptom") != 0; ++i)
    watched.robot->run_for(100ms);
  EXPECT_THAT(watched.incidents().at(0).next, HasSubstr("if the symptom is not gone in "));
  watched.robot->run_for(2min);
  const auto incidents = watched.incidents();
  ASSERT_FALSE(incidents.empty());
  EXPECT_TRUE(incidents[0].is_exhausted) << transcript(*watched.robot);
  EXPECT_TRUE(incidents[0].needs_person());
  EXPECT_EQ(incidents[0].doing, "nothing helped");
  EXPECT_EQ(incidents[0].next, "nothing more is tried: a person must look");
}

TEST(Situation, TellsTwoFaultsApartWorstFirst) {
  Watched watched;
  watched.robot->signal("brightness", Value(0.1));
  watched.robot->kill("camera");
  watched.robot->order({1, "Ann", "", Pause{}});
  watched.robot->run_for(1s);
  const auto incidents = watched.incidents();
  ASSERT_EQ(incidents.size(), 2u) << transcript(*watched.robot);
  EXPECT_EQ(incidents[0].headline, "camera is dead");
  EXPECT_EQ(incidents[0].doing, "nothing is done: culprit is paused");
  EXPECT_EQ(incidents[1].headline, "lamp is held responsible");
}

TEST(Situation, SaysThatItWaitsForAPerson) {
  Watched watched(Approval::kEach);
  watched.robot->kill("camera");
  watched.robot->run_for(1s);
  const auto incidents = watched.incidents();
  ASSERT_EQ(incidents.size(), 1u) << transcript(*watched.robot);
  EXPECT_TRUE(incidents[0].awaits_approval);
  EXPECT_EQ(incidents[0].doing, "waits for approval: redeploy camera");
}

TEST(Situation, SaysWhatWouldBeDoneInADryRun) {
  Watched watched(Approval::kNone, Autonomy::kAdvise);
  watched.robot->kill("camera");
  watched.robot->run_for(1s);
  ASSERT_EQ(watched.incidents().size(), 1u) << transcript(*watched.robot);
  EXPECT_EQ(watched.incidents()[0].doing, "would be repaired: redeploy camera");
}

TEST(Situation, KnowsNothingOfOtherRulesAfterAReload) {
  Watched watched;
  watched.robot->kill("camera");
  watched.robot->run_for(500ms);
  Situation anew;  // as after forget(): nothing was told of what is there
  const auto incidents = anew.incidents(watched.robot->manager());
  ASSERT_FALSE(incidents.empty());
  EXPECT_EQ(incidents[0].headline, "camera is dead") << "that much is known without events";
  EXPECT_FALSE(incidents[0].is_certain);
}

}  // namespace
}  // namespace culprit::live
