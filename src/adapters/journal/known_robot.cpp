#include "journal/known_robot.h"

#include <array>
#include <utility>

namespace culprit::journal {
namespace {

constexpr std::array<std::pair<EndpointKind, const char*>, 4> kKinds = {
    {{EndpointKind::kPublisher, "publishes"},
     {EndpointKind::kSubscriber, "subscribes"},
     {EndpointKind::kServer, "serves"},
     {EndpointKind::kClient, "uses"}}};

template <class Visit>
void for_each_text(const Json& json, const char* key, Visit visit) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_array()) return;
  for (const Json& each : *found) {
    if (each.is_string()) visit(each.get<std::string>());
  }
}

}  // namespace

Json to_json(const KnownRobot& known) {
  Json json = {{"components", Json::array()},
               {"topics", known.topics},
               {"heard", known.heard},
               {"read", known.read},
               {"whole", known.is_whole}};
  if (!known.publishers.empty()) json["publishers"] = known.publishers;
  for (const KnownRobot::Part& part : known.parts) {
    Json component = {{"name", part.component}, {"node", part.node}};
    for (const auto& [kind, key] : kKinds) {
      for (const KnownRobot::End& end : part.ends) {
        if (end.kind == kind) component[key].push_back(end.name);
      }
    }
    if (part.pid != 0) component["process"] = part.pid;
    if (!part.host.empty()) component["host"] = part.host;
    json["components"].push_back(std::move(component));
  }
  return json;
}

KnownRobot known_robot_from_json(const Json& json) {
  KnownRobot known;
  if (!json.is_object()) return known;
  for_each_text(json, "topics", [&](std::string name) { known.topics.push_back(std::move(name)); });
  for_each_text(json, "heard", [&](std::string name) { known.heard.push_back(std::move(name)); });
  for_each_text(json, "read", [&](std::string name) { known.read.push_back(std::move(name)); });
  known.is_whole = flag_of(json, "whole");
  const auto publishers = json.find("publishers");
  if (publishers != json.end() && publishers->is_object()) {
    for (const auto& [status, node] : publishers->items()) {
      if (node.is_string()) known.publishers.emplace(status, node.get<std::string>());
    }
  }
  const auto components = json.find("components");
  if (components == json.end() || !components->is_array()) return known;
  for (const Json& each : *components) {
    if (!each.is_object()) continue;
    KnownRobot::Part part{text_of(each, "name"),
                          text_of(each, "node"),
                          {},
                          static_cast<int>(integer_of(each, "process")),
                          text_of(each, "host")};
    for (const auto& [kind, key] : kKinds)
      for_each_text(each, key, [&, kind = kind](std::string name) {
        part.ends.push_back({kind, std::move(name)});
      });
    known.parts.push_back(std::move(part));
  }
  return known;
}

Json robot_row(const KnownRobot& known, const Whereabouts& where) {
  Json row = to_json(known);
  row["domain"] = where.domain;
  row["boot"] = where.boot;
  row["text"] = std::to_string(known.parts.size()) + " components were seen in domain " +
                std::to_string(where.domain);
  return row;
}

KnownRobot known_robot_of(const Json& row, const Whereabouts& where) {
  const Whereabouts there{static_cast<int>(integer_of(row, "domain", -1)), text_of(row, "boot")};
  return there == where ? known_robot_from_json(row) : KnownRobot{};
}

}  // namespace culprit::journal
