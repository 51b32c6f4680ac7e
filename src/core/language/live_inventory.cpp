#include "language/live_inventory.h"

#include <algorithm>

#include "base/ros_names.h"
#include "base/tool_names.h"

namespace culprit {
namespace {

using Status = LiveInventory::Status;

const std::string* value_of_key(const Status& status, const std::string& key) {
  const auto found = status.values.find(key);
  return found == status.values.end() ? nullptr : &found->second;
}

// A key of this name, or "<hardware id>_<key>" or "<status name>_<key>" as one name.
const std::string* looked_up(const Status& status, const std::string& name) {
  if (const std::string* value = value_of_key(status, name)) return value;
  for (const std::string& prefix : {status.name + "_", status.hardware_id + "_"}) {
    if (!name.starts_with(prefix)) continue;
    if (const std::string* value = value_of_key(status, name.substr(prefix.size()))) return value;
  }
  return nullptr;
}

}  // namespace

bool LiveInventory::has_robot() const {
  return std::any_of(nodes.begin(), nodes.end(), [](const auto& entry) {
    return !own_name(entry.first).starts_with('_') && !is_culprits_node(entry.first);
  });
}

std::string LiveInventory::node_of(const Component& component) const {
  if (!component.node.empty()) return nodes.contains(component.node) ? component.node : "";
  const auto found = std::find_if(nodes.begin(), nodes.end(), [&](const auto& entry) {
    return own_name(entry.first) == component.name;
  });
  return found == nodes.end() ? "" : found->first;
}

std::optional<Value> LiveInventory::value_of(const Signal& signal, const RuleSet& rules) const {
  if (const auto* field = std::get_if<TopicField>(&signal.source)) {
    const auto topic = topics.find(rules[field->topic].name);
    if (topic == topics.end()) return std::nullopt;
    const auto value = topic->second.fields.find(field->field);
    return value == topic->second.fields.end() ? std::nullopt : std::optional(value->second);
  }
  if (const auto* parameter = std::get_if<ParameterId>(&signal.source)) {
    const Parameter& wanted = rules[*parameter];
    return value_of_parameter(node_of(rules[wanted.component]), wanted.name);
  }
  if (std::holds_alternative<GroupId>(signal.source)) return std::nullopt;  // it is of many nodes
  for (const Status& status : diagnostics) {
    const auto* declared = std::get_if<DiagnosticKey>(&signal.source);
    const bool is_other = declared != nullptr && !status.is_called(declared->status);
    if (is_other) continue;
    const std::string* text =
        declared != nullptr ? value_of_key(status, declared->key) : looked_up(status, signal.name);
    if (text != nullptr) return value_from_text(*text);
  }
  return std::nullopt;
}

std::optional<Value> LiveInventory::value_of_parameter(const std::string& node,
                                                       const std::string& parameter) const {
  const auto found = nodes.find(node);
  if (found == nodes.end() || !found->second.parameters) return std::nullopt;
  const auto value = found->second.parameters->find(parameter);
  return value == found->second.parameters->end() ? std::nullopt : value->second;
}

bool LiveInterest::includes_node(const std::string& full_name) const {
  return nodes.contains(full_name) || nodes.contains(own_name(full_name));
}

LiveInterest interest_of(const RuleSet& rules) {
  LiveInterest interest;
  for (const Component& component : rules.components) {
    interest.nodes.insert(component.node.empty() ? component.name : component.node);
    interest.nodes.insert(component.other_nodes.begin(), component.other_nodes.end());
  }
  for (const Topic& topic : rules.topics) interest.fields_of_topics[topic.name];
  for (const Signal& signal : rules.signals) {
    if (const auto* field = std::get_if<TopicField>(&signal.source))
      interest.fields_of_topics[rules[field->topic].name].insert(field->field);
  }
  return interest;
}

}  // namespace culprit
