// Several culprits in one domain: who manages what, and what a stranger can bring about.
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <unistd.h>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "exemplars/sunset/node_process.h"
#include "journal/reader.h"
#include "journal/standing_orders.h"
#include "json/json.h"
#include "link/survey.h"
#include "ros2/options.h"
#include "rtps/test_network.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

std::string rules_of(const std::string& robot, const std::string& launch = "sunset-node camera") {
  return "ROBOT " + robot + "\nCOMPONENT camera NODE /managed_subsystem/camera LAUNCH \"" + launch +
         R"("
RULE CameraGone
  POLICIES ERROR
  TRIGGER alive(camera) == false
    STRATEGY camera_redeploy 90 10
      ADAPTATION camera redeploy 5
)";
}

struct Neighbours : testing::Test {
  ~Neighbours() override {
    const std::uint32_t domain = ros2::options_from_environment()->domain;
    for (const int pid : cameras()) kill(pid, SIGKILL);
    for (const int pid : sunset::processes_of(sunset::Member::kDepth, domain)) kill(pid, SIGKILL);
  }
  TestProgram run(const std::string& robot, const std::string& state,
                  std::vector<std::string> more = {}) {
    return run_with(rules_of(robot), robot, state, std::move(more));
  }
  TestProgram run_with(const std::string& rules, const std::string& robot, const std::string& state,
                       std::vector<std::string> more = {}) {
    std::vector<std::string> arguments = {
        "culprit", "run",         world.write(robot + ".rules", rules), "--settle",
        "1",       "--state-dir", (world.folder() / state).string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return TestProgram(world, std::move(arguments));
  }
  std::vector<int> cameras() const {
    return sunset::processes_of(sunset::Member::kCamera, ros2::options_from_environment()->domain);
  }
  std::string key() const {
    const std::string path = world.write("key", "a-key-that-only-friends-have\n");
    std::filesystem::permissions(path, std::filesystem::perms::owner_read);
    return path;
  }

  TestWorld world;
};

TEST_F(Neighbours, OfOneMachineTakeOverAtOnceWhenTheManagerIsKilled) {
  TestProgram camera(world, {"sunset-node", "camera"});
  TestProgram first = run("robot", "state");
  ASSERT_TRUE(first.prints("camera is there")) << first.output();
  TestProgram second = run("robot", "state");
  ASSERT_TRUE(second.prints("another culprit manages this robot (process " +
                            std::to_string(first.pid()) + ")"))
      << second.output();
  ASSERT_TRUE(second.prints("camera is there")) << second.output();
  std::this_thread::sleep_for(5s);  // as long as an elder on another machine is looked for
  first.signal(SIGKILL);
  ASSERT_EQ(first.wait(), -SIGKILL);
  // Far below the 20 s of a lease.
  ASSERT_TRUE(second.prints("this one manages the robot from now on", 10s)) << second.output();
  camera.signal(SIGKILL);
  camera.wait();
  EXPECT_TRUE(second.prints("redeploy camera: done")) << second.output();
}

// The processes are those of the other one, which goes on.
TEST_F(Neighbours, ThatOnlyAdviseNameNoProcessOfTheManagerAtTheirEnd) {
  TestProgram first = run("robot", "one", {"--launch"});
  ASSERT_TRUE(first.prints("camera is there")) << first.output();
  TestProgram second = run("robot", "two");
  ASSERT_TRUE(second.prints("another culprit manages this robot")) << second.output();
  ASSERT_TRUE(second.prints("camera is there")) << second.output();
  second.signal(SIGINT);
  EXPECT_EQ(second.wait(), 0);
  EXPECT_THAT(second.output(), Not(HasSubstr("run on")));
  first.signal(SIGINT);
  EXPECT_EQ(first.wait(), 0);
  EXPECT_THAT(first.output(), HasSubstr("these processes that culprit started run on"));
}

// Each has a journal of its own.
TEST_F(Neighbours, DoNotGoOnWithWhatWasUnderWayBeforeAnotherOneManaged) {
  const std::string rules = rules_of("robot", "sleep 20");  // a start that takes long
  TestProgram camera(world, {"sunset-node", "camera"});
  TestProgram first = run_with(rules, "robot", "one");
  ASSERT_TRUE(first.prints("camera is there")) << first.output();
  camera.signal(SIGKILL);
  camera.wait();
  ASSERT_TRUE(first.prints("camera is held responsible for CameraGone")) << first.output();
  TestProgram second = run_with(rules, "robot", "two");
  ASSERT_TRUE(second.prints("another culprit manages this robot")) << second.output();
  first.signal(SIGKILL);
  ASSERT_EQ(first.wait(), -SIGKILL);
  ASSERT_TRUE(second.prints("this one manages the robot from now on")) << second.output();
  TestProgram again = run_with(rules, "robot", "one");
  ASSERT_TRUE(again.prints("another culprit manages this robot")) << again.output();
  second.signal(SIGKILL);
  ASSERT_EQ(second.wait(), -SIGKILL);
  ASSERT_TRUE(again.prints("this one manages the robot from now on")) << again.output();
  EXPECT_TRUE(again.prints("camera_redeploy for CameraGone: another culprit has managed the robot "
                           "since, so it is not continued") ||
              again.prints("camera_redeploy for CameraGone: that was more than 1min ago", 1s))
      << again.output();
}

TEST_F(Neighbours, OfTwoRobotNamesDoNotManageTheSameNode) {
  TestProgram camera(world, {"sunset-node", "camera"});
  TestProgram first = run("one", "one");
  ASSERT_TRUE(first.prints("camera is there")) << first.output();
  TestProgram second = run("two", "two");
  ASSERT_TRUE(
      second.prints("it manages /managed_subsystem/camera: process " + std::to_string(first.pid())))
      << second.output();
  ASSERT_TRUE(second.prints("camera is there")) << second.output();
  camera.signal(SIGKILL);
  camera.wait();
  EXPECT_TRUE(second.prints("is held back: camera is muted by another culprit")) << second.output();
  ASSERT_TRUE(first.prints("CameraGone resolved by camera_redeploy")) << first.output();
  EXPECT_EQ(cameras().size(), 1u);
  EXPECT_THAT(second.output(), Not(HasSubstr("redeploy camera")));
  first.signal(SIGKILL);
  ASSERT_EQ(first.wait(), -SIGKILL);
  ASSERT_TRUE(second.prints("camera is unmuted")) << second.output();
}

// As `respawn` in a launch file brings it about.
TEST_F(Neighbours, ProcessesWithNodesOfOneNameAreNamedAsLongAsTheyAreThere) {
  const TestProgram one(world, {"sunset-node", "camera"});
  const TestProgram two(world, {"sunset-node", "camera"});
  TestProgram culprit = run("robot", "state");
  ASSERT_TRUE(culprit.prints("several nodes have the name /managed_subsystem/camera: "))
      << culprit.output();
  const std::string parent = "sunset-node camera), started by process " + std::to_string(getpid());
  EXPECT_THAT(culprit.output(), HasSubstr(parent));
  EXPECT_THAT(culprit.output(), HasSubstr("process " + std::to_string(one.pid()) + " ("));
  EXPECT_THAT(culprit.output(), HasSubstr("process " + std::to_string(two.pid()) + " ("));
  EXPECT_THAT(culprit.output(), HasSubstr("set respawn to False"));
  // For who comes late.
  link::Survey::Options options;
  options.participant = *ros2::options_from_environment();
  const auto survey = link::Survey::open(std::move(options));
  ASSERT_TRUE(survey) << survey.error();
  const auto is_said = [&] {
    for (const auto& status : (*survey)->inventory().diagnostics) {
      if (status.name == "culprit: /managed_subsystem/camera") return status.level == 1;
    }
    return false;
  };
  for (const Time end = live_now() + TestProgram::kPatience; !is_said() && live_now() < end;)
    std::this_thread::sleep_for(20ms);
  EXPECT_TRUE(is_said());
}

TEST_F(Neighbours, OfTwoMachinesAgreeWhereTheyShareAKey) {
  auto network = TestNetwork::create();
  if (!network) GTEST_SKIP() << network.error();
  setenv("ROS_LOCALHOST_ONLY", "0", 1);
  const std::string secret = key();
  std::optional<TestProgram> first, second, third;
  {
    const TestNetwork::Visit visit(**network, TestNetwork::kRobot);
    first.emplace(world, std::vector<std::string>{"culprit", "run",
                                                  world.write("robot.rules", rules_of("robot")),
                                                  "--no-journal", "--lease-key", secret});
    ASSERT_TRUE(first->prints("watching robot")) << first->output();
  }
  {
    const TestNetwork::Visit visit(**network, TestNetwork::kDesk);
    second.emplace(world, std::vector<std::string>{"culprit", "run",
                                                   world.write("robot.rules", rules_of("robot")),
                                                   "--no-journal", "--lease-key", secret});
    third.emplace(world, std::vector<std::string>{"culprit", "run",
                                                  world.write("other.rules", rules_of("other")),
                                                  "--no-journal"});
  }
  EXPECT_TRUE(second->prints("another culprit manages this robot, on ")) << second->output();
  EXPECT_TRUE(third->prints("claims to manage this robot or a node of it")) << third->output();
  EXPECT_THAT(first->output(), Not(HasSubstr("another culprit manages")));
  first->signal(SIGINT);
  EXPECT_EQ(first->wait(), 0);
  EXPECT_TRUE(second->prints("this one manages the robot from now on")) << second->output();
}

// Orders for who comes next, as a person gave them to the first run on that machine.
void pause_at(const std::filesystem::path& state) {
  std::filesystem::create_directories(state);
  journal::StandingOrders orders;
  orders.pause = journal::StandingOrders::Said{"ann", "hands in the machine"};
  orders.revision = 1;
  const auto written = journal::write_orders(journal::orders_beside(state / "robot.journal"),
                                             orders, journal::clocks_now(live_now()));
  ASSERT_TRUE(written) << written.error();
}

struct TwoMachines : Neighbours {
  void SetUp() override {
    auto made = TestNetwork::create();
    if (!made) GTEST_SKIP() << made.error();
    network = std::move(*made);
    setenv("ROS_LOCALHOST_ONLY", "0", 1);
  }
  TestProgram run_on(TestNetwork::Computer computer, const std::string& state) {
    const TestNetwork::Visit visit(*network, computer);
    if (secret.empty()) secret = key();
    return run_with(rules, "robot", state, {"--lease-key", secret});
  }
  // Both run, and the first manages.
  void begin() {
    first.reset(new TestProgram(run_on(TestNetwork::kRobot, "first")));
    ASSERT_TRUE(first->prints("watching robot")) << first->output();
    second.reset(new TestProgram(run_on(TestNetwork::kDesk, "second")));
    ASSERT_TRUE(second->prints("another culprit manages this robot, on ")) << second->output();
    std::this_thread::sleep_for(5s);  // as long as an elder is looked for
  }

