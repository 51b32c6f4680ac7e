#include "culprit_bt/request_mode.h"

#include <mutex>
#include <optional>

#include "ports.h"

namespace culprit_bt {
namespace {

constexpr std::chrono::milliseconds kReadEvery{200};

}  // namespace

struct RequestMode::Answers {
  std::mutex mutex;
  std::optional<bool> is_accepted;
  std::optional<std::string> mode;
};

RequestMode::RequestMode(const std::string& name, const BT::NodeConfig& config)
    : BT::StatefulActionNode(name, config), thread_(RosThread::of(config)) {}

BT::PortsList RequestMode::providedPorts() {
  return {BT::InputPort<std::string>("system", "a system or a node of the model"),
          BT::InputPort<std::string>("mode", "that it is to be in"),
          BT::InputPort<double>("timeout", 15.0, "seconds until it is in it; more than 0"),
          BT::OutputPort<std::string>("reason", "why it failed; empty if it did not")};
}

BT::NodeStatus RequestMode::onStart() {
  system_ = input<std::string>(*this, "system");
  mode_ = input<std::string>(*this, "mode");
  const double timeout = input<double>(*this, "timeout");
  if (system_.empty() || mode_.empty())
    throw BT::RuntimeError(name(), ": ports system and mode have to be given");
  if (!(timeout > 0 && timeout <= 24 * 3600))
    throw BT::RuntimeError(name(), ": port timeout: write seconds, more than 0, 86400 at most");
  // As the mode manager has it: names of the model are those of the root namespace.
  if (system_.front() != '/') system_.insert(0, "/");
  rclcpp::Node& node = thread_->node();
  change_ = node.create_client<Change>(system_ + "/change_mode", rmw_qos_profile_services_default,
                                       thread_->group());
  get_ = node.create_client<Get>(system_ + "/get_mode", rmw_qos_profile_services_default,
                                 thread_->group());
  ends_ = Clock::now() +
          std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(timeout));
  read_ = {};
  answers_.reset();
  seen_.clear();
  setOutput("reason", std::string());
  return onRunning();
}

BT::NodeStatus RequestMode::onRunning() {
  const auto now = Clock::now();
  if (!answers_) {
    if (change_->service_is_ready() && get_->service_is_ready()) {
      answers_ = std::make_shared<Answers>();
      auto request = std::make_shared<Change::Request>();
      request->mode_name = mode_;
      change_->async_send_request(
          request, [answers = answers_](rclcpp::Client<Change>::SharedFuture response) {
            const std::scoped_lock lock(answers->mutex);
            answers->is_accepted = response.get()->success;
          });
    }
  } else {
    std::optional<bool> is_accepted;
    {
      const std::scoped_lock lock(answers_->mutex);
      is_accepted = answers_->is_accepted;
      if (answers_->mode) seen_ = *answers_->mode;
    }
    if (is_accepted && !*is_accepted)
      return fail(system_ + " refused mode '" + mode_ +
                  "': has it such a mode, and can it be in it now?");
    if (is_accepted && seen_ == mode_) {
      answers_.reset();
      return BT::NodeStatus::SUCCESS;
    }
    if (is_accepted && now - read_ >= kReadEvery) read_back();
  }
  if (now >= ends_) return fail(why_late());
  return BT::NodeStatus::RUNNING;
}

void RequestMode::onHalted() { answers_.reset(); }

void RequestMode::read_back() {
  read_ = Clock::now();
  get_->prune_pending_requests();
  get_->async_send_request(std::make_shared<Get::Request>(),
                           [answers = answers_](rclcpp::Client<Get>::SharedFuture response) {
                             const std::scoped_lock lock(answers->mutex);
                             answers->mode = response.get()->current_mode;
                           });
}

std::string RequestMode::why_late() const {
  if (!answers_)
    return "no node serves " + system_ +
           "/change_mode: is the name right, and does `culprit modes` run?";
  if (read_ == Clock::time_point()) return system_ + "/change_mode did not answer";
  if (seen_.empty())
    return "mode '" + mode_ + "' was accepted, and no mode of " + system_ + " can be read";
  return "mode '" + mode_ + "' was accepted, and " + system_ + " is in '" + seen_ + "'";
}

BT::NodeStatus RequestMode::fail(const std::string& reason) {
  answers_.reset();
  setOutput("reason", reason);
  RCLCPP_WARN(thread_->node().get_logger(), "%s: %s", name().c_str(), reason.c_str());
  return BT::NodeStatus::FAILURE;
}

}  // namespace culprit_bt
