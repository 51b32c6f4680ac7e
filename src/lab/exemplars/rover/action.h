// Servers and clients of ROS 2 actions with one goal at a time, as Nav2's: a new goal replaces the one before, which is
// aborted. All of it happens on the executor's thread.
#pragma once

#include <array>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "exemplars/rover/messages.h"
#include "ros2/node.h"

namespace culprit::rover {

using GoalId = std::array<std::uint8_t, 16>;

template <class Action>
struct ActionTypes {
  static std::string name(const char* part) { return std::string(Action::kType) + part; }

  struct SendGoal {
    static inline const std::string kType = name("_SendGoal");
    struct Request {
      GoalId id{};
      typename Action::Goal goal;
      static void visit(auto& self, auto& each) { each(self.id, self.goal); }
    };
    struct Response {
      bool accepted = false;
      msg::Time stamp;
      static void visit(auto& self, auto& each) { each(self.accepted, self.stamp); }
    };
  };
  struct GetResult {
    static inline const std::string kType = name("_GetResult");
    struct Request {
      GoalId id{};
      static void visit(auto& self, auto& each) { each(self.id); }
    };
    struct Response {
      std::int8_t status = 0;
      typename Action::Result result;
      static void visit(auto& self, auto& each) { each(self.status, self.result); }
    };
  };
  struct Feedback {
    static inline const std::string kType = name("_FeedbackMessage");
    GoalId id{};
    typename Action::Feedback feedback;
    static void visit(auto& self, auto& each) { each(self.id, self.feedback); }
  };
};

struct CancelGoal {
  static constexpr std::string_view kType = "action_msgs/srv/CancelGoal";
  struct Request {
    ros2::msg::GoalInfo goal_info;
    static void visit(auto& self, auto& each) { each(self.goal_info); }
  };
  struct Response {
    std::int8_t return_code = 0;
    std::vector<ros2::msg::GoalInfo> goals_canceling;
    static void visit(auto& self, auto& each) { each(self.return_code, self.goals_canceling); }
  };
};

// action_msgs/msg/GoalStatus
enum class Status : std::int8_t { kExecuting = 2, kSucceeded = 4, kCanceled = 5, kAborted = 6 };

inline constexpr rtps::Qos kStatusQos{.durability = rtps::Durability::kTransientLocal, .depth = 1};

template <class Action>
class ActionServer {
  using Types = ActionTypes<Action>;

 public:
  using Goal = typename Action::Goal;
  using Result = typename Action::Result;
  // Whether a goal is accepted; the server works on it from then on.
  using Accept = std::function<bool(const Goal&)>;

  ActionServer(std::string name, Accept accept)
      : name_(std::move(name)), accept_(std::move(accept)) {}

  Expected<void> open(ros2::Node& node) {
    auto send = node.create_service<typename Types::SendGoal>(
        part("send_goal"), [this](const auto& request) { return begin(request); });
    if (!send) return Error{send.error()};
    auto cancel = node.create_service<CancelGoal>(part("cancel_goal"), [this](const auto&) {
      CancelGoal::Response response;
      if (is_running()) response.goals_canceling.push_back(goals_.back().info);
      is_cancelled_ = is_running();
      return response;
    });
    if (!cancel) return Error{cancel.error()};
    auto result = ros2::ServiceServer::create_slow(
        node.entry(), {part("get_result"), Types::GetResult::kType}, rtps::qos::kServices,
        [this](rtps::ByteView request, const ros2::ServiceServer::Answer& answer) {
          if (const auto asked = rtps::decode<typename Types::GetResult::Request>(request))
            wait_for_result(asked->id, answer);
        });
    if (!result) return Error{result.error()};
    for (auto* each : {&*send, &*cancel, &*result}) services_.push_back(std::move(*each));
    auto status = node.create_publisher<ros2::msg::GoalStatusArray>(part("status"), kStatusQos);
    if (!status) return Error{status.error()};
    status_.emplace(std::move(*status));
    auto feedback = node.create_publisher<typename Types::Feedback>(part("feedback"));
    if (!feedback) return Error{feedback.error()};
    feedback_.emplace(std::move(*feedback));
    return {};
  }

  bool is_running() const { return !goals_.empty() && goals_.back().status == Status::kExecuting; }
  // The client wants the goal to end; the server ends it with Status::kCanceled.
  bool is_cancelled() const { return is_cancelled_; }
  // Ends the goal that runs; without one it does nothing.
  void end(Status status, const Result& result = {}) {
    if (!is_running()) return;
    Kept& goal = goals_.back();
    goal.status = status;
    goal.result = result;
    is_cancelled_ = false;
    for (const auto& answer : std::exchange(goal.waiting, {})) answer(response(goal));
    publish_status();
  }
  void feed_back(const typename Action::Feedback& feedback) {
    if (is_running()) feedback_->publish({goals_.back().info.goal_id, feedback});
  }

 private:
  static constexpr std::size_t kMostKept = 5;
  struct Kept {
    ros2::msg::GoalInfo info;
    Status status = Status::kExecuting;
    Result result{};
    std::vector<ros2::ServiceServer::Answer> waiting{};
  };

