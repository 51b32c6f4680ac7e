#include "exemplars/rover/experiment.h"

#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <fstream>

#include "base/live_clock.h"
#include "exemplars/node_process.h"
#include "exemplars/rover/nodes.h"
#include "ros2/lifecycle.h"

namespace culprit::rover {
namespace {

// Blocks until the call has ended.
template <class T>
Expected<T> answer_to(auto begin) {
  return sunset::ask<T>(begin).get();
}

bool is_stopped(int pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string text;
  std::getline(file, text);
  const std::size_t end = text.rfind(") ");
  return end != std::string::npos && text.size() > end + 2 && text[end + 2] == 'T';
}

}  // namespace

Expected<std::unique_ptr<Experiment>> Experiment::start(const ros2::ParticipantOptions& participant,
                                                        std::filesystem::path state) {
  std::unique_ptr<Experiment> experiment(new Experiment(participant, std::move(state)));
  if (auto opened = experiment->open(); !opened) return Error{opened.error()};
  experiment->thread_ = std::thread([e = experiment.get()] { e->executor_.run(); });
  return experiment;
}

Experiment::~Experiment() {
  executor_.stop();
  if (thread_.joinable()) thread_.join();
}

Expected<void> Experiment::open() {
  auto context = ros2::Context::create(executor_, participant_);
  if (!context) return Error{context.error()};
  context_ = std::move(*context);
  auto node = ros2::Node::create(*context_, {"/", "experiment"});
  if (!node) return Error{node.error()};
  node_ = std::move(*node);
  for (const Process& process : processes()) {
    auto created = sunset::NodeControl::create(*node_, {"/", std::string(process.name)});
    if (!created) return Error{created.error()};
    controls_[std::string(process.name)] = std::move(*created);
  }
  auto truth = node_->create_subscription<msg::Odometry>(
      "/world/truth", rtps::qos::kSensorData,
      [this](const msg::Odometry& message) { on_truth(message); });
  auto pose = node_->create_subscription<msg::PoseWithCovarianceStamped>(
      "/amcl_pose", rtps::qos::kSensorData, [this](const msg::PoseWithCovarianceStamped& message) {
        const MutexLock lock(mutex_);
        if (robot_) seen_.pose_error_m = distance(*robot_, to_pose(message.pose.pose));
      });
  auto diagnostics = node_->create_subscription<ros2::msg::DiagnosticArray>(
      "/diagnostics", rtps::qos::kDefault,
      [this](const ros2::msg::DiagnosticArray& array) { on_diagnostics(array); });
  for (auto* made : {&truth, &pose, &diagnostics}) {
    if (!*made) return Error{made->error()};
    subscriptions_.push_back(std::move(**made));
  }
  poll_.emplace(executor_, std::chrono::milliseconds(500), [this] { poll_states(); });
  return {};
}

void Experiment::on_truth(const msg::Odometry& truth) {
  const MutexLock lock(mutex_);
  const Time now = live_now();
  robot_ = to_pose(truth.pose.pose);
  const auto& twist = truth.twist.twist;
  const bool stands = std::abs(twist.linear.x) < 0.02 && std::abs(twist.angular.z) < 0.05;
  if (stands && last_truth_ != kLongAgo) seen_.stood_s += seconds(now - last_truth_);
  last_truth_ = now;
  if (distance(*robot_, moved_from_) > 0.15 ||
      std::abs(normalized(robot_->yaw - moved_from_.yaw)) > 0.5) {
    moved_from_ = *robot_;
    moved_ = now;
  }
}

void Experiment::on_diagnostics(const ros2::msg::DiagnosticArray& array) {
  const MutexLock lock(mutex_);
  for (const auto& status : array.status) {
    for (const auto& [key, value] : status.values) {
      double number = 0;
      std::from_chars(value.data(), value.data() + value.size(), number);
      if (key == "goals_reached") seen_.goals_reached = static_cast<int>(number);
      if (key == "goals_failed") seen_.goals_failed = static_cast<int>(number);
      if (key == "collisions") seen_.collisions = static_cast<int>(number);
      if (key == "driven") seen_.driven_m = number;
    }
  }
}

void Experiment::poll_states() {
  for (const Process& process : processes()) {
    const std::string name(process.name);
    if (!is_server("/" + name) || std::exchange(is_polled_[name], true)) continue;
    control(name).get_state([this, name](const Expected<LifecycleState>& state) {
      is_polled_[name] = false;
      const MutexLock lock(mutex_);
      states_[name] = state ? std::optional(*state) : std::nullopt;
    });
  }
}

void Experiment::restart_measuring() {
  const MutexLock lock(mutex_);
  seen_.stood_s = 0;
}

Measurements Experiment::measure() const {
  const MutexLock lock(mutex_);
  Measurements result = seen_;
  result.standing_s = seconds(live_now() - moved_);
  std::string inactive;
  for (const Process& process : processes()) {
    const std::string name(process.name);
    const auto state = states_.find(name);
    const bool is_active = state != states_.end() && state->second == LifecycleState::kActive;
    if (is_server("/" + name) && !is_active && inactive.empty()) inactive = name;
  }
  result.complain(inactive);
  return result;
}

Expected<void> Experiment::inject(const Fault& fault) {
  if (fault.way == Way::kParameter)
    return answer_to<void>([&](auto then) {
      control(fault.process).set_parameter(fault.parameter, fault.value, then);
    });
  if (fault.way == Way::kDeactivate)
    return answer_to<void>([&](auto then) {
      control(fault.process).change_state(ros2::TransitionId::kDeactivate, then);
    });
  const auto pids = processes_of("rover-node", fault.process, participant_.domain);
  if (pids.empty()) return Error{fault.process + " has no process on this machine"};
  if (fault.way == Way::kNextStart &&
      !(std::ofstream(next_start_of(fault.process))
        << fault.parameter << ' ' << std::get<double>(fault.value) << std::flush))
    return Error{"cannot write in " + state_.string()};
  for (const int pid : pids) {
    if (kill(pid, fault.way == Way::kStop ? SIGSTOP : SIGKILL) != 0)
      return Error{"process " + std::to_string(pid) + ": " + std::strerror(errno)};
  }
  return {};
}

Expected<Value> Experiment::parameter(const std::string& process, const std::string& name) {
  return answer_to<Value>([&](auto then) { control(process).get_parameter(name, then); });
}

bool Experiment::is_over(const Fault& fault) {
  if (fault.name == "kidnapped") return measure().pose_error_m < Measurements::kLostAt;
  if (fault.way == Way::kParameter) {
    const auto value = parameter(fault.process, fault.parameter);
    return value && *value != fault.value;
  }
  if (fault.way == Way::kNextStart) {
    const auto value = parameter(fault.process, fault.parameter);  // it may have none of that name
    return parameter(fault.process, "fault") && !(value && *value == fault.value);
  }
  if (fault.way == Way::kDeactivate) {
    const auto state =
        answer_to<LifecycleState>([&](auto then) { control(fault.process).get_state(then); });
    return state && *state == LifecycleState::kActive;
  }
  const auto pids = processes_of("rover-node", fault.process, participant_.domain);
  if (fault.way == Way::kStray) return pids.size() < 2 && fault.process != kEkf.name;
  return std::ranges::any_of(pids, [](int pid) { return !is_stopped(pid); });
}

void Experiment::clear() {
  for (const Process& process : processes()) {
    for (const int pid : processes_of("rover-node", process.name, participant_.domain))
      kill(pid, SIGCONT);
    std::error_code error;
    std::filesystem::remove(next_start_of(std::string(process.name)), error);
  }
  const std::vector<std::pair<std::string, std::pair<std::string, Value>>> healthy = {
      {"world", {"lidar_plugged", Value(true)}},
      {"world", {"lidar_flaps", Value(false)}},
      {"world", {"battery", Value(1.0)}},
      {"camera_driver", {"exposure", Value(1.0)}},
      {"base_driver", {"motor_power", Value(true)}},
      {"e_stop", {"stopped", Value(false)}},
      {"controller_server", {"max_speed", Value(0.5)}}};
  for (const auto& each : healthy)
    (void)answer_to<void>([&each, this](auto then) {
      control(each.first).set_parameter(each.second.first, each.second.second, then);
    });
  for (const Process& process : processes()) {
    if (process.make == nullptr) continue;
    (void)answer_to<void>([&](auto then) {
      control(std::string(process.name)).set_parameter("fault", Value(""), then);
    });
  }
}

}  // namespace culprit::rover
