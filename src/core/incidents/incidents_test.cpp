#include "incidents/incidents.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "manager/test_robot.h"

namespace culprit {
namespace {

using namespace std::chrono_literals;
using test::TestRobot;
using testing::AllOf;
using testing::HasSubstr;

const std::string kIncidentRules = test::rules_of_camera_and_lamp();

struct Watched {
  explicit Watched(Approval approval = Approval::kNone, Autonomy autonomy = Autonomy::kAct,
                   const std::string& host_of_camera = "") {
    Manager::Options options;
    options.governor.approval = approval;
    options.autonomy = autonomy;
    robot.emplace(kIncidentRules, std::make_unique<BayesPlanner>(), options);
    test::add_camera_and_lamp(*robot);
    (*robot)["camera"].host = host_of_camera;
    robot->after_step = [this] { note(); };
    robot->discover();
    robot->signal("brightness", Value(1.0), 8s);
  }
  const std::vector<Incident>& incidents() const { return robot->manager().incidents().open(); }
  Incidents::Course course(std::size_t place = 0) const {
    return robot->manager().course_of(incidents().at(place));
  }
  void note() {
    for (const Event& event : robot->manager().events()) {
      if (const auto* opened = std::get_if<IncidentOpened>(&event.what))
        told.push_back("opened " + opened->incident.headline);
      if (const auto* closed = std::get_if<IncidentClosed>(&event.what))
        told.push_back(std::string(to_string(closed->how)) + " " +
                       robot->rules()[closed->root].name);
    }
  }
  std::vector<std::string> names(const std::vector<RuleId>& rules) const {
    std::vector<std::string> all;
    for (const RuleId rule : rules) all.push_back(robot->rules()[rule].name);
    return all;
  }

