#include "exemplars/suave/function_process.h"

namespace culprit::suave {
namespace {

using namespace std::chrono_literals;

constexpr Duration kComingUp = 2s;  // of the model's node; the process has come up already

std::string node_of(Function function) {
  switch (function) {
    case Function::kSearch:
      return model::nodes::kSearch;
    case Function::kFollow:
      return model::nodes::kFollow;
    case Function::kMotion:
      return model::nodes::kMotion;
    case Function::kRecharge:
      return model::nodes::kRecharge;
  }
  return "";
}

}  // namespace

FunctionProcess::FunctionProcess(Function function, NodeOptions options,
                                 const model::Generation& generation)
    : function_(function),
      options_(options),
      generation_(generation),
      world_(options.seed),
      model_topics_(world_) {}

std::unique_ptr<simulation::Node> FunctionProcess::make() {
  switch (function_) {
    case Function::kSearch:
      return std::make_unique<model::SearchNode>(world_, generation_, *helm_);
    case Function::kFollow:
      return std::make_unique<model::FollowNode>(world_, model_topics_, generation_, *helm_);
    case Function::kMotion:
      return std::make_unique<model::MotionNode>(world_, generation_, *helm_);
    case Function::kRecharge:
      return std::make_unique<model::RechargeNode>(world_, generation_, *helm_);
  }
  return nullptr;
}

Expected<void> FunctionProcess::open(ros2::Context& context) {
  if (auto opened = open_node(context); !opened) return opened;
  node_ = make();
  node_->launch();
  world_.run(later(world_.now(), kComingUp));
  if (auto declared = declare_parameters(); !declared) return declared;
  pace_.emplace(context.executor(), world_, options_, PacedWorld::kTick,
                [this] { begin_if_ready(); });
  tasks_.emplace(context.executor());
  tasks_->post([this] { managed_->trigger(ros2::TransitionId::kConfigure); });
  return {};
}

Expected<void> FunctionProcess::open_node(ros2::Context& context) {
  ros2::LifecycleCallbacks callbacks;
  callbacks.on_activate = [this] { return activate(); };
  callbacks.on_deactivate = [this] { return deactivate(); };
  auto managed = ros2::LifecycleNode::create(context, {"/", node_of(function_).substr(1)},
                                             std::move(callbacks));
  if (!managed) return Error{managed.error()};
  managed_ = std::move(*managed);
  auto bridge = Bridge::create(managed_->node(), world_);
  if (!bridge) return Error{bridge.error()};
  bridge_ = std::move(*bridge);
  auto helm = LiveHelm::create(managed_->node());
  if (!helm) return Error{helm.error()};
  helm_ = std::move(*helm);
  if (function_ != Function::kFollow) return {};
  for (auto& carried : {bridge_->carry<ros2::msg::Float32>(model_topics_.distance),
                        bridge_->carry<ros2::msg::Bool>(model_topics_.inspected, kLatched)}) {
    if (!carried) return carried;
  }
  return {};
}

Expected<void> FunctionProcess::declare_parameters() {
  auto& parameters = managed_->node().parameters();
  if (function_ != Function::kSearch)
    return parameters.declare(kModeMarker, Value(std::string(model::modes::kDefault)));
  auto declared = parameters.declare(model::kAltitude, *node_->parameter(model::kAltitude));
  if (!declared) return declared;
  parameters.on_set([this](std::span<const ros2::msg::Parameter> changes) -> Expected<void> {
    for (const ros2::msg::Parameter& change : changes)
      if (change.name == model::kAltitude)
        node_->set_parameter(change.name, Value(change.value.double_value));
    return {};
  });
  return {};
}

ros2::TransitionResult FunctionProcess::activate() {
  is_wanted_ = true;
  pace_->catch_up();
  begin_if_ready();
  return ros2::TransitionResult::kSuccess;
}

ros2::TransitionResult FunctionProcess::deactivate() {
  is_wanted_ = false;
  pace_->catch_up();
  change(Transition::kDeactivate);
  return ros2::TransitionResult::kSuccess;
}

// Following begins with the path, and word of that may come later than the order to follow.
void FunctionProcess::begin_if_ready() {
  const bool is_ready = function_ != Function::kFollow || helm_->found();
  if (is_wanted_ && is_ready && !node_->is_active()) change(Transition::kActivate);
}

// On the model's executor, as a request: what the node posts meanwhile waits for the change.
void FunctionProcess::change(Transition transition) {
  node_->post([this, transition] { node_->change(transition); });
}

}  // namespace culprit::suave
