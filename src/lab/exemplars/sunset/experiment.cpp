#include "exemplars/sunset/experiment.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

#include "exemplars/sunset/crash_at_start.h"
#include "exemplars/sunset/fused_message.h"
#include "exemplars/sunset/node_process.h"

namespace culprit::sunset {
namespace {

constexpr double kPollSec = 0.5;
constexpr int kCrashes = 2;

struct Setting {
  Member member;
  std::string name;
  Value value;
};

// Settings that adaptations change, and settings that no scenario uses.
std::vector<Setting> other_settings() {
  return {{Member::kDepth, "do_drop_depth_camera", false},
          {Member::kImageEnhancement, "image_degradation", 1.5},
          {Member::kSensorFusion, "topic_camera_input", std::string("rgb_camera")},
          {Member::kSensorFusion, "modality", std::int64_t{FusionType::kFusion}},
          {Member::kSensorFusion, "do_recalibration", false}};
}

}  // namespace

Expected<std::unique_ptr<Experiment>> Experiment::start(Options options) {
  std::unique_ptr<Experiment> experiment(new Experiment(std::move(options)));
  if (auto opened = experiment->open(); !opened) return Error{opened.error()};
  experiment->thread_ = std::thread([e = experiment.get()] { e->executor_.run(); });
  return experiment;
}

Experiment::~Experiment() {
  executor_.stop();
  if (thread_.joinable()) thread_.join();
}

Expected<void> Experiment::open() {
  auto context = ros2::Context::create(executor_, options_.participant);
  if (!context) return Error{context.error()};
  context_ = std::move(*context);

  auto node = ros2::Node::create(
      *context_, {std::string(kExperimentNamespace), std::string("scenario_executor")});
  if (!node) return Error{node.error()};
  node_ = std::move(*node);
  for (const Member member : kManagedMembers) {
    auto created = NodeControl::create(*node_, node_of(member));
    if (!created) return Error{created.error()};
    controls_[static_cast<std::size_t>(member)] = std::move(*created);
  }
  const Duration robot_second = from_seconds(1 / options_.speed);
  auto observer = Observer::create(*node_, robot_second);
  if (!observer) return Error{observer.error()};
  observer_ = std::move(*observer);
  poll_.emplace(executor_, from_seconds(kPollSec / options_.speed), [this] { poll_states(); });
  return {};
}

void Experiment::poll_states() {
  for (const Member member : kManagedMembers) {
    bool& is_polled = is_polled_[static_cast<std::size_t>(member)];
    if (std::exchange(is_polled, true)) continue;
    control(member).get_state([this, member, &is_polled](const Expected<LifecycleState>& state) {
      is_polled = false;
      observer_->on_state(member, state ? std::optional(*state) : std::nullopt);
    });
  }
}

Experiment::Answer Experiment::set(Member member, const std::string& parameter,
                                   const Value& value) {
  return ask<void>([&](auto then) { control(member).set_parameter(parameter, value, then); });
}

std::vector<Experiment::Injection> Experiment::inject(const Scenario& scenario) {
  std::vector<Answer> answers;
  for (const Fault* fault : scenario.faults) {
    answers.push_back(set(fault->member, std::string(fault->name), fault->value));
  }
  std::vector<Injection> injections;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    injections.push_back({scenario.faults[i], answers[i].get()});
  }
  return injections;
}

Expected<void> Experiment::inject(const Fault& fault) {
  return set(fault.member, std::string(fault.name), fault.value).get();
}

Expected<void> Experiment::inject(ProcessFault fault, Member member) {
  const std::vector<int> pids = processes_of(member, options_.participant.domain);
  if (pids.empty()) return Error{node_of(member).full() + " has no process on this machine"};
  if (fault == ProcessFault::kCrashAtStart) {
    if (auto armed = arm_crash(options_.state, name_of(member), kCrashes); !armed) return armed;
  }
  for (const int pid : pids) {
    if (kill(pid, fault == ProcessFault::kStop ? SIGSTOP : SIGKILL) != 0) {
      return Error{"process " + std::to_string(pid) + ": " + std::strerror(errno)};
    }
  }
  return {};
}

Expected<void> Experiment::clear() {
  std::string troubles;
  const auto note = [&troubles](const Expected<void>& result) {
    if (!result) troubles += (troubles.empty() ? "" : "; ") + result.error();
  };
  if (!options_.state.empty()) {
    for (const Member member : kMembers) note(arm_crash(options_.state, name_of(member), 0));
  }
  for (const Member member : kMembers) {
    for (const int pid : processes_of(member, options_.participant.domain)) kill(pid, SIGCONT);
  }
  for (const Member member : kManagedMembers) note(clear(member));
  return troubles.empty() ? Expected<void>() : Error{troubles};
}

Expected<void> Experiment::clear(Member member) {
  for (const Fault& fault : faults()) {
    if (fault.member != member || fault.name == "autofocus_needed") continue;
    auto done = set(member, std::string(fault.name), fault.healthy).get();
    if (!done) return done;
  }
  for (const Setting& setting : other_settings()) {
    if (setting.member != member) continue;
    if (auto done = set(member, setting.name, setting.value).get(); !done) return done;
  }
  if (member == Member::kCamera) {
    if (auto focused = focus(); !focused) return focused;
  }
  return bring_to(member, member == Member::kImageEnhancement ? LifecycleState::kInactive
                                                              : LifecycleState::kActive);
}

// Not by clearing autofocus_needed: then the camera would never say that it is sharp again.
Expected<void> Experiment::focus() {
  const auto is_needed = ask<Value>([this](auto then) {
                           control(Member::kCamera).get_parameter("autofocus_needed", then);
                         }).get();
  if (!is_needed) return Error{is_needed.error()};
  if (*is_needed == Value(false)) return {};
  return set(Member::kCamera, "perform_autofocus", true).get();
}

Expected<void> Experiment::bring_to(Member member, LifecycleState target) {
  using ros2::TransitionId;
  constexpr int kMostSteps = 2;  // configure, activate
  for (int step = 0; step <= kMostSteps; ++step) {
    const auto state =
        ask<LifecycleState>([&](auto then) { control(member).get_state(then); }).get();
    if (!state) return Error{state.error()};
    if (*state == target) return {};
    const TransitionId next = *state == LifecycleState::kUnconfigured ? TransitionId::kConfigure
                              : *state == LifecycleState::kInactive   ? TransitionId::kActivate
                                                                      : TransitionId::kDeactivate;
    auto done = ask<void>([&](auto then) { control(member).change_state(next, then); }).get();
    if (!done) return done;
  }
  return Error{node_of(member).full() + " does not become " + std::string(ros2::label_of(target))};
}

}  // namespace culprit::sunset
