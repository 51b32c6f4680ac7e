// A live group whose lifecycle manager gets stuck as Nav2's does: culprit brings it up past the manager.
#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "base/test_folder.h"
#include "knowledge/describe.h"
#include "language/checker.h"
#include "live/live_robot.h"
#include "manager/manager.h"
#include "manager/runtime.h"
#include "plan/bayes/bayes_planner.h"
#include "ros2/live_test.h"
#include "ros2/peer_process.h"

namespace culprit::live {
namespace {

using namespace std::chrono_literals;

constexpr std::array kServers = {"controller", "planner", "navigator"};

std::vector<std::string> command_of(const std::string& component, std::uint32_t domain) {
  if (component != "manager") return {CULPRIT_PEER_NODE, std::to_string(domain), "/" + component};
  std::vector<std::string> command = {CULPRIT_PEER_MANAGER, std::to_string(domain), "/manager"};
  for (const char* server : kServers) command.push_back(std::string("/") + server);
  return command;
}

std::string rules_text(std::uint32_t domain) {
  std::string text;
  for (const std::string component : {"controller", "planner", "navigator", "manager"}) {
    std::string launch;
    for (const std::string& word : command_of(component, domain))
      launch += (launch.empty() ? "" : " ") + word;
    text += "COMPONENT " + component + " NODE /" + component + " LAUNCH \"" + launch +
            (component == "manager" ? "\"\n" : "\" LIFECYCLE launcher\n");
  }
  return text +
         "GROUP servers { controller, planner, navigator } MANAGER manager\n"
         "RULE HalfUp\n  POLICIES ERROR FOR 2s\n  TRIGGER servers == \"half_up\"\n"
         "    STRATEGY start_servers 80 10\n      ADAPTATION servers start_group 25\n";
}

class Keeper {
 public:
  explicit Keeper(const ros2::ParticipantOptions& participant)
      : rules_(*check(Source("test.rules", rules_text(participant.domain))).rules) {
    LiveRobot::Options options;
    options.link.participant = participant;
    options.supervisor.log_folder = folder_.path();
    auto robot = LiveRobot::open(rules_, std::move(options));
    if (!robot) throw std::runtime_error(robot.error());
    robot_ = std::move(*robot);
    Manager::Options how;
    how.start = live_now();
    how.discovery = 1s;
    manager_.emplace(rules_, std::make_unique<BayesPlanner>(), how);
    runtime_.emplace(*manager_, *robot_);
    runtime_->on_events = [this](std::span<const Event> events) { note(events); };
    runtime_->on_step = [this](const Runtime::Step& step) { note(step.observations); };
    thread_ = std::thread([this] { runtime_->run(is_over_); });
  }
  ~Keeper() {
    is_over_ = true;
    robot_->interrupt();
    thread_.join();
    robot_.reset();
    for (const int pid : seen_) kill(pid, SIGKILL);
  }
  Keeper(const Keeper&) = delete;

  bool sees_all_active() {
    return comes_true([this] {
      return std::ranges::all_of(
          kServers, [this](const char* each) { return states_[each] == Lifecycle::kActive; });
    });
  }
  bool has_resolved() {
    return comes_true([this] { return resolved_ > 0; });
  }
  std::string said() {
    const std::lock_guard lock(mutex_);
    return said_;
  }

 private:
  template <class Done>
  bool comes_true(Done done) {
    for (const Time end = later(live_now(), ros2::kPatience); live_now() < end;
         std::this_thread::sleep_for(20ms)) {
      const std::lock_guard lock(mutex_);
      if (done()) return true;
    }
    return false;
  }
  void note(std::span<const Event> events) {
    const std::lock_guard lock(mutex_);
    for (const Event& event : events) {
      said_ += describe(event, rules_) + "\n";
      resolved_ += std::holds_alternative<FailureResolved>(event.what);
    }
  }
  void note(const std::vector<Observation>& observations) {
    const std::lock_guard lock(mutex_);
    for (const Observation& observation : observations) {
      if (const auto* read = std::get_if<LifecycleRead>(&observation.what))
        states_[rules_[read->component].name] = read->state;
      const auto* appeared = std::get_if<NodeAppeared>(&observation.what);
      if (appeared != nullptr && appeared->pid != 0 && appeared->node != "/culprit")
        seen_.insert(appeared->pid);
    }
  }

  const test::TestFolder folder_;
  const RuleSet rules_;
  std::unique_ptr<LiveRobot> robot_;
  std::optional<Manager> manager_;
  std::optional<Runtime> runtime_;
  std::mutex mutex_;
  std::string said_;
  int resolved_ = 0;
  std::map<std::string, Lifecycle> states_;
  std::set<int> seen_;
  std::atomic<bool> is_over_ = false;
  std::thread thread_;
};

struct Groups : testing::Test {
  std::unique_ptr<ros2::PeerProcess> start(const std::string& component) const {
    return std::make_unique<ros2::PeerProcess>(command_of(component, domain.number()));
  }

  ros2::TestDomain domain;
  std::unique_ptr<ros2::PeerProcess> controller = start("controller");
  std::unique_ptr<ros2::PeerProcess> planner = start("planner");
  std::unique_ptr<ros2::PeerProcess> navigator = start("navigator");
  std::unique_ptr<ros2::PeerProcess> manager = start("manager");
};

TEST_F(Groups, OneOfWhichAServerWasKilledIsBroughtUpPastItsManager) {
  Keeper keeper(domain.options());
  ASSERT_TRUE(keeper.sees_all_active()) << keeper.said();
  planner->end(SIGKILL);
  EXPECT_TRUE(manager->says("Deactivating /planner"));
  EXPECT_TRUE(keeper.has_resolved()) << keeper.said();
  EXPECT_TRUE(keeper.sees_all_active()) << keeper.said();
}

TEST_F(Groups, OneOfWhichAServerHangsIsBroughtUpPastItsManager) {
  Keeper keeper(domain.options());
  ASSERT_TRUE(keeper.sees_all_active()) << keeper.said();
  kill(planner->pid(), SIGSTOP);
  EXPECT_TRUE(keeper.has_resolved()) << keeper.said();
  EXPECT_TRUE(keeper.sees_all_active()) << keeper.said();
}

}  // namespace
}  // namespace culprit::live
