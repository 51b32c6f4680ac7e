#include "exemplars/suave/mission_process.h"

#include "robot/command.h"

namespace culprit::suave {
namespace {

using namespace std::chrono_literals;
namespace srv = ros2::srv;

constexpr Duration kOthersComingUp = 60s;  // of the others
constexpr Duration kAskAgain = 100ms;      // whether a mode is known by now
constexpr Duration kModePatience = 5s;

}  // namespace

MissionProcess::MissionProcess(NodeOptions options, const model::Generation& generation,
                               const model::MissionPlan& plan)
    : options_(options),
      generation_(generation),
      plan_(plan),
      world_(options.seed),
      model_topics_(world_) {}

Expected<void> MissionProcess::open(ros2::Context& context) {
  auto node = ros2::Node::create(context, {"/", std::string(model::nodes::kMission).substr(1)});
  if (!node) return Error{node.error()};
  node_ = std::move(*node);
  auto bridge = Bridge::create(*node_, world_);
  if (!bridge) return Error{bridge.error()};
  bridge_ = std::move(*bridge);
  auto helm = LiveHelm::create(*node_);
  if (!helm) return Error{helm.error()};
  helm_ = std::move(*helm);
  if (auto opened = open_topics(); !opened) return opened;
  auto start = node_->create_client<srv::Trigger>(services::kStart);
  if (!start) return Error{start.error()};
  start_ = std::move(*start);
  tasks_.emplace(context.executor());
  pace_.emplace(context.executor(), world_, options_, PacedWorld::kTick);
  for (const char* system : {model::systems::kSearch, model::systems::kFollow}) {
    if (auto opened = open_modes(system); !opened) return opened;
    wait_for(system);
  }
  return {};
}

Expected<void> MissionProcess::open_topics() {
  auto done = node_->create_publisher<ros2::msg::Bool>(topics::kDone, kLatched);
  if (!done) return Error{done.error()};
  done_.emplace(std::move(*done));
  auto inspected = node_->create_subscription<ros2::msg::Bool>(
      model_topics_.inspected.name(), kLatched, [this](const ros2::msg::Bool&) {
        pace_->catch_up();
        world_.show([this](simulation::Watcher& watcher) {
          watcher.on_field(model_topics_.inspected, "data", true);
        });
      });
  if (!inspected) return Error{inspected.error()};
  inspected_ = std::move(*inspected);
  return bridge_->carry<ros2::msg::String>(model_topics_.task, kLatched);
}

Expected<void> MissionProcess::open_modes(const char* system) {
  const std::string name = system;
  auto client = ros2::ServiceClient::create(
      node_->entry(), {name + "/change_mode", std::string(srv::ChangeMode::kType)},
      rtps::qos::kServices,
      {{name + "/get_mode", std::string(srv::GetMode::kType)},
       rtps::encode(srv::GetMode::Request{})});
  if (!client) return Error{client.error()};
  modes_[name] = std::move(*client);
  return {};
}

// A mode is known when the mode manager is there and has heard of the node.
void MissionProcess::wait_for(const std::string& system) {
  modes_.at(system)->probe()->call(
      rtps::encode(srv::GetMode::Request{}), ros2::Repeat::kUntilAnswered, kOthersComingUp,
      [this, system](const ros2::CallResult& result) {
        const auto response = result.outcome == ros2::CallOutcome::kAnswered
                                  ? rtps::decode<srv::GetMode::Response>(result.reply)
                                  : std::nullopt;
        tasks_->post([this, system, mode = response ? response->current_mode : kUnknownMode] {
          on_mode(system, mode);
        });
      });
}

void MissionProcess::on_mode(const std::string& system, const std::string& mode) {
  if (mode == kUnknownMode) {
    tasks_->post_at(ros2::Executor::Clock::now() + kAskAgain, [this, system] { wait_for(system); });
    return;
  }
  is_ready_[system] = true;
  if (is_ready_.size() < modes_.size() || has_begun_) return;
  has_begun_ = true;
  start_->call({}, ros2::Repeat::kUntilAnswered, kOthersComingUp, [this](const auto& answer) {
    if (answer.response && answer.response->success) begin();
  });
}

void MissionProcess::begin() {
  pace_->catch_up();
  mission_ = std::make_unique<model::Mission>(world_, model_topics_, generation_, plan_,
                                              model::Leader::kMission, world_.now(), *helm_);
  mission_->change_mode = [this](const char* system, const char* mode) {
    change_mode(system, mode);
  };
  mission_->on_end = [this] { done_->publish({true}); };
  mission_->launch();
}

void MissionProcess::change_mode(const char* system, const char* mode) {
  modes_.at(system)->call(
      rtps::encode(srv::ChangeMode::Request{mode}), ros2::Repeat::kNever, kModePatience,
      [this, system = std::string(system)](const ros2::CallResult& result) {
        if (result.outcome == ros2::CallOutcome::kAnswered) return;
        node_->log(ros2::Severity::kError, "the mode of " + system + " was not changed");
      });
}

}  // namespace culprit::suave
