#include "base/process_stat.h"
#include "web/calls.h"

namespace culprit::web {
namespace {

// A component as in the stream.
struct Known {
  std::string node;
  int pid = 0;  // on this machine; 0: it is not known which
};

std::optional<Known> known(http::Hub& hub, const std::string& component) {
  const auto robot = hub.latest(http::Kind::kRobot);
  if (!robot) return std::nullopt;
  const Json components = parse_json(*robot).value("components", Json::array());
  std::size_t place = 0;
  while (place < components.size() && components[place].value("name", "") != component) ++place;
  if (place == components.size()) return std::nullopt;
  Known found{components[place].value("node", ""), 0};
  if (const auto graph = hub.latest(http::Kind::kGraph)) {
    for (const Json& node : parse_json(*graph).value("nodes", Json::array())) {
      if (node.value("component", "") == component) found.node = node.value("node", "");
    }
  }
  if (const auto state = hub.latest(http::Kind::kState)) {
    const Json states = parse_json(*state).value("components", Json::array());
    if (place < states.size()) found.pid = states[place].value("pid", 0);
  }
  return found;
}

std::string_view word_of_level(std::uint8_t level) {
  return level >= 50   ? "fatal"
         : level >= 40 ? "error"
         : level >= 30 ? "warning"
         : level >= 20 ? "info"
                       : "debug";
}

Json to_json(const std::vector<UsageHistory::Usage>& usage) {
  Json list = Json::array();
  for (const UsageHistory::Usage& look : usage)
    list.push_back({{"clock", look.clock}, {"processor", look.processor}, {"memory", look.memory}});
  return list;
}

Json to_json(const std::vector<ros2::msg::Log>& lines) {
  Json list = Json::array();
  for (const ros2::msg::Log& line : lines)
    list.push_back({{"clock", line.stamp.sec + line.stamp.nanosec * 1e-9},
                    {"level", word_of_level(line.level)},
                    {"text", line.msg}});
  return list;
}

http::Answer answer(const Json& query, http::Hub& hub, const UsageHistory& usage, const Look& look,
                    const LogOf& log_of) {
  const auto name = http::text_of(query, "name");
  if (!name) return http::refuse(400, "say which: ?name=camera");
  const auto component = known(hub, *name);
  if (!component) return http::refuse(404, "the rules have no component '" + *name + "'");
  Json json{{"node", component->node},
            {"process", nullptr},
            {"usage", to_json(usage.of(*name))},
            {"parameters", nullptr},
            {"log", Json::array()}};
  if (component->pid != 0) {
    if (const auto stat = process_stat(std::to_string(component->pid)))
      json["process"] = {
          {"pid", component->pid}, {"memory", stat->resident_bytes}, {"threads", stat->threads}};
  }
  if (component->node.empty()) return {200, json};
  const auto log = log_of(component->node);
  if (!log) return http::refuse(503, log.error());
  json["log"] = to_json(*log);
  LiveInterest interest;
  interest.nodes = {component->node};
  const auto inventory = look(interest);
  if (!inventory) return http::refuse(503, inventory.error());
  if (const auto node = inventory->nodes.find(component->node); node != inventory->nodes.end())
    json["parameters"] = parameters_to_json(node->second);
  return {200, json};
}

}  // namespace

http::Route component_route(http::Hub& hub, const UsageHistory& usage, Look look, LogOf log_of) {
  return {http::Method::kGet, "/api/component",
          [&hub, &usage, look = std::move(look), log_of = std::move(log_of)](const Json& query) {
            return answer(query, hub, usage, look, log_of);
          }};
}

}  // namespace culprit::web
