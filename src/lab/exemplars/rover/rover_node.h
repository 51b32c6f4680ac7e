// Base of the rover's nodes: a plain node, or a server that a lifecycle manager drives, with Nav2's bond.
//
// - set_up() creates what the node publishes, hears and offers: of a server when it is configured, of a plain node at its
//   start. Timers and subscriptions call back only while the node is active.
// - The parameter `fault` names a fault that the node shows, for experiments. All nodes know "hang" (its only thread
//   sleeps), "crash", and "leak" (20 MB a second). A new process has none; some are over when the node is activated.
// - Each second it publishes a status on /diagnostics: its state, and what values() adds.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "exemplars/rover/messages.h"
#include "ros2/lifecycle_node.h"
#include "ros2/timer.h"

namespace culprit::rover {

using namespace std::chrono_literals;

struct Settings {
  std::string node{};  // its full name
  bool is_managed = false;
  std::uint64_t seed = 1;
  std::filesystem::path state{};  // folder of what outlives a process; empty: nothing does
  std::pair<std::string, double> changed{};  // a parameter with another default, for experiments
};

class RoverNode {
 public:
  struct Traits {
    std::vector<std::pair<std::string, Value>> parameters{};
    std::vector<std::string> cleared_by_activate{};  // faults
  };

  explicit RoverNode(Settings settings) : RoverNode(std::move(settings), {}) {}
  RoverNode(Settings settings, Traits traits);
  virtual ~RoverNode();
  // The context outlives the node.
  Expected<void> open(ros2::Context& context);
  const std::string& full_name() const { return settings_.node; }

 protected:
  ros2::Node& node() { return managed_ ? managed_->node() : *plain_; }
  ros2::Executor& executor() { return node().context().executor(); }
  const Settings& settings() const { return settings_; }
  bool is_active() const { return !managed_ || managed_->state() == LifecycleState::kActive; }
  bool has(std::string_view fault) { return parameter<std::string>("fault") == fault; }
  template <class T>
  T parameter(std::string_view name) {
    return node().parameters().get<T>(name);
  }

  // For set_up(). If one cannot be created, the node does not come up.
  template <class Message>
  void offer(std::optional<ros2::Publisher<Message>>& place, std::string_view topic,
             const rtps::Qos& qos = rtps::qos::kDefault) {
    place.reset();
    if (auto made = note(node().create_publisher<Message>(topic, qos))) place = std::move(*made);
  }
  template <class Message>
  void hear(std::string_view topic, const rtps::Qos& qos,
            std::function<void(const Message&)> callback) {
    auto made = note(node().create_subscription<Message>(
        topic, qos, [this, callback = std::move(callback)](const Message& message) {
          if (is_active()) callback(message);
        }));
    if (made) subscriptions_.push_back(std::move(*made));
  }
  template <class Service>
  void serve(std::string_view name,
             std::function<typename Service::Response(const typename Service::Request&)> handler) {
    if (auto made = note(node().create_service<Service>(name, std::move(handler))))
      services_.push_back(std::move(*made));
  }
  // An action's server or client, a costmap.
  template <class Part>
  void join(Part& part) {
    (void)note(part.open(node()));
  }
  void every(Duration period, std::function<void()> callback);

 private:
  virtual void set_up() = 0;
  // An error refuses: the node stays inactive.
  virtual Expected<void> on_activate() { return {}; }
  virtual void on_deactivate() {}
  virtual std::vector<ros2::msg::KeyValue> values() { return {}; }
  // A change of a parameter; an error refuses it.
  virtual Expected<void> on_set(const ros2::msg::Parameter&) { return {}; }

  template <class Made>
  Expected<Made> note(Expected<Made> made) {
    if (!made && trouble_.empty()) trouble_ = made.error();
    return made;
  }
  Expected<void> open_managed(ros2::Context& context, ros2::NodeName name);
  Expected<void> declare_parameters();
  ros2::TransitionResult configure();
  ros2::TransitionResult activate();
  ros2::TransitionResult deactivate();
  ros2::TransitionResult release();
  void end_bond();
  void publish_bond(bool is_whole);
  void diagnose();
  void suffer();

  const Traits traits_;
  const Settings settings_;
  std::unique_ptr<ros2::LifecycleNode> managed_;
  std::unique_ptr<ros2::Node> plain_;
  std::string trouble_;  // of the creation of what the node offers
  std::vector<std::unique_ptr<ros2::Subscription>> subscriptions_;
  std::vector<std::unique_ptr<ros2::ServiceServer>> services_;
  std::vector<std::unique_ptr<ros2::Timer>> timers_;

  std::optional<ros2::Publisher<msg::BondStatus>> bond_;
  std::unique_ptr<ros2::Subscription> bonds_;
  std::optional<ros2::Timer> beats_;
  std::optional<ros2::Publisher<ros2::msg::DiagnosticArray>> diagnostics_;
  std::optional<ros2::Timer> diagnoses_;
  std::optional<ros2::Timer> suffers_;
  std::vector<std::string> leaked_;
};

}  // namespace culprit::rover
