#include "exemplars/suave/mission_observer.h"

#include <chrono>

#include "exemplars/suave/model/members.h"

namespace culprit::suave {

Expected<std::unique_ptr<MissionObserver>> MissionObserver::start(
    double speed, const ros2::ParticipantOptions& participant) {
  std::unique_ptr<MissionObserver> observer(new MissionObserver(speed));
  if (auto opened = observer->open(participant); !opened) return Error{opened.error()};
  return observer;
}

MissionObserver::~MissionObserver() {
  executor_.stop();
  if (thread_.joinable()) thread_.join();
}

Expected<void> MissionObserver::open(const ros2::ParticipantOptions& participant) {
  auto context = ros2::Context::create(executor_, participant);
  if (!context) return Error{context.error()};
  context_ = std::move(*context);
  auto node = ros2::Node::create(*context_, {"/", "mission_observer"});
  if (!node) return Error{node.error()};
  node_ = std::move(*node);
  if (auto subscribed = subscribe(); !subscribed) return subscribed;
  thread_ = std::thread([this] { executor_.run(); });
  return {};
}

Expected<void> MissionObserver::subscribe() {
  simulation::World world(0);
  const model::Topics robot(world);  // for the names of its topics
  const auto on = [this]<class Message>(const std::string& topic, const rtps::Qos& qos,
                                        std::function<void(const Message&)> see) -> Expected<void> {
    auto made = node_->create_subscription<Message>(
        topic, qos, [this, see = std::move(see)](const Message& message) {
          const MutexLock lock(mutex_);
          see(message);
        });
    if (!made) return Error{made.error()};
    subscriptions_.push_back(std::move(*made));
    return {};
  };
  using ros2::msg::Bool;
  using ros2::msg::Float32;
  for (auto& subscribed :
       {on(robot.guided.name(), kLatched,
           std::function([this](const Bool&) CULPRIT_REQUIRES(mutex_) {
             if (!begun_) begun_ = ros2::Executor::Clock::now();
             seen_.has_begun = true;
           })),
        on(robot.detected.name(), kLatched,
           std::function([this](const Bool& is_detected) CULPRIT_REQUIRES(mutex_) {
             if (is_detected.data && !seen_.found_s) seen_.found_s = robot_s();
           })),
        on(robot.distance.name(), rtps::qos::kDefault,
           std::function([this](const Float32& metres)
                             CULPRIT_REQUIRES(mutex_) { seen_.inspected_m = metres.data; })),
        on(std::string(topics::kDone), kLatched,
           std::function([this](const Bool&) CULPRIT_REQUIRES(mutex_) {
             if (!seen_.done_s) seen_.done_s = robot_s();
           }))}) {
    if (!subscribed) return subscribed;
  }
  return {};
}

double MissionObserver::robot_s() const {
  if (!begun_) return 0;
  return std::chrono::duration<double>(ros2::Executor::Clock::now() - *begun_).count() * speed_;
}

MissionSeen MissionObserver::seen() const {
  const MutexLock lock(mutex_);
  return seen_;
}

}  // namespace culprit::suave
