#include "link/other_nodes.h"

#include <algorithm>
#include <utility>

#include "base/tracer.h"
#include "ros2/messages.h"
#include "ros2/services.h"

namespace culprit::link {
namespace {

constexpr Duration kPatience = std::chrono::milliseconds(500);

}  // namespace

void OtherNodes::joined(ComponentId component, const ros2::GraphNode& node) {
  Node& other = nodes_[node.name];
  other.pid = node.pid;
  other.is_there = true;
  if (!other.client) {
    const auto& all = binding_.other_nodes(component);
    const auto place = std::ranges::find(all, node.name) - all.begin();
    other.component = component;
    other.place = static_cast<std::uint8_t>(std::min<std::ptrdiff_t>(place + 1, 127));
    auto client = ros2::ServiceClient::create(
        self_, {node.name + "/get_parameters", std::string(ros2::srv::GetParameters::kType)},
        rtps::qos::kParameterServices);
    if (client) other.client = std::move(*client);
  }
  if (other.client) other.client->ask_only(node.participant);
}

void OtherNodes::left(const std::string& node) {
  if (const auto other = nodes_.find(node); other != nodes_.end()) other->second.is_there = false;
}

void OtherNodes::probe() {
  for (const auto& [name, other] : nodes_) {
    if (!other.is_there || !other.client) continue;
    ask(name, [this, component = other.component, place = other.place,
               pid = other.pid](const std::optional<rtps::GuidPrefix>& answered) {
      const bool is_held = !answered && pid != 0 && is_traced(pid);
      if (!is_held) inbox_.put(Probed{component, answered.has_value(), place});
    });
  }
}

void OtherNodes::ask(const std::string& node,
                     std::function<void(std::optional<rtps::GuidPrefix>)> then) {
  const auto other = nodes_.find(node);
  if (other == nodes_.end() || !other->second.client) return then(std::nullopt);
  other->second.client->call(
      rtps::encode(ros2::srv::GetParameters::Request{}), ros2::Repeat::kUntilAnswered, kPatience,
      [then = std::move(then)](const ros2::CallResult& result) {
        const bool has_answered = result.outcome == ros2::CallOutcome::kAnswered;
        then(has_answered ? std::optional(result.server) : std::nullopt);
      });
}

}  // namespace culprit::link
