// The first steps of a new user: `init`, `check`, `run`, and then nodes are killed. Each comes back, by the unchanged draft, and no healthy node is restarted.
//
// Three robots: SUNSET, SUAVE, and one of ten nodes that no rule file has ever named: two that a launcher starts
// again, four that a launcher took through their lifecycle, four that activate themselves; all have a topic of a
// type that culprit is not told. With CULPRIT_EACH_NODE (scripts/first-hour) each node of each is killed in turn;
// without, a few of the first and the last. And `doctor` finds nothing wrong with them: for an hour, with
// CULPRIT_HEALTHY_SECONDS=3600 (scripts/healthy).
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <optional>
#include <regex>
#include <sstream>
#include <thread>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/environment.h"
#include "base/live_clock.h"
#include "base/text_file.h"
#include "demo/test_live_sunset.h"
#include "json/json.h"
#include "ros2/options.h"
#include "ros2/test_change_state.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;

using Programs = std::vector<std::unique_ptr<TestProgram>>;

// How many nodes of each kind.
struct Scratch {
  int launched = 0;
  int self_made = 0;
  int respawned = 0;
};

void start_suave(const TestWorld& world, Programs& programs) {
  for (const char* name : {"vehicle", "search", "follow", "motion", "recharge", "mission"})
    programs.push_back(
        std::make_unique<TestProgram>(world, std::vector<std::string>{"suave-node", name}));
  programs.push_back(std::make_unique<TestProgram>(
      world, std::vector<std::string>{"culprit", "modes", "rules/suave-modes.yaml"}));
}

// As a lifecycle manager does it, once.
void bring_up(const std::string& node) {
  ros2::LiveContext context(*ros2::options_from_environment());
  ros2::NodeEntry self(*context, {"/", "_launcher"});
  const auto client = ros2::ServiceClient::create(
      self, {node + "/change_state", std::string(ros2::srv::ChangeState::kType)},
      rtps::qos::kServices,
      {{node + "/get_state", std::string(ros2::srv::GetState::kType)},
       rtps::encode(ros2::srv::GetState::Request{})});
  ASSERT_TRUE(client);
  for (const std::uint8_t transition : {1, 3}) EXPECT_TRUE(ros2::change(**client, transition));
}

void start_scratch(const TestWorld& world, Programs& programs, const Scratch& nodes) {
  const std::string domain = std::to_string(ros2::options_from_environment()->domain);
  const auto start = [&](std::vector<std::string> command) {
    programs.push_back(std::make_unique<TestProgram>(world, std::move(command)));
  };
  for (int i = 0; i < nodes.launched; ++i)
    start({"ros2_peer_node", domain, "/scratch/launched_" + std::to_string(i)});
  for (int i = 0; i < nodes.self_made; ++i)
    start({"ros2_peer_node", domain, "--active", "/scratch/self_made_" + std::to_string(i)});
  for (int i = 0; i < nodes.respawned; ++i)
    start({"sh", "-c",
           "while :; do " + (own_folder() / "ros2_peer_node").string() + " " + domain +
               " --active /scratch/respawned_" + std::to_string(i) + "; done"});
  for (int i = 0; i < nodes.launched; ++i) bring_up("/scratch/launched_" + std::to_string(i));
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t found = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += what.size())
    ++found;
  return found;
}

// A user with a robot that runs.
class NewUser {
 public:
  explicit NewUser(const TestWorld& world) : world_(world), file_(world.folder() / "my.rules") {}
  // culprit leaves what it has started.
  ~NewUser() {
    if (!culprit_) return;
    culprit_->signal(SIGINT);
    culprit_->wait();
    for (const std::string& each : components()) {
      if (const int pid = pid_in(culprit_->output(), each); pid != 0) kill(pid, SIGKILL);
    }
  }

