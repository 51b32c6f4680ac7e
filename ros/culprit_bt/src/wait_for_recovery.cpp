#include "culprit_bt/wait_for_recovery.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <utility>

#include "ports.h"

namespace culprit_bt {
namespace {

// Beyond that a number of seconds is a mistake, or no number.
constexpr double kLongest_s = 30.0 * 24 * 3600;
// culprit says itself that the time is over; after this it is said here.
constexpr std::chrono::seconds kGrace{2};

double seconds(const BT::TreeNode& leaf, const std::string& port) {
  const double value = input<double>(leaf, port);
  if (!(value >= 0 && value <= kLongest_s))
    throw BT::RuntimeError(leaf.name(), ": port ", port, ": write seconds, 0 to 2592000");
  return value;
}

builtin_interfaces::msg::Duration message_of(std::chrono::nanoseconds time) {
  builtin_interfaces::msg::Duration message;
  message.sec = static_cast<std::int32_t>(time.count() / 1'000'000'000);
  message.nanosec = static_cast<std::uint32_t>(time.count() % 1'000'000'000);
  return message;
}

}  // namespace

// Callbacks may come after the leaf has forgotten it: it is theirs, too.
struct WaitForRecovery::Goal {
  using Handle = rclcpp_action::ClientGoalHandle<Action>;

  struct News {
    bool is_refused = false;
    std::optional<Handle::WrappedResult> result;
    std::optional<Action::Feedback> feedback;
  };

  std::mutex mutex;
  News news;
  Handle::SharedPtr handle;  // null: no answer yet
  bool is_given_up = false;
};

WaitForRecovery::WaitForRecovery(const std::string& name, const BT::NodeConfig& config)
    : BT::StatefulActionNode(name, config),
      culprit_(Culprit::of(config, input<std::string>(*this, "culprit"))),
      client_(rclcpp_action::create_client<Action>(culprit_->thread().shared_node(),
                                                   culprit_->name() + "/wait_for_recovery",
                                                   culprit_->thread().group())) {}

WaitForRecovery::~WaitForRecovery() { give_up(); }

BT::PortsList WaitForRecovery::providedPorts() {
  return with_common_ports(
      {BT::InputPort<double>("timeout", 0.0, "seconds; 0: as long as it takes"),
       BT::InputPort<double>("unreachable", 10.0,
                             "seconds for which culprit may not be reached, while it is started"),
       BT::OutputPort<std::string>("doing", "what is wrong and what is done about it"),
       BT::OutputPort<bool>("needs_person", "culprit cannot help itself, or waits for approval"),
       BT::OutputPort<std::string>("reason", "why it failed; empty if it did not")});
}

BT::NodeStatus WaitForRecovery::onStart() {
  component_ = input<std::string>(*this, "component");
  unreachable_ = std::chrono::duration<double>(seconds(*this, "unreachable"));
  const double timeout = seconds(*this, "timeout");
  reached_ = Clock::now();
  ends_ = timeout == 0 ? Clock::time_point::max()
                       : reached_ + std::chrono::duration_cast<Clock::duration>(
                                        std::chrono::duration<double>(timeout));
  setOutput("reason", std::string());
  setOutput("doing", std::string());
  setOutput("needs_person", false);
  return onRunning();
}

BT::NodeStatus WaitForRecovery::onRunning() {
  Goal::News news;
  if (goal_) {
    const std::scoped_lock lock(goal_->mutex);
    news = goal_->news;
    goal_->news.feedback.reset();
  }
  if (news.is_refused) return fail(culprit_->name() + " refused to be waited for");
  if (news.feedback) {
    setOutput("doing", news.feedback->doing);
    setOutput("needs_person", news.feedback->needs_person);
  }
  if (news.result) {
    if (news.result->code == rclcpp_action::ResultCode::SUCCEEDED &&
        news.result->result->recovered) {
      goal_.reset();
      return BT::NodeStatus::SUCCESS;
    }
    const bool is_canceled = news.result->code == rclcpp_action::ResultCode::CANCELED;
    return fail(is_canceled ? "somebody canceled the waiting" : news.result->result->message);
  }

  const auto now = Clock::now();
  const Knowledge known = culprit_->knowledge();
  // Another culprit does not answer the goal of this one.
  if (goal_ && (!known.status || known.life != life_)) give_up();
  const bool is_reached = known.status && client_->action_server_is_ready();
  if (is_reached) {
    reached_ = now;
    if (!goal_ && now < ends_) send(known.life);
  } else if (now - reached_ > unreachable_) {
    return fail(known.status ? culprit_->name() + " does not offer ~/wait_for_recovery"
                             : known.why_not);
  } else if (!known.status) {
    setOutput("doing", known.why_not);
  }
  const auto grace = goal_ ? kGrace : std::chrono::seconds(0);
  if (ends_ != Clock::time_point::max() && now >= ends_ + grace)
    return fail("the time is over" + (known.status ? "" : ": " + known.why_not));
  return BT::NodeStatus::RUNNING;
}

void WaitForRecovery::onHalted() { give_up(); }

void WaitForRecovery::send(std::uint64_t life) {
  Action::Goal request;
  request.component = component_;
  if (ends_ != Clock::time_point::max()) {
    // Zero would be as long as it takes.
    request.timeout = message_of(
        std::max<std::chrono::nanoseconds>(ends_ - Clock::now(), std::chrono::milliseconds(1)));
  }
  auto goal = std::make_shared<Goal>();
  std::weak_ptr<rclcpp_action::Client<Action>> client = client_;
  rclcpp_action::Client<Action>::SendGoalOptions options;
  options.goal_response_callback = [goal, client](Goal::Handle::SharedPtr handle) {
    const std::scoped_lock lock(goal->mutex);
    goal->handle = handle;
    goal->news.is_refused = handle == nullptr;
    const auto asks = client.lock();
    if (goal->is_given_up && handle && asks) asks->async_cancel_goal(handle);
  };
  options.feedback_callback = [goal](Goal::Handle::SharedPtr,
                                     std::shared_ptr<const Action::Feedback> feedback) {
    const std::scoped_lock lock(goal->mutex);
    goal->news.feedback = *feedback;
  };
  options.result_callback = [goal](const Goal::Handle::WrappedResult& result) {
    const std::scoped_lock lock(goal->mutex);
    goal->news.result = result;
  };
  client_->async_send_goal(request, options);
  life_ = life;
  goal_ = std::move(goal);
}

void WaitForRecovery::give_up() {
  if (!goal_) return;
  Goal::Handle::SharedPtr handle;
  {
    const std::scoped_lock lock(goal_->mutex);
    goal_->is_given_up = true;
    if (!goal_->news.result) handle = goal_->handle;
  }
  goal_.reset();
  if (!handle) return;
  try {
    client_->async_cancel_goal(handle);
  } catch (const rclcpp_action::exceptions::UnknownGoalHandleError&) {
    // It has just ended.
  }
}

BT::NodeStatus WaitForRecovery::fail(const std::string& reason) {
  give_up();
  setOutput("reason", reason);
  RCLCPP_WARN(culprit_->thread().node().get_logger(), "%s: %s", name().c_str(), reason.c_str());
  return BT::NodeStatus::FAILURE;
}

}  // namespace culprit_bt
