#include "exemplars/suave/bridge.h"

#include <chrono>

#include "exemplars/suave/live_names.h"

namespace culprit::suave {
namespace {

// Text goes as it is, without quotation marks.
std::string text_of(const Value& value) {
  const auto* text = std::get_if<std::string>(&value);
  return text != nullptr ? *text : to_string(value);
}

}  // namespace

Expected<std::unique_ptr<Bridge>> Bridge::create(ros2::Node& node, simulation::World& world) {
  auto diagnostics = node.create_publisher<ros2::msg::DiagnosticArray>(topics::kDiagnostics);
  if (!diagnostics) return Error{diagnostics.error()};
  return std::unique_ptr<Bridge>(new Bridge(node, world, std::move(*diagnostics)));
}

Bridge::Bridge(ros2::Node& node, simulation::World& world,
               ros2::Publisher<ros2::msg::DiagnosticArray> diagnostics)
    : node_(node), world_(world), diagnostics_(std::move(diagnostics)) {
  world_.watch(*this);
}

Bridge::~Bridge() { world_.unwatch(*this); }

void Bridge::on_field(const simulation::TopicBase& topic, const std::string&, const Value& value) {
  const auto carried = carried_.find(&topic);
  if (carried != carried_.end()) carried->second(value);
}

void Bridge::on_diagnostic(std::string_view status, std::string_view key, const Value& value) {
  publish({0, std::string(status), "", "", {{std::string(key), text_of(value)}}});
}

void Bridge::on_level(std::string_view status, std::uint8_t level) {
  publish({level, std::string(status), "", "", {}});
}

void Bridge::publish(ros2::msg::DiagnosticStatus status) {
  ros2::msg::DiagnosticArray array;
  array.header.stamp = ros2::msg::to_time(std::chrono::system_clock::now());
  array.status.push_back(std::move(status));
  diagnostics_.publish(array);
}

}  // namespace culprit::suave
