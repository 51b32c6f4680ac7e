// For tests: a live robot that a manager heals on a thread of its own, and what that saw and said.
#pragma once

#include <algorithm>
#include <atomic>
#include <csignal>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "base/live_clock.h"
#include "base/test_folder.h"
#include "knowledge/describe.h"
#include "language/checker.h"
#include "live/live_robot.h"
#include "manager/manager.h"
#include "manager/runtime.h"
#include "plan/bayes/bayes_planner.h"
#include "ros2/live_test.h"

namespace culprit::live {

// The components' processes that it saw end with it.
class HealedRobot {
 public:
  HealedRobot(const ros2::ParticipantOptions& participant, const std::string& rules)
      : rules_(*check(Source("test.rules", rules)).rules) {
    LiveRobot::Options options;
    options.link.participant = participant;
    options.supervisor.log_folder = folder_.path();
    auto robot = LiveRobot::open(rules_, std::move(options));
    if (!robot) throw std::runtime_error(robot.error());
    robot_ = std::move(*robot);
    Manager::Options how;
    how.start = live_now();
    how.discovery = std::chrono::seconds(1);
    manager_.emplace(rules_, std::make_unique<BayesPlanner>(), how);
    runtime_.emplace(*manager_, *robot_);
    runtime_->on_events = [this](std::span<const Event> events) { note(events); };
    runtime_->on_step = [this](const Runtime::Step& step) { note(step.observations); };
    thread_ = std::thread([this] { runtime_->run(is_over_); });
  }
  ~HealedRobot() {
    is_over_ = true;
    robot_->interrupt();
    thread_.join();
    robot_.reset();
    for (const int pid : seen_) kill(pid, SIGKILL);
  }
  HealedRobot(const HealedRobot&) = delete;

  template <class Done>
  static bool comes_true(Done done) {
    for (const Time end = later(live_now(), rtps::kPatience); !done();) {
      if (live_now() > end) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return true;
  }
  bool sees(int pid) {
    return comes_true([&] {
      const std::lock_guard lock(mutex_);
      return seen_.contains(pid);
    });
  }
  bool sees_all_active(std::span<const char* const> components) {
    return comes_true([&] {
      const std::lock_guard lock(mutex_);
      return std::ranges::all_of(
          components, [this](const char* each) { return states_[each] == Lifecycle::kActive; });
    });
  }
  std::string said() {
    const std::lock_guard lock(mutex_);
    return said_;
  }
  int detected() {
    const std::lock_guard lock(mutex_);
    return detected_;
  }
  int resolved() {
    const std::lock_guard lock(mutex_);
    return resolved_;
  }
  LiveRobot& robot() { return *robot_; }

 private:
  void note(std::span<const Event> events) {
    const std::lock_guard lock(mutex_);
    for (const Event& event : events) {
      said_ += describe(event, rules_) + "\n";
      detected_ += std::holds_alternative<FailureDetected>(event.what);
      resolved_ += std::holds_alternative<FailureResolved>(event.what);
    }
  }
  void note(const std::vector<Observation>& observations) {
    const std::lock_guard lock(mutex_);
    for (const Observation& observation : observations) {
      if (const auto* read = std::get_if<LifecycleRead>(&observation.what))
        states_[rules_[read->component].name] = read->state;
      const auto* appeared = std::get_if<NodeAppeared>(&observation.what);
      if (appeared == nullptr || appeared->pid == 0) continue;
      const bool is_component = std::ranges::any_of(
          rules_.components, [&](const Component& each) { return each.node == appeared->node; });
      if (is_component) seen_.insert(appeared->pid);
    }
  }

  const test::TestFolder folder_;
  const RuleSet rules_;
  std::unique_ptr<LiveRobot> robot_;
  std::optional<Manager> manager_;
  std::optional<Runtime> runtime_;
  std::mutex mutex_;
  std::string said_;
  int detected_ = 0;
  int resolved_ = 0;
  std::map<std::string, Lifecycle> states_;
  std::set<int> seen_;
  std::atomic<bool> is_over_ = false;
  std::thread thread_;
};

}  // namespace culprit::live
