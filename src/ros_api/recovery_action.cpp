#include "ros_api/recovery_action.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "base/live_clock.h"
#include "ros2/names.h"
#include "ros2/publisher.h"
#include "ros2/service_server.h"
#include "ros_api/incident_watch.h"
#include "ros_api/recovery_goals.h"

namespace culprit::ros_api {
namespace {

using Answer = ros2::ServiceServer::Answer;
using Goal = RecoveryGoals::Goal;
using Id = RecoveryGoals::Id;
using State = RecoveryGoals::State;

constexpr const char* kSendGoal = "culprit_msgs/action/WaitForRecovery_SendGoal";
constexpr const char* kGetResult = "culprit_msgs/action/WaitForRecovery_GetResult";
constexpr const char* kFeedback = "culprit_msgs/action/WaitForRecovery_FeedbackMessage";
constexpr const char* kCancelGoal = "action_msgs/srv/CancelGoal";
constexpr const char* kGoalStatuses = "action_msgs/msg/GoalStatusArray";

constexpr std::size_t kMostWaiting = 8;  // for the result of one goal

// action_msgs/srv/CancelGoal
constexpr int kErrorNone = 0;
constexpr int kErrorUnknownGoal = 2;
constexpr int kErrorGoalTerminated = 3;

// rcl_action's: services as such, the topics reliable, and a late joiner gets the newest state of
// all goals.
constexpr rtps::Qos kFeedbackQos{.depth = 10};
// A client of rclcpp takes feedback before answers, and drops what is about a goal that it does not
// know yet: so a goal's first feedback comes so long after the answer that accepts it.
constexpr Duration kUntilKnown = std::chrono::milliseconds(100);
constexpr rtps::Qos kStatusQos{.durability = rtps::Durability::kTransientLocal, .depth = 1};

Id id_in(const Json& uuid) {
  Id id{};
  const Json& bytes = uuid["uuid"];
  for (std::size_t i = 0; i < id.size(); ++i) id[i] = bytes[i].get<std::uint8_t>();
  return id;
}

Json to_uuid(const Id& id) { return {{"uuid", id}}; }

std::chrono::nanoseconds duration_in(const Json& time) {
  return std::chrono::seconds(time["sec"].get<std::int64_t>()) +
         std::chrono::nanoseconds(time["nanosec"].get<std::int64_t>());
}

Json goal_info(const Goal& goal) {
  return {{"goal_id", to_uuid(goal.request.id)}, {"stamp", stamp_of(goal.accepted)}};
}

int number_of(State state) { return static_cast<int>(state); }

}  // namespace

// The action at one node. All of it happens on the executor's thread, but for open() and close().
class RecoveryAction::Offer {
 public:
  Offer(const CulpritTypes& types, ros2::NodeEntry& node)
      : types_(types), node_(node), tasks_(node.context().executor()) {}
  ~Offer() {
    tasks_.close();
    servers_.clear();
  }

  std::vector<std::string> open() {
    serve("send_goal", kSendGoal, [this](const Json& request, const Answer& answer) {
      answer_with(answer, kSendGoal, begin(request));
      tasks_.post_at(ros2::Executor::Clock::now() + kUntilKnown, [this] { follow(); });
    });
    serve("cancel_goal", kCancelGoal, [this](const Json& request, const Answer& answer) {
      answer_with(answer, kCancelGoal, cancel(request));
      tasks_.post([this] { follow(); });
    });
    serve("get_result", kGetResult, [this](const Json& request, const Answer& answer) {
      wait_for_result(id_in(request["goal_id"]), answer);
    });
    feedback_ = publish("feedback", kFeedback, kFeedbackQos);
    statuses_ = publish("status", kGoalStatuses, kStatusQos);
    return std::move(troubles_);
  }

  void told(const Json& status) {
    tasks_.post([this, status] {
      goals_.look(status);
      follow();
    });
  }

 private:
  std::string name_of(const std::string& part) const {
    return "~/wait_for_recovery/_action/" + part;
  }

  using Take = std::function<void(const Json& request, const Answer& answer)>;
  // Invalid requests get no answer: the services of actions have no field for an error.
  void serve(const std::string& part, const char* type_name, Take take) {
    const ServiceType& type = types_.service(type_name);
    const auto name = ros2::resolve_name(name_of(part), node_.name());
    auto server = ros2::ServiceServer::create_slow(
        node_, {*name, type.name}, rtps::qos::kServices,
        [&type, take = std::move(take)](rtps::ByteView request, const Answer& answer) {
          if (const auto read = decode(request, type.request)) take(*read, answer);
        },
        {type.request.hash, type.response.hash, type.hash});
    if (server) {
      servers_.push_back(std::move(*server));
    } else {
      troubles_.push_back("no goals are taken by " + *name + ": " + server.error());
    }
  }

