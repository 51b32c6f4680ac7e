// A topic of several publishers, of which a rule watches one (FROM).
#include <gtest/gtest.h>

#include "manager/manager.h"
#include "manager/test_robot.h"

namespace culprit::test {
namespace {

constexpr const char* kTwoScans =
    "COMPONENT front NODE /front LAUNCH \"front\"\nCOMPONENT rear NODE /rear LAUNCH \"rear\"\n"
    "RULE FrontSilent\n  POLICIES ERROR\n  TRIGGER age(/scan FROM front) > 500ms\n"
    "    STRATEGY front_redeploy 90 10\n      ADAPTATION front redeploy 10\n"
    "RULE RearSlow\n  POLICIES ERROR\n  TRIGGER rate(/scan FROM /rear, 2s) < 5\n"
    "    STRATEGY rear_redeploy 90 10\n      ADAPTATION rear redeploy 10\n";

// /scan FROM front is topic 0, /scan FROM rear topic 1.
class Scans {
 public:
  Scans() : robot(kTwoScans) {
    robot.add("front");
    robot.add("rear");
    robot.discover();
    for (const char* node : {"/front", "/rear"})
      robot.tell(EndpointAppeared{node, EndpointKind::kPublisher, "/scan"});
  }
  void run_for(Duration time, bool front, bool rear) {
    for (Duration passed{}; passed < time; passed += 100ms) {
      if (front) robot.tell(SampleArrived{TopicId(0), 1});
      if (rear) robot.tell(SampleArrived{TopicId(1), 1});
      robot.run_for(100ms);
    }
  }
  TestRobot robot;
};

TEST(FromPublisher, TheSilenceOfOneIsSeenBesideTheOther) {
  Scans scans;
  scans.run_for(8s, true, true);
  EXPECT_EQ(scans.robot.count("detected"), 0u);
  scans.run_for(1s, false, true);
  EXPECT_EQ(scans.robot.count("FrontSilent detected"), 1u);
  EXPECT_EQ(scans.robot.count("front is held responsible"), 1u);
  EXPECT_EQ(scans.robot.count("RearSlow detected"), 0u);
}

TEST(FromPublisher, AComponentKnownDeadIsSilentAtOnce) {
  Scans scans;
  scans.run_for(8s, true, true);
  scans.robot.kill("front");
  scans.run_for(100ms, false, true);
  EXPECT_EQ(scans.robot.count("FrontSilent detected"), 1u);
  EXPECT_EQ(scans.robot.count("front is known to be down"), 1u);
}

TEST(FromPublisher, IsNamedInTheTextOfTheInput) {
  const RuleSet rules = *check(Source("test.rules", kTwoScans)).rules;
  EXPECT_EQ(describe(rules.inputs[0], rules), "age(/scan FROM front)");
  EXPECT_EQ(describe(rules.inputs[1], rules), "rate(/scan FROM rear, 2s)");
}

}  // namespace
}  // namespace culprit::test
