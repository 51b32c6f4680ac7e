// The experimenter: breaks the live robot and measures what becomes of it.
//
// A node of its own, /experiment_setup/scenario_executor, on a thread of its own. It injects faults
// through the parameter services of the nodes, as the exemplar does, and into processes by signals.
// It sees what the evaluator, the segmentation and the heartbeats publish. It never repairs
// anything but in clear().
//
// All members may be called from any thread. Those that say "blocks" wait for the nodes' answers,
// at most NodeControl::kPatience for each node that does not answer.
#pragma once

#include <array>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/expected.h"
#include "exemplars/sunset/node_control.h"
#include "exemplars/sunset/observer.h"
#include "exemplars/sunset/sunset_scenario.h"
#include "ros2/node.h"
#include "ros2/options.h"
#include "ros2/timer.h"

namespace culprit::sunset {

class Experiment {
 public:
  struct Options {
    double speed = 1;             // as the nodes' (node_options.h)
    std::filesystem::path state;  // as the nodes'; needed for ProcessFault::kCrashAtStart
    ros2::ParticipantOptions participant;
  };

  static Expected<std::unique_ptr<Experiment>> start(Options options);
  ~Experiment();

  struct Injection {
    const Fault* fault = nullptr;
    Expected<void> outcome;  // an error: the fault is not in place, or we cannot tell
  };
  // All three faults at once, in the order of the scenario. Blocks.
  std::vector<Injection> inject(const Scenario& scenario);
  Expected<void> inject(const Fault& fault);  // blocks
  // To our own processes on this machine (node_process.h). An error: there is none.
  Expected<void> inject(ProcessFault fault, Member member);

  // Removes what scenarios, and the adaptations to them, leave behind: parameters and lifecycle are
  // as after the first start, stopped processes go on, no start crashes. An error names the nodes
  // that could not be brought there; a process that is gone must be started by others. Blocks.
  Expected<void> clear();

  void restart_measuring() { observer_->restart(); }
  Measurements measure() const { return observer_->measure(); }

 private:
  using Answer = std::future<Expected<void>>;

  explicit Experiment(Options options) : options_(std::move(options)) {}
  Expected<void> open();
  NodeControl& control(Member member) { return *controls_[static_cast<std::size_t>(member)]; }
  Answer set(Member member, const std::string& parameter, const Value& value);
  Expected<void> clear(Member member);
  Expected<void> focus();
  Expected<void> bring_to(Member member, LifecycleState target);
  void poll_states();

  const Options options_;
  ros2::Executor executor_;
  std::unique_ptr<ros2::Context> context_;
  std::unique_ptr<ros2::Node> node_;
  std::array<std::unique_ptr<NodeControl>, kMembers.size()> controls_;  // of managed members
  std::array<bool, kMembers.size()> is_polled_{};
  std::unique_ptr<Observer> observer_;
  std::optional<ros2::Timer> poll_;
  std::thread thread_;  // runs the executor
};

}  // namespace culprit::sunset
