// How nodes end, as the operating system tells it: one that was killed is not waited for, and a
// launch that somebody ends is not started again.
#include <csignal>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/environment.h"
#include "base/live_clock.h"
#include "owners/proc.h"
#include "ros2/options.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

struct Ends : testing::Test {
  TestProgram run(const std::string& rules) {
    return TestProgram(world,
                       {"culprit", "run", world.write("ends.rules", rules), "--state-dir",
                        (world.folder() / "state").string(), "--quiet", "0", "--settle", "0.5"});
  }
  std::string node(const std::string& name) const {
    return (own_folder() / "ros2_peer_node").string() + " " + domain + " /" + name;
  }
  std::string rule(const std::string& name, const std::string& trigger) const {
    return "COMPONENT " + name + " NODE /" + name + " LAUNCH \"" + node(name) + "\"\nRULE " + name +
           "_silent\n  POLICIES ERROR\n  TRIGGER " + trigger + "\n    STRATEGY " + name +
           "_redeploy 90 10\n      ADAPTATION " + name + " redeploy 5\n";
  }

  TestWorld world;
  const std::string domain = std::to_string(ros2::options_from_environment()->domain);
};

// Its rule would wait for minutes. The node is the test's, and the one after it culprit's own.
TEST_F(Ends, AKilledNodeIsReplacedBeforeItsSilenceIsHeard) {
  const TestProgram lidar(world, {"ros2_peer_node", domain, "/lidar"});
  const auto culprit = run(rule("lidar", "age(/lidar/value) > 5min") +
                           "RULE lidar_inactive\n  POLICIES WARNING\n  TRIGGER lifecycle(lidar) == "
                           "\"unconfigured\"\n    STRATEGY bring_up 90 10\n      ADAPTATION lidar "
                           "activate 5\n");
  int killed = lidar.pid();
  for (const char* whose : {"of the test", "of culprit"}) {
    ASSERT_TRUE(culprit.prints("lidar is there (process " + std::to_string(killed) + ")"))
        << whose << culprit.output();
    ASSERT_TRUE(culprit.prints("watching")) << culprit.output();
    std::this_thread::sleep_for(2500ms);  // it speaks, and the quiet time after its start is over
    kill(killed, SIGKILL);
    const int before = killed;
    for (const Time end = later(live_now(), TestProgram::kPatience); live_now() < end;) {
      killed = pid_in(culprit.output(), "lidar");
      if (killed != before) break;
      std::this_thread::sleep_for(20ms);
    }
    ASSERT_NE(killed, before) << whose << culprit.output();
  }
  EXPECT_THAT(culprit.output(), HasSubstr("lidar is known dead, killed by signal 9"));
  kill(killed, SIGKILL);
}

// As Ctrl-C on a launch file: all are asked to end at once, and end one after the other.
TEST_F(Ends, ALaunchOfFiveThatSomebodyEndsIsNotStartedAgain) {
  std::string rules;
  std::string launch;
  for (const char* name : {"a", "b", "c", "d", "e"}) {
    rules += rule(name, std::string("alive(") + name + ") == false");
    launch += node(name) + " & all=\"$all $!\"; ";
  }
  TestProgram launcher(world, {"sh", "-c",
                               launch + "trap 'for p in $all; do kill $p; sleep 0.2; done; wait; "
                                        "exit' TERM; while :; do sleep 0.1; done"});
  const auto culprit = run(rules);
  for (const char* name : {"a", "b", "c", "d", "e"})
    ASSERT_TRUE(culprit.prints(std::string(name) + " is there (process ")) << culprit.output();
  ASSERT_TRUE(culprit.prints("watching")) << culprit.output();
  std::this_thread::sleep_for(1s);
  launcher.signal(SIGTERM);
  for (const char* name : {"a", "b", "c", "d", "e"})
    EXPECT_TRUE(culprit.prints(std::string(name) +
                               "_redeploy is held back: somebody ended process " +
                               std::to_string(launcher.pid())))
        << culprit.output();
  std::this_thread::sleep_for(2s);  // that nothing happens takes time
  EXPECT_THAT(culprit.output(), Not(HasSubstr("is held responsible")));
}

}  // namespace
}  // namespace culprit::cli