  void begins() {
    TestProgram init(world_, {"culprit", "init", "--for", "5", "-o", file_});
    ASSERT_EQ(init.wait(60s), 0) << init.output();
    draft_ = *read_text(file_);
    TestProgram check(world_, {"culprit", "check", "--robot", "--strict", file_});
    ASSERT_EQ(check.wait(), 0) << check.output() << draft_;
    static const std::regex kComponent("(^|\\n)COMPONENT (\\w+) ");
    for (std::sregex_iterator found(draft_.begin(), draft_.end(), kComponent), end; found != end;
         ++found)
      components_.push_back((*found)[2]);
    culprit_.emplace(
        world_, std::vector<std::string>{"culprit", "run", file_, "--settle", "2", "--state-dir",
                                         (world_.folder() / "state").string()});
    for (const std::string& each : components_)
      ASSERT_TRUE(culprit_->prints(each + " is there (process ")) << culprit_->output() << draft_;
    std::this_thread::sleep_for(2s);  // until it judges
  }

  const std::string& file() const { return file_; }
  const std::string& draft() const { return draft_; }
  // Of the robot: who breaks SUNSET and measures it is a node of this test.
  std::vector<std::string> components() const {
    std::vector<std::string> all;
    for (const std::string& each : components_) {
      if (pid_in(culprit_->output(), each) != getpid()) all.push_back(each);
    }
    return all;
  }

  // Kills it, and waits until it is back and nothing is wrong any more.
  void kills(const std::string& component) {
    const int before = pid_in(culprit_->output(), component);
    ASSERT_NE(before, 0) << component << "\n" << draft_;
    ++killed_;
    const Time begin = live_now();
    ASSERT_EQ(kill(before, SIGKILL), 0) << component;
    constexpr Duration kPatience = 40s;  // only failures need it
    while (!is_back(component, before) && live_now() < begin + kPatience)
      std::this_thread::sleep_for(20ms);
    EXPECT_TRUE(is_back(component, before)) << component << "\n" << culprit_->output() << draft_;
    std::cout << component << ": " << seconds(live_now() - begin) << " s\n";
  }

  // Only killed nodes were repaired.
  void sees_nothing_needless() const {
    const std::string said = culprit_->output();
    EXPECT_LE(count(said, ": done\n"), killed_) << said << draft_;
    EXPECT_EQ(count(said, "restart "), 0u) << said;
    EXPECT_EQ(count(said, "several nodes"), 0u) << said;
  }

 private:
  bool is_back(const std::string& component, int before) const {
    const std::string said = culprit_->output();
    const int now = pid_in(said, component);
    const std::string rule = component + "_failed";
    return now != 0 && now != before && kill(now, 0) == 0 &&
           count(said, rule + " detected") == count(said, rule + " resolved");
  }

  const TestWorld& world_;
  const std::string file_;
  std::string draft_;
  std::vector<std::string> components_;
  std::optional<TestProgram> culprit_;
  std::size_t killed_ = 0;
};

bool has_to_kill_each_node() { return std::getenv("CULPRIT_EACH_NODE") != nullptr; }

void kill_each(const TestWorld& world) {
  NewUser user(world);
  ASSERT_NO_FATAL_FAILURE(user.begins());
  for (const std::string& each : user.components()) ASSERT_NO_FATAL_FAILURE(user.kills(each));
  user.sees_nothing_needless();
}

TEST(FirstHour, OfSunsetACameraThatIsKilledComesBack) {
  const TestWorld world;
  const lab::LiveSunset sunset(world);
  ASSERT_TRUE(sunset.is_well_within(60s)) << sunset.complaint();
  NewUser user(world);
  ASSERT_NO_FATAL_FAILURE(user.begins());
  EXPECT_THAT(user.draft(), testing::HasSubstr("|| age(/managed_subsystem/rgb_camera) > "));
  ASSERT_NO_FATAL_FAILURE(user.kills("camera"));
  user.sees_nothing_needless();
  EXPECT_TRUE(sunset.is_well_within(60s)) << sunset.complaint();
}

