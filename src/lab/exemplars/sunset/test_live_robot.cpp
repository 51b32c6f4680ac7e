#include "exemplars/sunset/test_live_robot.h"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <future>
#include <stdexcept>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

#include "exemplars/sunset/health_watch.h"
#include "owners/spawn.h"

namespace culprit::sunset {
namespace {

using namespace std::chrono_literals;

constexpr auto kPatience = 30s;  // on any machine enough
constexpr std::array kWatched = {topics::kRgbRaw,       topics::kRgbCamera,
                                 topics::kDepthCamera,  topics::kRgbEnhanced,
                                 topics::kSensorsFused, topics::kSegmentation};

template <class T>
T must(Expected<T> made) {
  if (!made) throw std::runtime_error(made.error());
  return std::move(*made);
}

std::string type_of(std::string_view topic) {
  return topic == topics::kSensorsFused ? "system_interfaces/msg/SensorFusion"
                                        : "sensor_msgs/msg/Image";
}

std::string trouble(const Expected<void>& result) { return result ? "" : result.error(); }

}  // namespace

Watcher::Watcher(const ros2::ParticipantOptions& participant)
    : context_(must(ros2::Context::create(executor_, participant))),
      node_(must(ros2::Node::create(*context_, {"/", "watcher"}))) {
  for (const Member member : kManagedMembers) {
    controls_[static_cast<std::size_t>(member)] =
        must(NodeControl::create(*node_, node_of(member)));
  }
  for (const std::string_view topic : kWatched) {
    subscriptions_.push_back(must(ros2::RawSubscription::create(
        node_->entry(), topic, type_of(topic), rtps::qos::kSensorData, ros2::PayloadUse::kHeader,
        [this, topic](const ros2::Sample&) {
          const MutexLock lock(mutex_);
          ++messages_[topic];
          something_came_.notify_all();
        })));
  }
  diagnostics_ = must(node_->create_subscription<ros2::msg::DiagnosticArray>(
      topics::kDiagnostics, rtps::qos::kDefault,
      [this](const ros2::msg::DiagnosticArray& array) { on_diagnostics(array); }));
  thread_ = std::thread([this] { executor_.run(); });
}

Watcher::~Watcher() {
  executor_.stop();
  thread_.join();
}

void Watcher::on_diagnostics(const ros2::msg::DiagnosticArray& array) {
  const MutexLock lock(mutex_);
  for (const auto& status : array.status) {
    for (const auto& [key, value] : status.values) {
      if (status.hardware_id == "camera" && key == "autofocus_needed") autofocus_ = value;
      if (status.hardware_id != "segmentation" || key != "entropy") continue;
      const bool is_sure = std::stod(value) <= kEntropyLimit;
      sure_ = is_sure ? sure_ + 1 : 0;
      unsure_ = is_sure ? 0 : unsure_ + 1;
    }
  }
  something_came_.notify_all();
}

bool Watcher::wait(const std::function<bool()>& condition) {
  MutexLock lock(mutex_);
  return something_came_.wait_for(lock, kPatience, condition);
}

bool Watcher::flows(std::string_view topic, int messages) {
  std::optional<int> before;
  return wait([&]() CULPRIT_REQUIRES(mutex_) {
    if (!before) before = messages_[topic];
    return messages_[topic] >= *before + messages;
  });
}

bool Watcher::speaks_now(std::string_view topic) {
  std::optional<int> before;
  std::optional<int> frames_before;
  wait([&]() CULPRIT_REQUIRES(mutex_) {
    if (!before) before = messages_[topic];
    if (!frames_before) frames_before = messages_[topics::kRgbRaw];
    return messages_[topic] > *before || messages_[topics::kRgbRaw] >= *frames_before + 20;
  });
  const MutexLock lock(mutex_);
  return messages_[topic] > *before;
}

bool Watcher::falls_silent(std::string_view topic) {
  int last = -1;
  int frames_then = 0;
  return wait([&]() CULPRIT_REQUIRES(mutex_) {
    if (messages_[topic] != last) {
      last = messages_[topic];
      frames_then = messages_[topics::kRgbRaw];
    }
    return messages_[topics::kRgbRaw] >= frames_then + 10;
  });
}

bool Watcher::has_in_a_row(int Watcher::*count) {
  bool is_first = true;
  return wait([&]() CULPRIT_REQUIRES(mutex_) {
    if (std::exchange(is_first, false)) this->*count = 0;
    return this->*count >= 30;  // the first ten or so may be of pictures from before
  });
}

bool Watcher::says_autofocus(std::string_view text) {
  return wait([&]() CULPRIT_REQUIRES(mutex_) { return autofocus_ == text; });
}

LiveRobot::LiveRobot() : domain_(must(ros2::DomainLock::reserve())) {
  participant_.domain = domain_.domain();
  participant_.reach = ros2::Reach::kLocalhost;
  setenv("ROS_DOMAIN_ID", std::to_string(domain_.domain()).c_str(), 1);
  setenv("ROS_LOCALHOST_ONLY", "1", 1);
  setenv("SUNSET_STATE", state_.c_str(), 1);
  setenv("SUNSET_SPEED", std::to_string(kSpeed).c_str(), 1);
  for (const Member member : kMembers) start(member);
  watcher_.emplace(participant_);
}

LiveRobot::~LiveRobot() {
  for (const auto& [member, pid] : pids_) kill(pid, SIGKILL);
  for (const auto& [member, pid] : pids_) waitpid(pid, nullptr, 0);
}

int LiveRobot::start(Member member) {
  const auto program =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / "sunset-node";
  const std::string name(name_of(member));
  // A test that crashes must not leave a robot behind.
  pids_[member] = must(owners::spawn(
      {{"setpriv", "--pdeathsig", "KILL", program, name}, {}, state_ / (name + ".log")}));
  return pids_[member];
}

int LiveRobot::end(Member member, int signal) {
  const int pid = pids_.at(member);
  pids_.erase(member);
  kill(pid, signal);
  int status = 0;
  waitpid(pid, &status, 0);
  return status;
}

std::optional<int> LiveRobot::wait_for_end(Member member) {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  int status = 0;
  while (waitpid(pids_.at(member), &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > until) return std::nullopt;
    std::this_thread::sleep_for(5ms);
  }
  pids_.erase(member);
  return status;
}

std::string LiveRobot::set(Member member, const std::string& parameter, const Value& value) {
  return trouble(ask<void>([&](Then<void> then) {
                   watcher_->control(member).set_parameter(parameter, value, std::move(then));
                 }).get());
}

std::string LiveRobot::change(Member member, ros2::TransitionId transition) {
  return trouble(ask<void>([&](Then<void> then) {
                   watcher_->control(member).change_state(transition, std::move(then));
                 }).get());
}

std::string LiveRobot::restart(Member member) {
  const std::string wrong = change(member, ros2::TransitionId::kDeactivate);
  return wrong.empty() ? change(member, ros2::TransitionId::kActivate) : wrong;
}

void LiveRobot::redeploy(Member member) {
  end(member, SIGINT);
  start(member);
}

std::optional<Value> LiveRobot::get(Member member, const std::string& parameter) {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (std::chrono::steady_clock::now() < until) {
    const auto value = ask<Value>([&](Then<Value> then) {
                         watcher_->control(member).get_parameter(parameter, std::move(then));
                       }).get();
    if (value) return *value;
    std::this_thread::sleep_for(20ms);
  }
  return std::nullopt;
}

bool LiveRobot::becomes(Member member, LifecycleState state) {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (std::chrono::steady_clock::now() < until) {
    const auto now = ask<LifecycleState>([&](Then<LifecycleState> then) {
                       watcher_->control(member).get_state(std::move(then));
                     }).get();
    if (now && *now == state) return true;
    std::this_thread::sleep_for(20ms);
  }
  return false;
}

}  // namespace culprit::sunset
