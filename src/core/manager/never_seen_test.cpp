// Absent is not dead: culprit does nothing about components and topics that were never seen.
#include <gtest/gtest.h>

#include "manager/test_robot.h"

namespace culprit::test {
namespace {

std::string camera_rules(const std::string& trigger, const std::string& remedy = "redeploy") {
  return "COMPONENT camera NODE /front/camera LAUNCH \"camera\"\n"
         "RULE Dead\n  POLICIES ERROR\n  TRIGGER " +
         trigger + "\n    STRATEGY s 90 10\n      ADAPTATION camera " + remedy + " 2\n";
}

// A node that publishes, and is well.
void show_camera(TestRobot& robot) {
  robot.add("camera");
  robot.tell(NodeAppeared{"/front/camera", 7});
  robot.tell(EndpointAppeared{"/front/camera", EndpointKind::kPublisher, "/front/rgb_camera"});
}

TEST(NeverSeen, ATypingMistakeInATopicEndsNobody) {
  for (const char* trigger : {"age(/front/rgb_camra) > 500ms", "rate(/front/rgb_camra) < 1",
                              "!(rate(/front/rgb_camra) > 1)"}) {
    TestRobot robot(camera_rules(trigger));
    show_camera(robot);
    robot.run_for(60s);
    EXPECT_TRUE(robot.asked.empty()) << trigger;
    EXPECT_EQ(robot.count("/front/rgb_camra was never seen: no node publishes it; did you mean "
                          "'/front/rgb_camera'?"),
              1u);
  }
}

TEST(NeverSeen, ATypingMistakeInANodeStartsNoSecondOne) {
  TestRobot robot(
      "COMPONENT camera NODE /front/camra LAUNCH \"camera\"\n"
      "RULE Dead\n  POLICIES ERROR\n  TRIGGER !alive(camera) || age(/front/rgb_camera) > 500ms\n"
      "    STRATEGY s 90 10\n      ADAPTATION camera redeploy 2\n");
  show_camera(robot);
  robot.run_for(60s);
  EXPECT_TRUE(robot.asked.empty());
  EXPECT_EQ(robot.count("camera was never seen: the robot has no node /front/camra; did you mean "
                        "'/front/camera'?"),
            1u);
  EXPECT_EQ(robot.count("Dead.s is held back: camera was never seen"), 1u);
}

// Its owner's word is proof.
TEST(NeverSeen, AUnitThatFailedIsStartedThoughItsNodeWasNeverThere) {
  TestRobot robot(
      "COMPONENT camera NODE /camera UNIT camera.service\n"
      "RULE Dead\n  POLICIES ERROR\n  TRIGGER !alive(camera)\n"
      "    STRATEGY s 90 10\n      ADAPTATION camera redeploy 2\n");
  robot.add("camera").process = ProcessState::kGone;
  robot.tell(ProcessSeen{ComponentId(0), ProcessState::kGone, 7, "camera.service failed"}, 60s);
  EXPECT_EQ(robot.count("camera is lost"), 1u);
  EXPECT_EQ(robot.count("camera is there"), 1u);
}

// A unit that could not even begin has no process. A person may run its node by hand, though.
TEST(NeverSeen, AUnitThatNeverHadAProcessIsStartedUnlessItsNodeIsThere) {
  for (const bool is_there : {false, true}) {
    TestRobot robot(
        "COMPONENT camera NODE /camera UNIT camera.service\n"
        "RULE Dead\n  POLICIES ERROR\n  TRIGGER !alive(camera)\n"
        "    STRATEGY s 90 10\n      ADAPTATION camera redeploy 2\n");
    auto& camera = robot.add("camera");
    if (!is_there) camera.process = ProcessState::kGone;
    robot.tell(ProcessSeen{ComponentId(0), ProcessState::kGone, 0, "camera.service failed"});
    if (is_there) robot.discover();
    robot.tell(ProcessSeen{ComponentId(0), ProcessState::kGone, 0, "camera.service failed"}, 60s);
    EXPECT_EQ(robot.count("camera is lost"), is_there ? 0u : 1u);
    EXPECT_EQ(robot.count("camera is there"), 1u);
    EXPECT_EQ(robot.asked.empty(), is_there);
  }
}

// The right name of a status, a key or a parameter is known only if the robot was heard.
TEST(NeverSeen, ATypingMistakeInADiagnosticOrAParameterIsTold) {
  TestRobot robot(
      "COMPONENT camera NODE /front/camera LAUNCH \"camera\"\n"
      "SIGNAL hot DIAGNOSTIC moter KEY temperature\n"
      "SIGNAL slow DIAGNOSTIC motor KEY sped\n"
      "SIGNAL dark PARAMETER camera exposur\n"
      "RULE R\n  POLICIES ERROR\n  TRIGGER hot > 1 || slow > 1 || dark > 1 || curent > 1 || "
      "level(lense) > 1 || parameter(camera, gian) > 1 || parameter(camera, names) > 1\n"
      "    STRATEGY s 90 10\n      ADAPTATION camera redeploy 2\n");
  show_camera(robot);
  robot.tell(StatusHeard{"motor", "m1", {"temperature", "speed", "current"}});
  robot.tell(StatusHeard{"front", "lens", {"blur"}});
  robot.tell(ParametersListed{ComponentId(0), {"exposure", "gain", "names"}}, 60s);
  for (const char* line :
       {"signal hot was never seen: no message carries the key 'temperature' of status 'moter'; "
        "did you "
        "mean 'motor'?",
        "signal slow was never seen: no message carries the key 'sped' of status 'motor'; did you "
        "mean "
        "'speed'?",
        "signal dark was never seen: no message carries it; did you mean 'exposure'?",
        "signal curent was never seen: no message carries it; did you mean 'current'?",
        "diagnostic lense was never seen: no node publishes it; did you mean 'lens'?",
        "parameter gian of camera was never seen: no value was read; did you mean 'gain'?",
        "parameter names of camera was never seen: no value was read. Rules"})
    EXPECT_EQ(robot.count(line), 1u) << line;
}

// As with a wrong ROS_DOMAIN_ID.
TEST(NeverSeen, OnAnEmptyRobotNothingIsStarted) {
  TestRobot robot(
      camera_rules("!alive(camera) || age(/front/rgb) > 1s || level(lens) > 1 || "
                   "blur > 1 || lifecycle(camera) != \"active\"",
                   "start"));
  robot.run_for(4s);
  EXPECT_TRUE(robot.said.empty()) << "discovery may still be under way";
  robot.run_for(60s);
  EXPECT_TRUE(robot.asked.empty());
  EXPECT_EQ(robot.count("was never seen"), 5u);
  EXPECT_EQ(robot.count("Dead is blind: camera was never seen"), 1u);
  robot.order({1, "Ann", "", RunStrategy{StrategyId(0)}});
  EXPECT_TRUE(robot.was_asked("camera: start process")) << "a person may ask for it";
}

TEST(NeverSeen, ANodeThatComesLateIsNotStartedASecondTime) {
  TestRobot robot(camera_rules("!alive(camera) || age(/front/rgb_camera) > 500ms"));
  robot.run_for(6s);
  show_camera(robot);
  robot.run_for(4s);  // to open its device
  for (int i = 0; i < 100; ++i) {
    robot.tell(SampleArrived{TopicId(0), 1}, 100ms);
  }
  EXPECT_TRUE(robot.asked.empty());
  robot.run_for(1s);
  EXPECT_TRUE(robot.was_asked("camera: stop process")) << "now it is silent";
}

TEST(NeverSeen, APublisherThatComesLateAndNeverSpeaksIsSilent) {
  TestRobot robot(camera_rules("age(/front/rgb_camera) > 500ms"));
  robot.run_for(6s);
  show_camera(robot);
  robot.run_for(4s);
  EXPECT_TRUE(robot.asked.empty());
  robot.run_for(2s);
  EXPECT_TRUE(robot.was_asked("camera: stop process"));
}

TEST(NeverSeen, ARequiredComponentIsToldAndNothingElse) {
  TestRobot robot("COMPONENT lidar NODE /lidar LAUNCH \"lidar\" REQUIRED\n");
  robot.run_for(60s);
  EXPECT_TRUE(robot.asked.empty());
  EXPECT_EQ(robot.count("lidar is REQUIRED and was never seen: the robot has no node /lidar"), 1u);
  const auto& components = robot.manager().knowledge().components;
  EXPECT_TRUE(components[ComponentId(0)].is_missed);
  robot.tell(NodeAppeared{"/lidar", 7});
  EXPECT_FALSE(components[ComponentId(0)].is_missed) << "a person is told no longer";
}

TEST(NeverSeen, AFailureThatNeedsNoMoreThanWhatIsSeenIsActedOn) {
  TestRobot robot(camera_rules("age(/front/rgb_camra) > 500ms || blur > 1"));
  show_camera(robot);
  robot.signal("blur", Value(2.0), 2s);
  EXPECT_TRUE(robot.was_asked("camera: stop process"));
}

// Five cameras, or a camera and four that each need the one before.
struct Five {
  explicit Five(bool is_chain) : robot(rules(), std::make_unique<BayesPlanner>(), options()) {
    std::string last;
    for (const char* c : {"a", "b", "c", "d", "e"}) {
      const std::string name = c;
      robot.add(name, is_chain && !last.empty() ? std::vector{last} : std::vector<std::string>{},
                "/t" + name);
      last = name;
    }
    robot.discover(2s);
  }

