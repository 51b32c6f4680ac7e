#include "exemplars/sunset/heartbeat.h"

#include <chrono>
#include <utility>

#include "exemplars/sunset/members.h"

namespace culprit::sunset {

namespace msg = ros2::msg;

Expected<std::unique_ptr<Heartbeat>> Heartbeat::create(ros2::Node& node, Duration period) {
  auto publisher = node.create_publisher<msg::DiagnosticArray>(topics::kDiagnostics);
  if (!publisher) return Error{publisher.error()};
  return std::unique_ptr<Heartbeat>(new Heartbeat(node, std::move(*publisher), period));
}

Heartbeat::Heartbeat(ros2::Node& node, ros2::Publisher<msg::DiagnosticArray> publisher,
                     Duration period)
    : name_(node.name().name),
      publisher_(std::move(publisher)),
      timer_(node.context().executor(), period, [this] { beat(); }) {}

void Heartbeat::set(std::string key, std::string value) {
  std::erase_if(values_, [&](const msg::KeyValue& each) { return each.key == key; });
  values_.push_back({std::move(key), std::move(value)});
}

void Heartbeat::beat() {
  msg::DiagnosticArray array;
  array.header.stamp = msg::to_time(std::chrono::system_clock::now());
  array.status.push_back({.level = 0,
                          .name = name_ + "_heartbeat",
                          .message = {},
                          .hardware_id = name_,
                          .values = std::exchange(values_, {})});
  publisher_.publish(array);
}

}  // namespace culprit::sunset