TEST(FirstHour, OfARobotThatNobodyKnowsNodesComeBackAndNewOnesAreAdded) {
  const TestWorld world;
  Programs programs;
  ASSERT_NO_FATAL_FAILURE(start_scratch(world, programs, {1, 1, 1}));
  NewUser user(world);
  ASSERT_NO_FATAL_FAILURE(user.begins());
  for (const char* each : {"self_made_0", "respawned_0"}) ASSERT_NO_FATAL_FAILURE(user.kills(each));
  user.sees_nothing_needless();

  const std::string domain = std::to_string(ros2::options_from_environment()->domain);
  const TestProgram late(world, {"ros2_peer_node", domain, "--active", "/late"});
  TestProgram update(world, {"culprit", "init", "--for", "5", "--update", user.file()});
  EXPECT_EQ(update.wait(), 0) << update.output();
  EXPECT_THAT(update.output(), testing::HasSubstr("\n+COMPONENT late NODE /late LAUNCH "));
  EXPECT_EQ(*read_text(user.file()), user.draft()) << "nobody asked for it";
  TestProgram patch(world, {"patch", user.file(), world.write("patch", update.output())});
  EXPECT_EQ(patch.wait(), 0) << patch.output();
  TestProgram check(world, {"culprit", "check", "--robot", "--strict", user.file()});
  EXPECT_EQ(check.wait(), 0) << check.output() << *read_text(user.file());
  EXPECT_THAT(check.output(), testing::HasSubstr("late is /late, active"));
}

TEST(FirstHour, EachNodeOfSunset) {
  if (!has_to_kill_each_node()) GTEST_SKIP() << "scripts/first-hour";
  const TestWorld world;
  const lab::LiveSunset robot(world);
  ASSERT_TRUE(robot.is_well_within(60s)) << robot.complaint();
  kill_each(world);
}

TEST(FirstHour, EachNodeOfSuave) {
  if (!has_to_kill_each_node()) GTEST_SKIP() << "scripts/first-hour";
  const TestWorld world;
  Programs programs;
  start_suave(world, programs);
  std::this_thread::sleep_for(3s);
  kill_each(world);
}

TEST(FirstHour, EachNodeOfARobotThatNobodyKnows) {
  if (!has_to_kill_each_node()) GTEST_SKIP() << "scripts/first-hour";
  const TestWorld world;
  Programs programs;
  ASSERT_NO_FATAL_FAILURE(start_scratch(world, programs, {4, 4, 2}));
  kill_each(world);
}

// Examines a healthy robot for the given time, and reports only failures that the robot causes itself.
void look_at_the_healthy(const TestWorld& world, const std::string& breaks_itself = "") {
  const char* wanted = std::getenv("CULPRIT_HEALTHY_SECONDS");
  const auto time = std::chrono::seconds(wanted == nullptr ? 10 : std::atoi(wanted));
  TestProgram doctor(world, {"culprit", "doctor", "--watch", "--json"});
  std::this_thread::sleep_for(time);
  ASSERT_TRUE(doctor.prints("\n")) << doctor.output();
  doctor.signal(SIGINT);
  const int exit = doctor.wait().value_or(-1);
  EXPECT_TRUE(exit == 0 || !breaks_itself.empty()) << doctor.output();
  std::istringstream looks(doctor.output());
  int count = 0;
  for (std::string look; std::getline(looks, look); ++count) {
    const auto report = parse_json(look);
    ASSERT_TRUE(report.is_object()) << look;
    for (const auto& finding : report["findings"])
      EXPECT_TRUE(finding["code"] == "D020" && finding["who"] == breaks_itself)
          << "look " << count << ": " << finding;
  }
  std::cout << count << " looks\n";
}

TEST(Healthy, SunsetIs) {
  const TestWorld world;
  const lab::LiveSunset robot(world);
  ASSERT_TRUE(robot.is_well_within(60s)) << robot.complaint();
  look_at_the_healthy(world);
}

TEST(Healthy, SuaveIs) {
  const TestWorld world;
  Programs programs;
  start_suave(world, programs);
  look_at_the_healthy(world, "thruster_monitor: Thruster status");  // its mission loses thrusters
}

TEST(Healthy, ARobotThatNobodyKnowsIs) {
  const TestWorld world;
  Programs programs;
  ASSERT_NO_FATAL_FAILURE(start_scratch(world, programs, {4, 4, 2}));
  look_at_the_healthy(world);
}

}  // namespace
}  // namespace culprit::cli