  std::vector<std::string> told;  // when incidents open and close
  mutable std::optional<TestRobot> robot;
};

TEST(Incidents, IsEmptyWhileAllIsWell) { EXPECT_TRUE(Watched().incidents().empty()); }

TEST(Incidents, IsOneIncidentForOneFaultWithWhatSuffersFromIt) {
  Watched watched;
  watched.robot->kill("camera", 500ms);
  const auto incidents = watched.incidents();
  ASSERT_EQ(incidents.size(), 1u);
  const Incident& incident = incidents[0];
  EXPECT_EQ(watched.robot->rules()[incident.root].name, "CameraSilent");
  EXPECT_THAT(watched.names(incident.consequences), testing::ElementsAre("FusionSilent"));
  EXPECT_EQ(incident.components, std::vector{ComponentId(0)});
  EXPECT_TRUE(incident.is_certain);
  EXPECT_EQ(incident.criticality, Criticality::kError);
  EXPECT_EQ(incident.headline, "camera is down");
  EXPECT_EQ(watched.course().doing, "being repaired: redeploy camera");
  EXPECT_FALSE(incident.needs_person());
  watched.robot->run_for(10s);
  EXPECT_TRUE(watched.incidents().empty());
}

TEST(Incidents, IsOneIncidentForAPersonWhereAComputerIsNotHeard) {
  Watched watched(Approval::kNone, Autonomy::kAct, "rover2");
  watched.robot->cut("rover2", 60s);
  const auto incidents = watched.incidents();
  ASSERT_EQ(incidents.size(), 1u);
  EXPECT_EQ(incidents[0].headline, "rover2, where camera ran, is unreachable");
  EXPECT_EQ(incidents[0].host, "rover2");
  EXPECT_EQ(incidents[0].components, std::vector{ComponentId(0)});
  EXPECT_EQ(incidents[0].consequences.size(), 1u);
  EXPECT_TRUE(incidents[0].needs_person());
  EXPECT_FALSE(incidents[0].is_exhausted);
  watched.robot->mend("rover2", 5s);
  EXPECT_TRUE(watched.incidents().empty());
}

// A last resort makes the robot stand still; the component that does so is not the cause.
TEST(Incidents, DoNotBlameWhatALastResortAdapts) {
  TestRobot robot(R"(
COMPONENT lidar NODE /lidar LAUNCH "lidar"
COMPONENT base  NODE /base
RULE LidarSilent
  POLICIES ERROR
  TRIGGER age(/scan) > 300ms
    STRATEGY replace_lidar 90 10
      ADAPTATION lidar redeploy 20
    STRATEGY stand_still 100 10 LASTRESORT WITHIN 1s
      ADAPTATION base set_parameter stopped 1 1
)",
                  std::make_unique<BayesPlanner>(), Manager::Options{});
  robot.add("lidar", {}, "/scan");
  robot.add("base").parameters["stopped"] = Value(std::int64_t{0});
  robot.discover(8s);
  robot.fail("lidar", "a person", 2s);
  ASSERT_EQ(robot["base"].parameters["stopped"], Value(std::int64_t{1}));
  const auto& open = robot.manager().incidents().open();
  ASSERT_EQ(open.size(), 1u);
  EXPECT_EQ(open[0].components, std::vector{ComponentId(0)});
  EXPECT_EQ(transcript(robot).find("base is held responsible"), std::string::npos);
}

TEST(Incidents, SaysWhatComesNextAndWhen) {
  Watched watched;
  watched.robot->kill("camera", 500ms);
  EXPECT_EQ(watched.course().next, "redeploy_camera is being carried out");
  auto& camera = (*watched.robot)["camera"];
  camera.fault = "nothing helps";
  for (int i = 0; i < 100 && watched.course().next.find("if it does not clear") != 0; ++i)
    watched.robot->run_for(100ms);
  EXPECT_THAT(watched.course().next, AllOf(HasSubstr("if it does not clear in "),
                                           HasSubstr(" s, culprit tries the next strategy")));
  watched.robot->run_for(2min);
  const auto incidents = watched.incidents();
  ASSERT_FALSE(incidents.empty());
  EXPECT_TRUE(incidents[0].is_exhausted);
  EXPECT_TRUE(incidents[0].needs_person());
  EXPECT_EQ(watched.course().doing, "nothing helped");
  EXPECT_EQ(watched.course().next, "nothing more is tried: a person must look");
}

TEST(Incidents, SayThatAPersonEndedItAlsoBeforeAnythingIsDecided) {
  Watched watched;
  TestRobot& robot = *watched.robot;
  robot.leave("camera");
  robot.tell(ProcessSeen{robot.id("camera"), ProcessState::kGone, robot["camera"].pid,
                         "killed by signal 2", Cause::kOrder},
             20s);
  ASSERT_FALSE(watched.incidents().empty());
  ASSERT_EQ(watched.incidents()[0].components, std::vector{ComponentId(0)});
  const Incidents undecided{IncidentIds{}};
  EXPECT_THAT(
      undecided
          .course_of(watched.incidents()[0], robot.manager().knowledge(), Incidents::Halt::kNone)
          .doing,
      AllOf(testing::StartsWith("not repaired: camera ended"),
            HasSubstr("; culprit revive starts it again")));
}

TEST(Incidents, DoNotSayThatNothingHelpedWhereNothingWasTried) {
  TestRobot robot("RULE Low\n  POLICIES ERROR REPORT\n  TRIGGER battery < 0.2\n",
                  std::make_unique<BayesPlanner>(), Manager::Options{});
  robot.discover();
  for (int i = 0; i < 5; ++i) robot.signal("battery", Value(0.1), 1s);
  const auto& open = robot.manager().incidents().open();
  ASSERT_EQ(open.size(), 1u);
  const Incidents::Course course = robot.manager().course_of(open[0]);
  EXPECT_EQ(course.doing, "its rule only reports");
  EXPECT_EQ(course.next, "a person must look");
}

TEST(Incidents, TellsTwoFaultsApartWorstFirst) {
  Watched watched;
  watched.robot->signal("brightness", Value(0.1));
  watched.robot->kill("camera");
  watched.robot->order({1, "Ann", "", Pause{}}, 1s);
  const auto incidents = watched.incidents();
  ASSERT_EQ(incidents.size(), 2u);
  EXPECT_EQ(incidents[0].headline, "camera is down");
  EXPECT_EQ(watched.course().doing, "nothing is done: culprit is paused");
  EXPECT_EQ(incidents[1].headline, "lamp is held responsible");
}

TEST(Incidents, DoNotBlameAPauseThatIsOver) {
  Watched watched;
  watched.robot->kill("camera");
  watched.robot->order({1, "Ann", "", Pause{}}, 1s);
  EXPECT_EQ(watched.course().doing, "nothing is done: culprit is paused");
  watched.robot->tell(HearingLost{"a test"});
  watched.robot->order({2, "Ann", "", Resume{}}, 1s);
  EXPECT_THAT(watched.course().doing, HasSubstr("does not receive"));
  EXPECT_THAT(watched.course().doing, testing::Not(HasSubstr("paused")));
}

TEST(Incidents, SaysThatItWaitsForAPerson) {
  Watched watched(Approval::kEach);
  watched.robot->kill("camera", 1s);
  const auto incidents = watched.incidents();
  ASSERT_EQ(incidents.size(), 1u);
  EXPECT_TRUE(incidents[0].awaits_approval);
  EXPECT_EQ(watched.course().doing, "waits for approval: redeploy camera");
}

TEST(Incidents, SaysWhatWouldBeDoneInADryRun) {
  Watched watched(Approval::kNone, Autonomy::kAdvise);
  watched.robot->kill("camera", 1s);
  ASSERT_EQ(watched.incidents().size(), 1u);
  EXPECT_EQ(watched.course().doing, "would be repaired: redeploy camera");
}

TEST(Incidents, KeepTheirIdsUntilTheirEndsAndShareThemWithNone) {
  Watched watched;
  watched.robot->kill("camera", 500ms);
  const std::string id = watched.incidents().at(0).id;
  watched.robot->signal("brightness", Value(0.1), 200ms);
  ASSERT_EQ(watched.incidents().size(), 2u);
  EXPECT_EQ(watched.incidents()[0].id, id);
  EXPECT_NE(watched.incidents()[1].id, id);
  watched.robot->signal("brightness", Value(1.0), 30s);
  EXPECT_TRUE(watched.incidents().empty());
  watched.robot->kill("camera", 500ms);
  EXPECT_NE(watched.incidents().at(0).id, id);
}

TEST(Incidents, HaveTheSameIdsWhereverTheSameHappensToTheSameRun) {
  const auto id_of = [](std::int64_t wall, const std::string& salt) {
    Manager::Options options;
    options.incidents = {wall, salt};
    TestRobot robot(kIncidentRules, std::make_unique<BayesPlanner>(), options);
    robot.add("camera", {}, "/rgb");
    robot.discover();
    robot.signal("brightness", Value(1.0), 8s);
    robot.kill("camera", 500ms);
    return robot.manager().incidents().open().at(0).id;
  };
  constexpr std::int64_t kNoon = 1'800'000'000'000'000'000;
  EXPECT_EQ(id_of(kNoon, "a"), id_of(kNoon, "a"));
  EXPECT_NE(id_of(kNoon, "a"), id_of(kNoon, "b")) << "another robot at the same time";
  EXPECT_NE(id_of(kNoon, "a"), id_of(kNoon + 5'000'000, "a"));
  EXPECT_EQ(id_of(kNoon, "a").size(), 12u) << "one can read it out";
}

// An effect may be noticed before its cause. Both are one incident, under one id.
TEST(Incidents, AreTheSameWhenTheirRootTurnsUpLater) {
  Watched watched;
  watched.robot->order({1, "Ann", "", Pause{}});
  (*watched.robot)["fusion"].fault = "nothing helps";
  watched.robot->run_for(1s);
  ASSERT_EQ(watched.incidents().size(), 1u);
  const std::string id = watched.incidents()[0].id;
  watched.robot->kill("camera", 2s);
  for (const Incident& each : watched.incidents()) {
    const bool has_fusion = each.has(RuleId(1));
    if (has_fusion) {
      EXPECT_EQ(each.id, id);
    }
  }
}

TEST(Incidents, AreOpenedAndClosedOnce) {
  Watched watched;
  watched.robot->kill("camera", 30s);
  EXPECT_THAT(watched.told, testing::ElementsAre("opened camera is down", "resolved CameraSilent"));
}

// The two dead components of this course were one incident of the page.
TEST(Incidents, AreTwoForTwoDeadComponentsWhileNothingIsDone) {
  Watched watched;
  watched.robot->order({1, "Ann", "", Pause{}});
  watched.robot->kill("camera", 3s);
  watched.robot->signal("brightness", Value(0.1));
  watched.robot->kill("lamp", 3s);
  ASSERT_EQ(watched.incidents().size(), 2u);
  // Only a person can start the lamp.
  EXPECT_EQ(watched.incidents()[0].headline, "lamp is down");
  EXPECT_TRUE(watched.incidents()[0].needs_person());
  EXPECT_EQ(watched.incidents()[1].headline, "camera is down");
}

// The planner's decisions say which failures belong together, from step to step.
struct Told {
  // Shows these failures, as after a step in which `what` happened.
  std::vector<EventWhat> after(std::vector<RuleId> failing, std::vector<EventWhat> what) {
    knowledge.now += 1s;
    EventLog events;
    for (std::size_t r = 0; r < rules.rules.size(); ++r) {
      const bool is_there = std::ranges::find(failing, RuleId(r)) != failing.end();
      if (is_there == (knowledge.states[RuleId(r)].phase != RulePhase::kQuiet)) continue;
      knowledge.states.state(RuleId(r)).failing_since = knowledge.now;
      knowledge.states.enter(RuleId(r), is_there ? RulePhase::kFailing : RulePhase::kQuiet);
    }
    for (EventWhat& each : what) events.tell(knowledge.now, std::move(each));
    const std::size_t before = events.size();
    incidents.advance(knowledge, {}, events);
    std::vector<EventWhat> told;
    for (std::size_t i = before; i < events.size(); ++i) told.push_back(events[i].what);
    return told;
  }
  std::string id_of(RuleId root) const {
    const auto found = std::ranges::find(incidents.open(), root, &Incident::root);
    return found == incidents.open().end() ? "" : found->id;
  }

