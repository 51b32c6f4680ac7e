// The file of a healthy robot. Its form is that of version 1 for good: files are kept for years.

#include "doctor/baseline.h"
#include "json/json.h"

namespace culprit::doctor {
namespace {

using Wires = std::map<std::string, Baseline::Wire>;

constexpr int kVersion = 1;
constexpr const char* kMark = "culprit_healthy";

Json to_json(const Wires& wires) {
  Json json = Json::object();
  for (const auto& [name, wire] : wires) json[name] = {{"type", wire.type}, {"qos", wire.qos}};
  return json;
}

Wires to_wires(const Json& json) {
  Wires wires;
  for (const auto& [name, wire] : json.items())
    wires[name] = {wire.at("type").get<std::string>(), wire.at("qos").get<std::string>()};
  return wires;
}

Json to_json(const Baseline::Node& node) {
  return {{"lifecycle", node.lifecycle},          {"memory_bytes", node.memory},
          {"publishes", to_json(node.publishes)}, {"subscribes", to_json(node.subscribes)},
          {"serves", to_json(node.serves)},       {"parameters", node.parameters}};
}

Baseline::Node to_node(const Json& json) {
  return {to_wires(json.at("publishes")),
          to_wires(json.at("subscribes")),
          to_wires(json.at("serves")),
          json.at("parameters").get<std::map<std::string, std::string>>(),
          json.at("lifecycle").get<std::string>(),
          json.at("memory_bytes").get<std::int64_t>()};
}

}  // namespace

std::string to_text(const Baseline& baseline) {
  Json nodes = Json::object();
  for (const auto& [name, node] : baseline.nodes) nodes[name] = to_json(node);
  Json topics = Json::object();
  for (const auto& [name, rate] : baseline.topics)
    topics[name] = {
        {"messages", rate.messages}, {"seconds", rate.seconds}, {"listened_s", rate.listened}};
  const Json document{{kMark, kVersion},
                      {"nodes", std::move(nodes)},
                      {"topics", std::move(topics)},
                      {"transforms", baseline.transforms},
                      {"diagnostics", baseline.statuses}};
  return to_indented(document) + "\n";
}

Expected<Baseline> parse_baseline(const std::string& text) {
  try {
    const Json json = parse_json(text);
    if (!json.is_object() || !json.contains(kMark))
      return Error{"this is not a baseline: culprit doctor --save FILE writes one"};
    if (json.at(kMark) != kVersion)
      return Error{"this baseline is of a newer culprit: save a new one"};
    Baseline baseline;
    for (const auto& [name, node] : json.at("nodes").items()) baseline.nodes[name] = to_node(node);
    for (const auto& [name, rate] : json.at("topics").items())
      baseline.topics[name] = {rate.at("messages").get<std::size_t>(),
                               rate.at("seconds").get<double>(),
                               rate.at("listened_s").get<double>()};
    json.at("transforms").get_to(baseline.transforms);
    json.at("diagnostics").get_to(baseline.statuses);
    return baseline;
  } catch (const Json::exception& wrong) {
    return Error{std::string("this is not a baseline, or a damaged one: ") + wrong.what()};
  }
}

}  // namespace culprit::doctor