  static std::string rules() {
    std::string text;
    for (const char* c : {"a", "b", "c", "d", "e"}) {
      const std::string name = c;
      text += "COMPONENT " + name + " NODE /" + name + " LAUNCH \"x\"\nRULE Dead_" + name +
              "\nPOLICIES ERROR\nTRIGGER age(/t" + name +
              ") > 300ms\nSTRATEGY redeploy 90 10\nADAPTATION " + name + " redeploy 2\n";
    }
    return text;
  }
  static Manager::Options options(Time start = {}) {
    Manager::Options options;
    options.governor.storm.share = 0.6;
    options.start = start;
    return options;
  }

  // culprit and these die together; then another culprit begins.
  void kill_with_culprit(const std::vector<const char*>& names) {
    const KnownRobot known = robot.manager().knowledge().known_robot();
    for (const char* name : names) robot[name].process = ProcessState::kGone;
    auto manager = std::make_unique<Manager>(robot.rules(), std::make_unique<BayesPlanner>(),
                                             options(robot.now));
    manager->remember(known);
    robot.replace_manager(std::move(manager));
    for (const char* name : names) {
      const ComponentId id(static_cast<std::size_t>(*name - 'a'));
      robot.tell(ProcessSeen{id, ProcessState::kGone, robot[name].pid, "it ended"});
    }
  }