  // The node's location according to `culprit graph` on the second computer: its "pid" there, or its "host".
  std::string place_on_desk(const std::string& node) {
    const TestNetwork::Visit visit(*network, TestNetwork::kDesk);
    TestProgram graph(world, {"culprit", "graph", "--json"});
    EXPECT_EQ(graph.wait(), 0) << graph.output();
    const std::string said =
        graph.output();  // what it could not see of other computers stands first
    const auto json = parse_json(said.substr(std::min(said.find('{'), said.size())));
    for (const auto& each : json.is_object() ? json.value("nodes", Json::array()) : Json()) {
      if (each.value("name", "") != node) continue;
      EXPECT_NE(each.contains("pid"), each.contains("host")) << each;
      return each.contains("pid") ? "pid" : "host";
    }
    return "it is not there: " + said;
  }

  std::string rules = rules_of("robot");
  std::string secret;
  std::unique_ptr<TestNetwork> network;
  std::unique_ptr<TestProgram> first, second;
};

TEST_F(TwoMachines, TakeOverFromOneThatIsKilledAndArePausedAsItWas) {
  pause_at(world.folder() / "first");
  begin();
  const Time killed = live_now();
  first->signal(SIGKILL);
  ASSERT_EQ(first->wait(), -SIGKILL);
  // Far below the 20 s of a participant's lease.
  ASSERT_TRUE(second->prints("this one manages the robot from now on", 6s)) << second->output();
  std::cout << "taken over after " << seconds(live_now() - killed) << " s\n";
  EXPECT_THAT(second->output(), HasSubstr("was paused by ann: hands in the machine"));
  const auto kept =
      journal::read_orders(journal::orders_beside(world.folder() / "second" / "robot.journal"),
                           journal::clocks_now(live_now()));
  ASSERT_TRUE(kept && *kept && (*kept)->pause);
  EXPECT_EQ((*kept)->pause->author, "ann");
}

// Rows of the journal of a robot's culprit, in order.
std::vector<journal::Entry> rows_of(const std::filesystem::path& state) {
  std::vector<journal::Entry> all;
  const auto journal = journal::Reader::open(state / "robot.journal");
  if (!journal) return all;
  auto rows = journal->entries(journal::Which::kReadable);
  journal::Entry entry;
  while (rows) {
    const auto more = rows->next(entry);
    if (!more || !*more) break;
    all.push_back(entry);
  }
  return all;
}

// From the death of the manager to the first request of the other one, the promise is 3 s. A machine
// that is busy with other things may take twice as long.
TEST_F(TwoMachines, TakeOverAndHealWithinThreeSecondsWhatDiedWithTheManager) {
  constexpr Duration kPromise = 3s;
  constexpr int kBusy = 2;
  TestProgram camera = [&] {
    const TestNetwork::Visit visit(*network, TestNetwork::kDesk);
    return TestProgram(world, {"sunset-node", "camera"});
  }();
  begin();
  ASSERT_TRUE(second->prints("camera is there")) << second->output();
  const std::int64_t killed = wall_now();
  first->signal(SIGKILL);
  camera.signal(SIGKILL);
  ASSERT_EQ(first->wait(), -SIGKILL);
  camera.wait();
  ASSERT_TRUE(second->prints("CameraGone resolved by camera_redeploy")) << second->output();
  second->signal(SIGINT);
  ASSERT_EQ(second->wait(), 0);
  std::optional<std::int64_t> asked;
  for (const journal::Entry& row : rows_of(world.folder() / "second")) {
    if (row.kind == journal::kind::kIntent && !asked) asked = row.at;
  }
  ASSERT_TRUE(asked) << second->output();
  const Duration took(*asked - killed);
  std::cout << "first request " << seconds(took) << " s after the death of the manager\n";
  EXPECT_LE(took, kBusy * kPromise);
  // Its decisions can be replayed.
  TestProgram replay(world,
                     {"culprit", "replay", (world.folder() / "second" / "robot.journal").string()});
  EXPECT_EQ(replay.wait(), 0) << replay.output();
}

TEST_F(TwoMachines, GoOnWithWhatTheOtherOneHadTriedAndLearned) {
  TestProgram camera = [&] {
    const TestNetwork::Visit visit(*network, TestNetwork::kRobot);
    return TestProgram(world, {"sunset-node", "camera"});
  }();
  rules = R"(ROBOT robot
COMPONENT camera NODE /managed_subsystem/camera LAUNCH "false"
RULE CameraGone
  POLICIES ERROR ATTEMPTS 1
  TRIGGER alive(camera) == false
    STRATEGY camera_redeploy 90 10
      ADAPTATION camera redeploy 5
)";
  begin();
  ASSERT_TRUE(first->prints("camera is there")) << first->output();
  camera.signal(SIGKILL);
  camera.wait();
  ASSERT_TRUE(first->prints("CameraGone is exhausted")) << first->output();
  std::this_thread::sleep_for(2s);  // for what is told with the lease
  first->signal(SIGKILL);
  ASSERT_EQ(first->wait(), -SIGKILL);
  ASSERT_TRUE(second->prints("this one manages the robot from now on")) << second->output();
  EXPECT_THAT(second->output(), HasSubstr("takes over the beliefs in 1 strategy, and the attempts, "
                                          "of the culprit that managed before"));
  // It cannot be healed here either: a culprit without that knowledge would try it.
  EXPECT_TRUE(second->prints("CameraGone is exhausted")) << second->output();
  std::this_thread::sleep_for(3s);
  second->signal(SIGINT);
  ASSERT_EQ(second->wait(), 0);
  for (const journal::Entry& row : rows_of(world.folder() / "second"))
    EXPECT_NE(row.kind, journal::kind::kIntent) << row.body;
}