  const RuleSet rules = *check(Source("test", kIncidentRules)).rules;
  Knowledge knowledge{rules};
  Incidents incidents{IncidentIds{}};
  const RuleId camera{0};
  const RuleId fusion{1};
};

// The client hangs, too, and its own rule could replace it: a person has to know of the supplier all the same.
TEST(Incidents, NameASupplierThatIsDownAndThatNoRuleRepairs) {
  Told told;
  ComponentState& fusion = told.knowledge.components[ComponentId(1)];
  fusion.in_graph = true;
  fusion.alive = false;
  ComponentState& lamp = told.knowledge.components[ComponentId(2)];
  lamp.process = ProcessState::kGone;
  lamp.alive = false;
  const Candidate waits{StrategyId(1), 0,       Condition::kDependency, ComponentId(2),
                        std::nullopt,  "exited"};
  told.after({told.fusion}, {FailureHeldBack{told.fusion, {waits}}});
  ASSERT_EQ(told.incidents.open().size(), 1u);
  const Incident& incident = told.incidents.open().front();
  EXPECT_EQ(incident.headline, "lamp is down");
  EXPECT_EQ(told.incidents.course_of(incident, told.knowledge, Incidents::Halt::kNone).next,
            "a person must look: no rule of these failures acts on lamp");
}

TEST(Incidents, AreKnownAgainByTheirRoots) {
  Told told;
  const StrategyId redeploy = told.rules[told.camera].strategies[0];
  told.after({told.camera, told.fusion},
             {FailureDetected{told.camera}, FailureDetected{told.fusion},
              StrategyChosen{redeploy, {}, {told.fusion}}});
  const std::string first = told.id_of(told.camera);
  ASSERT_EQ(told.incidents.open().size(), 1u);
  // The consequence turns out to be no consequence.
  told.after({told.camera, told.fusion}, {StrategyChosen{redeploy, {}, {}}});
  ASSERT_EQ(told.incidents.open().size(), 2u);
  EXPECT_EQ(told.id_of(told.camera), first);
  const std::string second = told.id_of(told.fusion);
  // And now it is one again.
  const auto merged =
      told.after({told.camera, told.fusion}, {StrategyChosen{redeploy, {}, {told.fusion}}});
  ASSERT_EQ(told.incidents.open().size(), 1u);
  EXPECT_EQ(told.id_of(told.camera), first);
  const auto& closed = std::get<IncidentClosed>(merged.back());
  EXPECT_EQ(closed.id, second);
  EXPECT_EQ(closed.how, IncidentEnd::kMerged);
  EXPECT_EQ(closed.into, first);
  // Its root goes, what suffered stays: it is not over.
  told.after({told.fusion}, {FailureResolved{told.camera, {}, redeploy}});
  EXPECT_EQ(told.id_of(told.fusion), first);
  const auto over = told.after({}, {FailureLost{told.fusion}});
  ASSERT_EQ(over.size(), 1u);
  EXPECT_EQ(std::get<IncidentClosed>(over[0]).how, IncidentEnd::kLost);
}

TEST(Incidents, SayNothingWhileNothingChanges) {
  Told told;
  EXPECT_EQ(told.after({told.camera}, {FailureDetected{told.camera}}).size(), 1u);
  EXPECT_EQ(told.after({told.camera}, {}).size(), 0u);
}

}  // namespace
}  // namespace culprit