  TestRobot robot;
};

TEST(KnownRobot, WhatDiedWithCulpritIsBroughtBack) {
  Five five(false);
  five.kill_with_culprit({"a", "b", "c", "d"});
  five.robot.run_for(20s);
  EXPECT_EQ(five.robot.count("a person must look"), 0u);
  EXPECT_EQ(five.robot.count("a is lost: it ended"), 1u);
  for (const char* c : {"a", "b", "c", "d", "e"}) EXPECT_TRUE(five.robot.works(c)) << c;
}

TEST(KnownRobot, ReportsConsumersOfAComponentThatDiedWithCulprit) {
  Five five(true);
  five.kill_with_culprit({"a", "b", "c"});
  five.robot.run_for(20s);
  for (const char* c : {"a", "b", "c", "d", "e"}) EXPECT_TRUE(five.robot.works(c)) << c;
  EXPECT_FALSE(five.robot.was_asked("d: "));
  EXPECT_FALSE(five.robot.was_asked("e: "));
}

TEST(KnownRobot, IsNotSeenUnderAnotherNode) {
  TestRobot robot(camera_rules("!alive(camera)"));
  robot.manager().remember(KnownRobot{{{"camera", "/camera", {}}}, {}});
  robot.run_for(60s);
  EXPECT_TRUE(robot.asked.empty());
}

TEST(Storm, ProcessesThatAreKnownToBeDeadAreNone) {
  Five five(false);
  for (const char* c : {"a", "b", "c", "d"}) five.robot.kill(c);
  five.robot.run_for(20s);
  EXPECT_EQ(five.robot.count("a person must look"), 0u);
  for (const char* c : {"a", "b", "c", "d", "e"}) EXPECT_TRUE(five.robot.works(c)) << c;
}

// c0 dies before its first message, so its silence can be judged only once the robot had time to
// show itself. It is known to be dead, and c1 is not replaced for it meanwhile.
TEST(NeverSeen, AnEarlyExitIsNotBlamedOnItsEffects) {
  TestRobot robot(
      "COMPONENT c0 NODE /c0 LAUNCH \"c0\"\nCOMPONENT c1 NODE /c1 LAUNCH \"c1\"\n"
      "RULE Silent0\nPOLICIES ERROR\nTRIGGER age(/c0) > 2500ms\nSTRATEGY redeploy 90 10\n"
      "ADAPTATION c0 redeploy 10\n"
      "RULE Silent1\nPOLICIES ERROR\nTRIGGER age(/c1) > 350ms\nSTRATEGY restart 50 10\n"
      "ADAPTATION c1 restart 3\nSTRATEGY redeploy 90 10\nADAPTATION c1 redeploy 10\n");
  robot.add("c0", {}, "/c0", 1s);
  robot.add("c1", {"c0"}, "/c1");
  robot.discover(500ms);
  robot.kill("c0", 20s);
  EXPECT_TRUE(robot.works("c1"));
  EXPECT_EQ(robot.count_asked("c0: start process"), 1u);
  EXPECT_FALSE(robot.was_asked("c1:"));
}

}  // namespace
}  // namespace culprit::test
