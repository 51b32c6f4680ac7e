#include "live_checks/live_findings.h"

#include <algorithm>
#include <cstdio>

#include "base/joined.h"

namespace culprit::live_checks {
namespace {

constexpr const char* kTick = " ✓";

std::string hertz(double rate) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g Hz", rate);
  return text;
}

std::string of_component(const Component& component, const LiveInventory& robot) {
  const std::string node = robot.node_of(component);
  if (node.empty()) return "";
  const std::string& state = robot.nodes.at(node).lifecycle;
  const std::string& owner = robot.nodes.at(node).owner;
  return component.name + " is " + node + (state.empty() ? "" : ", " + state) +
         (owner.empty() ? "" : ", run by " + owner) + kTick;
}

std::string of_topic(const std::string& name, const LiveInventory& robot) {
  const auto found = robot.topics.find(name);
  if (found == robot.topics.end() || !found->second.is_published()) return "";
  const LiveInventory::Topic& topic = found->second;
  const std::string from = " from " + joined(topic.publishers);
  if (!topic.rate) return name + from + kTick;
  if (*topic.rate == 0) return name + from + ", silent";
  return name + " " + hertz(*topic.rate) + from + kTick;
}

std::string of_signal(const Signal& signal, const RuleSet& rules, const LiveInventory& robot) {
  const auto value = robot.value_of(signal, rules);
  return value ? signal.name + " = " + to_string(*value) + kTick : "";
}

}  // namespace

std::vector<std::string> findings(const RuleSet& rules, const LiveInventory& robot) {
  std::vector<std::string> lines;
  for (const Component& each : rules.components) lines.push_back(of_component(each, robot));
  for (const Topic& each : rules.topics) lines.push_back(of_topic(each.name, robot));
  for (const Signal& each : rules.signals) lines.push_back(of_signal(each, rules, robot));
  std::erase(lines, "");
  return lines;
}

bool is_all_found(const RuleSet& rules, const LiveInventory& robot) {
  const auto told_rate = [&](const Topic& each) {
    const auto topic = robot.topics.find(each.name);
    return topic != robot.topics.end() && topic->second.is_published() &&
           topic->second.rate.value_or(0) > 0;
  };
  return std::all_of(rules.components.begin(), rules.components.end(),
                     [&](const Component& each) { return !robot.node_of(each).empty(); }) &&
         std::all_of(rules.topics.begin(), rules.topics.end(), told_rate) &&
         std::all_of(rules.signals.begin(), rules.signals.end(),
                     [&](const Signal& each) { return robot.value_of(each, rules).has_value(); });
}

}  // namespace culprit::live_checks