  std::string part(const char* which) const { return name_ + "/_action/" + which; }

  typename Types::SendGoal::Response begin(const typename Types::SendGoal::Request& request) {
    const msg::Time stamp = ros2::msg::to_time(std::chrono::system_clock::now());
    for (const Kept& goal : goals_) {  // a request that came twice
      if (goal.info.goal_id == request.id) return {true, goal.info.stamp};
    }
    const bool was_running = is_running();
    if (!accept_(request.goal)) return {false, stamp};
    if (was_running) end(Status::kAborted);
    if (goals_.size() == kMostKept) goals_.pop_front();
    goals_.push_back({.info = {request.id, stamp}});
    is_cancelled_ = false;
    publish_status();
    return {true, stamp};
  }

  void wait_for_result(const GoalId& id, const ros2::ServiceServer::Answer& answer) {
    for (Kept& goal : goals_) {
      if (goal.info.goal_id != id) continue;
      if (goal.status != Status::kExecuting) return answer(response(goal));
      if (goal.waiting.size() < kMostKept) goal.waiting.push_back(answer);
      return;
    }
    answer(rtps::encode(typename Types::GetResult::Response{}));
  }

  static rtps::Bytes response(const Kept& goal) {
    return rtps::encode(
        typename Types::GetResult::Response{static_cast<std::int8_t>(goal.status), goal.result});
  }

  void publish_status() {
    ros2::msg::GoalStatusArray all;
    for (const Kept& goal : goals_)
      all.status_list.push_back({goal.info, static_cast<std::int8_t>(goal.status)});
    status_->publish(all);
  }

  const std::string name_;
  const Accept accept_;
  std::deque<Kept> goals_;  // the last one is the newest
  bool is_cancelled_ = false;
  std::optional<ros2::Publisher<ros2::msg::GoalStatusArray>> status_;
  std::optional<ros2::Publisher<typename Types::Feedback>> feedback_;
  std::vector<std::unique_ptr<ros2::ServiceServer>> services_;
};

template <class Action>
class ActionClient {
  using Types = ActionTypes<Action>;

 public:
  // How the goal ended; nothing: no server accepted it in time.
  using Done = std::function<void(std::optional<Status>, const typename Action::Result&)>;

  explicit ActionClient(std::string name) : name_(std::move(name)) {}

  Expected<void> open(ros2::Node& node) {
    auto send = node.create_client<typename Types::SendGoal>(name_ + "/_action/send_goal");
    if (!send) return Error{send.error()};
    auto result = node.create_client<typename Types::GetResult>(name_ + "/_action/get_result");
    if (!result) return Error{result.error()};
    auto cancel = node.create_client<CancelGoal>(name_ + "/_action/cancel_goal");
    if (!cancel) return Error{cancel.error()};
    send_ = std::move(*send);
    result_ = std::move(*result);
    cancel_ = std::move(*cancel);
    auto status = node.create_subscription<ros2::msg::GoalStatusArray>(
        name_ + "/_action/status", kStatusQos, [this](const auto& all) { on_status(all); });
    if (!status) return Error{status.error()};
    status_ = std::move(*status);
    random_.seed(std::random_device{}());
    return {};
  }

  // Replaces a goal that runs; nothing more is heard of that one.
  void send(const typename Action::Goal& goal, Done done) {
    id_ = {};
    for (std::uint8_t& byte : id_) byte = static_cast<std::uint8_t>(random_());
    done_ = std::move(done);
    send_->call({id_, goal}, ros2::Repeat::kUntilAnswered, kPatience,
                [this, id = id_](const auto& answer) {
                  if (id == id_ && !(answer.response && answer.response->accepted)) finish({}, {});
                });
  }
  bool is_running() const { return static_cast<bool>(done_); }
  void cancel() {
    if (!is_running()) return;
    done_ = nullptr;
    cancel_->call({}, ros2::Repeat::kUntilAnswered, kPatience, [](const auto&) {});
  }

 private:
  static constexpr Duration kPatience = std::chrono::seconds(2);

  void on_status(const ros2::msg::GoalStatusArray& all) {
    for (const auto& each : all.status_list) {
      if (each.goal_info.goal_id != id_ || !is_running()) continue;
      if (each.status < static_cast<std::int8_t>(Status::kSucceeded)) continue;
      result_->call({id_}, ros2::Repeat::kUntilAnswered, kPatience,
                    [this, id = id_](const auto& answer) {
                      if (id != id_ || !answer.response) return;
                      finish(static_cast<Status>(answer.response->status), answer.response->result);
                    });
    }
  }
  void finish(std::optional<Status> status, const typename Action::Result& result) {
    if (const Done done = std::exchange(done_, nullptr)) done(status, result);
  }

  const std::string name_;
  GoalId id_{};
  Done done_;
  std::mt19937 random_;
  std::unique_ptr<ros2::Client<typename Types::SendGoal>> send_;
  std::unique_ptr<ros2::Client<typename Types::GetResult>> result_;
  std::unique_ptr<ros2::Client<CancelGoal>> cancel_;
  std::unique_ptr<ros2::Subscription> status_;
};

}  // namespace culprit::rover