  std::unique_ptr<ros2::RawPublisher> publish(const std::string& part, const char* type_name,
                                              const rtps::Qos& qos) {
    const MessageType& type = types_.message(type_name);
    auto publisher = ros2::RawPublisher::create(node_, name_of(part), type.name, qos, type.hash);
    if (publisher) return std::move(*publisher);
    troubles_.push_back("culprit does not publish " + name_of(part) + ": " + publisher.error());
    return nullptr;
  }

  void answer_with(const Answer& answer, const char* service, const Json& response) const {
    if (auto bytes = encode(response, types_.service(service).response)) answer(std::move(*bytes));
  }

  Json begin(const Json& request) {
    const Json& goal = request["goal"];
    const WallTime wall = std::chrono::system_clock::now();
    const bool is_accepted =
        goals_.begin({id_in(request["goal_id"]), goal["component"], duration_in(goal["timeout"])},
                     live_now(), wall);
    if (is_accepted) goals_.look_again();
    return {{"accepted", is_accepted}, {"stamp", stamp_of(wall)}};
  }

  Json cancel(const Json& request) {
    const Json& info = request["goal_info"];
    const Id id = id_in(info["goal_id"]);
    const WallTime until(
        std::chrono::duration_cast<WallTime::duration>(duration_in(info["stamp"])));
    Json canceled = Json::array();
    for (const Id& each : goals_.cancel(id, until)) {
      if (const Goal* goal = goals_.find(each)) canceled.push_back(goal_info(*goal));
    }
    int code = kErrorNone;
    if (canceled.empty() && id != Id{})
      code = goals_.find(id) == nullptr ? kErrorUnknownGoal : kErrorGoalTerminated;
    return {{"return_code", code}, {"goals_canceling", canceled}};
  }

  void wait_for_result(const Id& id, const Answer& answer) {
    const Goal* goal = goals_.find(id);
    if (goal == nullptr)
      return answer_with(answer, kGetResult, {{"status", number_of(State::kUnknown)}});
    if (goal->state != State::kExecuting) return answer_result(*goal, answer);
    std::vector<Answer>& all = waiting_[id];
    if (all.size() < kMostWaiting) all.push_back(answer);
  }

  void answer_result(const Goal& goal, const Answer& answer) const {
    answer_with(answer, kGetResult, {{"status", number_of(goal.state)}, {"result", goal.result}});
  }

  // Publishes the goals' progress, and waits for the next time limit.
  void follow() {
    goals_.expire(live_now());
    for (const Id& id : goals_.take_news()) {
      const Goal* goal = goals_.find(id);
      if (goal != nullptr && goal->state == State::kExecuting)
        tell(feedback_.get(), kFeedback, {{"goal_id", to_uuid(id)}, {"feedback", goal->feedback}});
    }
    for (const Id& id : goals_.take_ended()) {
      const auto waiting = waiting_.extract(id);
      const Goal* goal = goals_.find(id);
      if (waiting.empty() || goal == nullptr) continue;
      for (const Answer& each : waiting.mapped()) answer_result(*goal, each);
    }
    tell_statuses();
    wait();
  }

  void tell_statuses() {
    Json all = Json::array();
    for (const Goal* goal : goals_.all())
      all.push_back({{"goal_info", goal_info(*goal)}, {"status", number_of(goal->state)}});
    if (all == told_) return;
    told_ = std::move(all);
    tell(statuses_.get(), kGoalStatuses, {{"status_list", told_}});
  }

  void tell(ros2::RawPublisher* publisher, const char* type, const Json& message) const {
    if (publisher == nullptr) return;
    if (const auto bytes = encode(message, types_.message(type))) (void)publisher->publish(*bytes);
  }

  void wait() {
    if (timer_) tasks_.cancel(*timer_);
    timer_.reset();
    if (goals_.due() == kNever) return;
    const auto left = std::max(goals_.due() - live_now(), Duration::zero());
    timer_ = tasks_.post_at(ros2::Executor::Clock::now() + left, [this] {
      timer_.reset();
      follow();
    });
  }

  const CulpritTypes& types_;
  ros2::NodeEntry& node_;
  RecoveryGoals goals_;
  std::map<Id, std::vector<Answer>> waiting_;
  Json told_ = Json::array();  // of all goals, last
  std::optional<ros2::TaskGroup::TimerId> timer_;
  std::vector<std::string> troubles_;

  ros2::TaskGroup tasks_;  // outlives those that post to it
  std::unique_ptr<ros2::RawPublisher> feedback_, statuses_;
  std::vector<std::unique_ptr<ros2::ServiceServer>> servers_;
};

RecoveryAction::RecoveryAction(const CulpritTypes& types) : types_(types) {}
RecoveryAction::~RecoveryAction() = default;

std::vector<std::string> RecoveryAction::open(ros2::NodeEntry& node) {
  offer_ = std::make_unique<Offer>(types_, node);
  return offer_->open();
}

void RecoveryAction::close() { offer_.reset(); }

void RecoveryAction::told(const Json& status) {
  if (offer_) offer_->told(status);
}

}  // namespace culprit::ros_api
