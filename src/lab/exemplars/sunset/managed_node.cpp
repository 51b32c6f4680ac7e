#include "exemplars/sunset/managed_node.h"

#include <chrono>

#include "exemplars/sunset/nap.h"

namespace culprit::sunset {

namespace msg = ros2::msg;
using ros2::Severity;
using ros2::TransitionId;
using ros2::TransitionResult;

ManagedNode::ManagedNode(Traits traits, NodeOptions options)
    : traits_(std::move(traits)), options_(std::move(options)) {}

ManagedNode::~ManagedNode() = default;

Expected<void> ManagedNode::open(ros2::Context& context) {
  auto managed = ros2::LifecycleNode::create(context, node_of(traits_.member),
                                             {.on_configure = [this] { return on_configure(); },
                                              .on_cleanup = [this] { return on_release(); },
                                              .on_activate = [this] { return on_activate(); },
                                              .on_deactivate = [this] { return on_deactivate(); },
                                              .on_shutdown = [this] { return on_shutdown(); },
                                              .on_error = [this] { return on_release(); }});
  if (auto created = keep(managed_, std::move(managed)); !created) return created;
  if (auto declared = declare_parameters(); !declared) return declared;
  tasks_.emplace(context.executor());
  tasks_->post([this] { come_up(); });
  return {};
}

bool ManagedNode::is_active() const { return managed_->state() == LifecycleState::kActive; }

Expected<void> ManagedNode::declare_parameters() {
  if (!options_.state.empty()) {
    const std::string name(name_of(traits_.member));
    auto opened = keep(file_, ParameterFile::open(options_.state / (name + ".parameters")));
    if (!opened) return opened;
  }
  for (const auto& [name, value] : traits_.parameters) {
    const auto kept = file_ ? file_->last(name, value) : std::nullopt;
    if (auto declared = node().parameters().declare(name, kept.value_or(value)); !declared) {
      return declared;
    }
  }
  node().parameters().on_set([this](std::span<const msg::Parameter> changes) -> Expected<void> {
    for (const msg::Parameter& change : changes) {
      if (auto agreed = on_set(change); !agreed) return agreed;
    }
    remember(changes);
    return {};
  });
  return {};
}

// A full disk is no reason to refuse an adaptation.
void ManagedNode::remember(std::span<const msg::Parameter> changes) {
  if (!file_) return;
  for (const msg::Parameter& change : changes) {
    const auto value = ros2::to_value(change.value);  // there are no arrays among ours
    const auto kept = file_->append(change.name, *value);
    if (!kept) node().log(Severity::kWarn, kept.error());
  }
}

void ManagedNode::assign(std::string_view name, Value value) {
  const msg::Parameter change{std::string(name), ros2::to_parameter_value(value)};
  if (const auto result = node().parameters().set({&change, 1}); !result.successful) {
    node().log(Severity::kError, result.reason);
  }
}

void ManagedNode::clear(std::span<const std::string> faults) {
  for (const std::string& fault : faults) {
    if (parameter<bool>(fault)) assign(fault, false);
  }
}

void ManagedNode::come_up() {
  if (!managed_->trigger(TransitionId::kConfigure)) return;
  if (traits_.activates_itself) managed_->trigger(TransitionId::kActivate);
}

TransitionResult ManagedNode::on_configure() {
  const auto begin = std::chrono::steady_clock::now();
  configure();
  const auto beats =
      keep(heartbeat_, Heartbeat::create(node(), options_.wall(kHeartbeatPeriodSec)));
  if (!beats) {
    node().log(Severity::kError, beats.error());
    return TransitionResult::kFailure;
  }
  nap(options_.wall(traits_.configure_sec) - (std::chrono::steady_clock::now() - begin));
  clear(traits_.cleared_by_configure);
  return TransitionResult::kSuccess;
}

TransitionResult ManagedNode::on_activate() {
  clear(traits_.cleared_by_activate);
  if (auto activated = activate(); !activated) {
    node().log(Severity::kError, activated.error());
    deactivate();
    return TransitionResult::kFailure;
  }
  return TransitionResult::kSuccess;
}

TransitionResult ManagedNode::on_deactivate() {
  deactivate();
  return TransitionResult::kSuccess;
}

TransitionResult ManagedNode::on_release() {
  deactivate();
  heartbeat_.reset();
  return TransitionResult::kSuccess;
}

TransitionResult ManagedNode::on_shutdown() {
  tasks_->post_at(ros2::Executor::Clock::now() + options_.wall(kFarewellSec),
                  [this] { node().context().executor().stop(); });
  return on_release();
}

}  // namespace culprit::sunset