// Each side has a component that the other one's rules name, too.
TEST_F(TwoMachines, LookAfterTheirOwnSideOfACutAndStartNothingTwice) {
  const auto run_node = [&](TestNetwork::Computer computer, const char* node) {
    const TestNetwork::Visit visit(*network, computer);
    return std::make_unique<TestProgram>(world, std::vector<std::string>{"sunset-node", node});
  };
  const auto count = [](sunset::Member member) {
    return sunset::processes_of(member, ros2::options_from_environment()->domain).size();
  };
  const auto camera = run_node(TestNetwork::kRobot, "camera");
  const auto depth = run_node(TestNetwork::kDesk, "depth");
  // One failed strategy would exhaust them.
  rules = "ROBOT robot\n" + replaced_when_gone("camera", "ERROR ATTEMPTS 1") +
          replaced_when_gone("depth", "ERROR ATTEMPTS 1");
  begin();
  for (TestProgram* each : {first.get(), second.get()}) {
    ASSERT_TRUE(each->prints("camera is there")) << each->output();
    ASSERT_TRUE(each->prints("depth is there")) << each->output();
  }
  EXPECT_EQ(place_on_desk("/managed_subsystem/camera"), "host");
  EXPECT_EQ(place_on_desk("/managed_subsystem/depth"), "pid");
  network->set({.is_cut = true});
  ASSERT_TRUE(second->prints("this one manages the robot from now on")) << second->output();
  ASSERT_TRUE(second->prints(" ran, is unreachable")) << second->output();
  ASSERT_TRUE(first->prints(" ran, is unreachable")) << first->output();
  ASSERT_TRUE(second->prints("CameraGone waits: camera is on ")) << second->output();
  ASSERT_TRUE(first->prints("DepthGone waits: depth is on ")) << first->output();
  // Each node leaves the other side's graph after 20 s, and would be started there.
  std::this_thread::sleep_for(25s);
  for (TestProgram* each : {first.get(), second.get()}) {
    EXPECT_THAT(each->output(), Not(HasSubstr("did not resolve")));
    EXPECT_THAT(each->output(), Not(HasSubstr("is exhausted")));
    EXPECT_THAT(each->output(), Not(HasSubstr("held responsible")));
  }
  EXPECT_EQ(count(sunset::Member::kCamera), 1u) << second->output();
  EXPECT_EQ(count(sunset::Member::kDepth), 1u) << first->output();
  // Failures on the robot's own side are healed meanwhile.
  camera->signal(SIGKILL);
  camera->wait();
  depth->signal(SIGKILL);
  depth->wait();
  ASSERT_TRUE(first->prints("CameraGone resolved by camera_redeploy")) << first->output();
  ASSERT_TRUE(second->prints("DepthGone resolved by depth_redeploy")) << second->output();
  EXPECT_EQ(count(sunset::Member::kCamera), 1u) << second->output();
  EXPECT_EQ(count(sunset::Member::kDepth), 1u) << first->output();
  network->set({});
  ASSERT_TRUE(first->prints("another culprit manages this robot, on ", 60s)) << first->output();
  ASSERT_TRUE(second->prints("is reachable again")) << second->output();
  ASSERT_TRUE(second->prints("CameraGone cleared")) << second->output();
  std::this_thread::sleep_for(5s);
  const std::string since = second->output().substr(second->output().find("from now on"));
  EXPECT_THAT(since, Not(HasSubstr("another culprit manages this robot")));
  EXPECT_EQ(count(sunset::Member::kCamera), 1u) << second->output();
  EXPECT_EQ(count(sunset::Member::kDepth), 1u) << first->output();
}

TEST_F(TwoMachines, StepBackAndDoNothingWhenTheyWereOnlySlow) {
  TestProgram camera = [&] {
    const TestNetwork::Visit visit(*network, TestNetwork::kRobot);
    return TestProgram(world, {"sunset-node", "camera"});
  }();
  begin();
  ASSERT_TRUE(first->prints("camera is there")) << first->output();
  first->signal(SIGSTOP);
  ASSERT_TRUE(second->prints("this one manages the robot from now on", 12s)) << second->output();
  camera.signal(SIGKILL);
  camera.wait();
  std::this_thread::sleep_for(1s);
  first->signal(SIGCONT);
  ASSERT_TRUE(first->prints("another culprit manages this robot, on ")) << first->output();
  EXPECT_THAT(first->output(), HasSubstr("did not run for so long"));
  EXPECT_THAT(first->output(), Not(HasSubstr("decided"))) << second->output();
  std::this_thread::sleep_for(3s);
  const std::string since = second->output().substr(second->output().find("from now on"));
  EXPECT_THAT(since, Not(HasSubstr("another culprit manages this robot")));
  EXPECT_LE(cameras().size(), 1u);
}

}  // namespace
}  // namespace culprit::cli
