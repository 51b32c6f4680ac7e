#include "culprit_bt/culprit.h"

#include <algorithm>
#include <utility>

#include "behaviortree_cpp/blackboard.h"

namespace culprit_bt {

std::shared_ptr<Culprit> Culprit::of(const BT::NodeConfig& config, const std::string& name) {
  BT::Blackboard& blackboard = *config.blackboard->rootBlackboard();
  const std::string key = "culprit_bt_culprit " + name;
  std::shared_ptr<Culprit> culprit;
  if (blackboard.get(key, culprit) && culprit) return culprit;
  culprit = std::make_shared<Culprit>(RosThread::of(config), name);
  blackboard.set(key, culprit);
  return culprit;
}

Culprit::Culprit(std::shared_ptr<RosThread> thread, std::string name)
    : thread_(std::move(thread)),
      name_(std::move(name)),
      why_not_("culprit is not reachable as " + name_ + ": does `culprit run` run?") {
  subscribe();
  rclcpp::Node& node = thread_->node();
  client_ = node.create_client<Ask>(name_ + "/get_parameters", rmw_qos_profile_services_default,
                                    thread_->group());
  timer_ = node.create_wall_timer(
      std::chrono::milliseconds(100),
      [this, alive = callbacks_] { alive->within([this] { look(); }); }, thread_->group());
}

Culprit::~Culprit() { callbacks_->end(); }

void Culprit::subscribe() {
  rclcpp::SubscriptionOptions options;
  options.callback_group = thread_->group();
  subscription_ = thread_->node().create_subscription<Status>(
      name_ + "/status", rclcpp::QoS(1).reliable().transient_local(),
      [this, alive = callbacks_](std::shared_ptr<const Status> status,
                                 const rclcpp::MessageInfo& info) {
        alive->within([&] { heard(std::move(status), info); });
      },
      options);
}

Knowledge Culprit::knowledge() const {
  const std::scoped_lock lock(mutex_);
  if (status_ && answers_) return {status_, "", life_};
  if (answers_) return {nullptr, name_ + " has not told yet how the robot is", life_};
  return {nullptr, why_not_, life_};
}

void Culprit::heard(std::shared_ptr<const Status> status, const rclcpp::MessageInfo& info) {
  const rmw_gid_t& writer = info.get_rmw_message_info().publisher_gid;
  const std::scoped_lock lock(mutex_);
  const bool is_same = writer_ && std::equal(std::begin(writer.data), std::end(writer.data),
                                             std::begin(writer_->data));
  if (!is_same) ++life_;
  writer_ = writer;
  status_ = std::move(status);
  if (!answers_ && !is_silent_) why_not_ = name_ + " has not answered yet";
}

// On the thread of the callbacks.
void Culprit::look() {
  const bool is_there = subscription_->get_publisher_count() > 0;
  const auto now = Clock::now();
  const std::scoped_lock lock(mutex_);
  if (!is_there) {
    is_silent_ = false;
    forget("culprit is not reachable as " + name_ + ": does `culprit run` run?");
  }
  if (is_asked_ && now - asked_ > kPatience) {
    client_->remove_pending_request(request_);
    is_asked_ = false;
    // If it goes on, what it told last may still hold, and it does not tell that again; if another one takes
    // its place, it does not hold. A new subscription is told by whoever is there.
    if (status_) subscribe();
    is_silent_ = true;
    forget(name_ + " does not answer: it was killed, is stopped, or cannot be reached");
  }
  const bool is_due = !answers_ || now - asked_ >= kAskEvery;
  if (is_asked_ || !is_there || !is_due || !client_->service_is_ready()) return;
  is_asked_ = true;
  asked_ = now;
  const auto asked =
      client_->async_send_request(std::make_shared<Ask::Request>(),
                                  [this, alive = callbacks_](rclcpp::Client<Ask>::SharedFuture) {
                                    alive->within([this] {
                                      const std::scoped_lock answered(mutex_);
                                      is_asked_ = false;
                                      answers_ = true;
                                      is_silent_ = false;
                                    });
                                  });
  request_ = asked.request_id;
}

void Culprit::forget(std::string why_not) {
  answers_ = false;
  status_.reset();
  why_not_ = std::move(why_not);
}

}  // namespace culprit_bt
