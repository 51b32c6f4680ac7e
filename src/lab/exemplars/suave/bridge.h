// Publishes on DDS what the nodes of a simulated world publish there: diagnostics, and the chosen
// topics.
#pragma once

#include <functional>
#include <map>
#include <memory>

#include "ros2/node.h"
#include "simulation/topic.h"

namespace culprit::suave {

class Bridge : private simulation::Watcher {
 public:
  // Both outlive the bridge.
  static Expected<std::unique_ptr<Bridge>> create(ros2::Node& node, simulation::World& world);
  ~Bridge() override;

  // The topic's field "data" as std_msgs/Bool, Float32 or String.
  template <class Message>
  Expected<void> carry(simulation::TopicBase& topic, const rtps::Qos& qos = rtps::qos::kDefault) {
    auto made = node_.create_publisher<Message>(topic.name(), qos);
    if (!made) return Error{made.error()};
    auto publisher = std::make_shared<ros2::Publisher<Message>>(std::move(*made));
    topic.set_watched(true);
    topic.watch_field("data");
    carried_[&topic] = [publisher](const Value& value) {
      publisher->publish(message<Message>(value));
    };
    return {};
  }

 private:
  Bridge(ros2::Node& node, simulation::World& world,
         ros2::Publisher<ros2::msg::DiagnosticArray> diagnostics);
  void on_field(const simulation::TopicBase& topic, const std::string& field,
                const Value& value) override;
  void on_diagnostic(std::string_view status, std::string_view key, const Value& value) override;
  void on_level(std::string_view status, std::uint8_t level) override;
  void publish(ros2::msg::DiagnosticStatus status);

  template <class Message>
  static Message message(const Value& value) {
    Message message;
    if constexpr (std::is_same_v<Message, ros2::msg::Float32>) {
      message.data = static_cast<float>(std::get<double>(value));
    } else {
      message.data = std::get<decltype(message.data)>(value);
    }
    return message;
  }

  ros2::Node& node_;
  simulation::World& world_;
  ros2::Publisher<ros2::msg::DiagnosticArray> diagnostics_;
  std::map<const simulation::TopicBase*, std::function<void(const Value&)>> carried_;
};

}  // namespace culprit::suave
