#include "lsp/live_hover.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "base/ros_names.h"

namespace culprit::lsp {
namespace {

using OccurrenceKind = Occurrence::Kind;

std::string now(const std::optional<Value>& value) {
  return value ? "Now `" + to_string(*value) + "`." : "";
}

std::string of_signal(const Document& document, const std::string& name,
                      const LiveInventory& robot) {
  if (!document.checked.rules) return "";
  const RuleSet& rules = *document.checked.rules;
  const auto signal = std::find_if(rules.signals.begin(), rules.signals.end(),
                                   [&](const Signal& s) { return s.name == name; });
  return signal == rules.signals.end() ? "" : now(robot.value_of(*signal, rules));
}

std::string of_component(const Document& document, const std::string& name,
                         const LiveInventory& robot) {
  const std::string node = robot.node_of(document.component_called(name));
  if (node.empty()) return "Not on the robot now.";
  const std::string& state = robot.nodes.at(node).lifecycle;
  return "On the robot as `" + node + "`" + (state.empty() ? "" : ", " + state) + ".";
}

std::string of_topic(const Document& document, const Occurrence& thing,
                     const LiveInventory& robot) {
  std::string name = thing.name;
  if (!thing.scope.empty())
    name = topic_of(name, robot.node_of(document.component_called(thing.scope)));
  const auto found = robot.topics.find(name);
  if (found == robot.topics.end()) return "Not on the robot now.";
  const LiveInventory::Topic& topic = found->second;
  std::string text = "`" + topic.type + "`";
  if (!topic.is_published()) return text + ", not published now.";
  if (!topic.rate) return text + ".";
  char rate[32];
  std::snprintf(rate, sizeof rate, ", %.1f Hz now.", *topic.rate);
  return text + rate;
}

std::string of_status(const std::string& name, const LiveInventory& robot) {
  constexpr std::array kLevels = {"OK", "WARN", "ERROR", "STALE"};
  for (const LiveInventory::Status& status : robot.diagnostics) {
    if (status.is_called(name) && status.level < kLevels.size())
      return "Level " + std::to_string(status.level) + " (" + kLevels[status.level] + ") now.";
  }
  return "Not observed on the robot.";
}

std::string of_service(const Document& document, const Occurrence& thing,
                       const LiveInventory& robot) {
  const std::string node = robot.node_of(document.component_called(thing.scope));
  const auto found = robot.services.find(service_of(thing.name, node));
  return found == robot.services.end() ? "Not on the robot now." : "`" + found->second + "`.";
}

}  // namespace

std::string live_facts(const Document& document, const Occurrence& thing,
                       const LiveInventory& robot) {
  switch (thing.kind) {
    case OccurrenceKind::kSignal:
      return of_signal(document, thing.name, robot);
    case OccurrenceKind::kComponent:
      return of_component(document, thing.name, robot);
    case OccurrenceKind::kTopic:
      return of_topic(document, thing, robot);
    case OccurrenceKind::kParameter:
      return now(robot.value_of_parameter(robot.node_of(document.component_called(thing.scope)),
                                          thing.name));
    case OccurrenceKind::kDiagnostic:
      return of_status(thing.name, robot);
    case OccurrenceKind::kService:
      return of_service(document, thing, robot);
    case OccurrenceKind::kConstant:
    case OccurrenceKind::kRule:
    case OccurrenceKind::kStrategy:
    case OccurrenceKind::kFunction:
    case OccurrenceKind::kAction:
    case OccurrenceKind::kTemplate:
    case OccurrenceKind::kHole:
    case OccurrenceKind::kFile:
      break;
  }
  return "";
}

}  // namespace culprit::lsp
