#include "exemplars/rover/rover_node.h"

#include <algorithm>
#include <cstdlib>
#include <thread>
#include <unistd.h>

#include "exemplars/rover/geometry.h"

namespace culprit::rover {

using ros2::Severity;
using ros2::TransitionResult;

RoverNode::RoverNode(Settings settings, Traits traits)
    : traits_(std::move(traits)), settings_(std::move(settings)) {}

RoverNode::~RoverNode() = default;

Expected<void> RoverNode::open(ros2::Context& context) {
  auto name = ros2::parse_node_name(settings_.node);
  if (!name) return Error{name.error()};
  if (settings_.is_managed) {
    if (auto opened = open_managed(context, *name); !opened) return opened;
  } else {
    auto made = ros2::Node::create(context, *name);
    if (!made) return Error{made.error()};
    plain_ = std::move(*made);
  }
  if (auto declared = declare_parameters(); !declared) return declared;
  offer(diagnostics_, "/diagnostics");
  diagnoses_.emplace(executor(), 1s, [this] { diagnose(); });
  if (!settings_.is_managed) set_up();
  return trouble_.empty() ? Expected<void>() : Error{trouble_};
}

Expected<void> RoverNode::open_managed(ros2::Context& context, ros2::NodeName name) {
  auto made = ros2::LifecycleNode::create(context, std::move(name),
                                          {.on_configure = [this] { return configure(); },
                                           .on_cleanup = [this] { return release(); },
                                           .on_activate = [this] { return activate(); },
                                           .on_deactivate = [this] { return deactivate(); },
                                           .on_shutdown = [this] { return release(); },
                                           .on_error = [this] { return release(); }});
  if (!made) return Error{made.error()};
  managed_ = std::move(*made);
  offer(bond_, "/bond");
  // As Nav2's servers, which hear all bonds, and only look for their own.
  auto bonds = note(node().create_subscription<msg::BondStatus>("/bond", rtps::qos::kDefault,
                                                                [](const auto&) {}));
  if (bonds) bonds_ = std::move(*bonds);
  return {};
}

Expected<void> RoverNode::declare_parameters() {
  ros2::ParameterStore& parameters = node().parameters();
  if (auto done = parameters.declare("fault", Value("")); !done) return done;
  for (const auto& [name, value] : traits_.parameters) {
    const bool is_changed = name == settings_.changed.first;
    const Value& at_start = is_changed ? Value(settings_.changed.second) : value;
    if (auto done = parameters.declare(name, at_start); !done) return done;
  }
  parameters.on_set([this](std::span<const ros2::msg::Parameter> changes) -> Expected<void> {
    for (const ros2::msg::Parameter& change : changes) {
      if (auto agreed = on_set(change); !agreed) return agreed;
    }
    return {};
  });
  // A crash or a hang comes after the answer that the parameter is set.
  suffers_.emplace(executor(), 200ms, [this] { suffer(); });
  return {};
}

void RoverNode::suffer() {
  if (has("crash")) std::_Exit(1);
  while (has("hang")) std::this_thread::sleep_for(1h);
  if (has("leak")) leaked_.emplace_back(4'000'000, 'x');
}

void RoverNode::every(Duration period, std::function<void()> callback) {
  timers_.push_back(
      std::make_unique<ros2::Timer>(executor(), period, [this, callback = std::move(callback)] {
        if (is_active()) callback();
      }));
}

TransitionResult RoverNode::configure() {
  trouble_.clear();
  set_up();
  if (trouble_.empty()) return TransitionResult::kSuccess;
  node().log(Severity::kError, trouble_);
  release();
  return TransitionResult::kFailure;
}

TransitionResult RoverNode::activate() {
  const auto fault = parameter<std::string>("fault");
  if (std::ranges::find(traits_.cleared_by_activate, fault) != traits_.cleared_by_activate.end()) {
    const ros2::msg::Parameter none{"fault", ros2::to_parameter_value(Value(""))};
    (void)node().parameters().set({&none, 1});
  }
  if (auto activated = on_activate(); !activated) {
    node().log(Severity::kError, activated.error());
    return TransitionResult::kFailure;
  }
  beats_.emplace(executor(), 1s, [this] { publish_bond(true); });
  publish_bond(true);
  return TransitionResult::kSuccess;
}

TransitionResult RoverNode::deactivate() {
  on_deactivate();
  end_bond();
  return TransitionResult::kSuccess;
}

TransitionResult RoverNode::release() {
  if (beats_) on_deactivate();
  end_bond();
  subscriptions_.clear();
  services_.clear();
  timers_.clear();
  return TransitionResult::kSuccess;
}

void RoverNode::end_bond() {
  if (!beats_) return;
  beats_.reset();
  publish_bond(false);
}

void RoverNode::publish_bond(bool is_whole) {
  bond_->publish({.header = header_now(""),
                  .id = node().name().name,
                  .instance_id = std::to_string(getpid()),
                  .active = is_whole,
                  .heartbeat_timeout = 4,
                  .heartbeat_period = 1});
}

void RoverNode::diagnose() {
  std::vector<ros2::msg::KeyValue> all;
  if (is_active()) all = values();
  if (all.empty()) return;
  diagnostics_->publish({.header = header_now(""),
                         .status = {{.level = 0,
                                     .name = node().name().name,
                                     .message = "",
                                     .hardware_id = "",
                                     .values = std::move(all)}}});
}

}  // namespace culprit::rover
