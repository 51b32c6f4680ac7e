#include "knowledge/named.h"

#include <algorithm>

#include "base/ros_names.h"
#include "language/diagnostic.h"

namespace culprit {
namespace {

class Finder {
 public:
  explicit Finder(const Knowledge& knowledge) : knowledge_(knowledge) {}

  std::vector<Named> find() {
    const RuleSet& rules = knowledge_.rules;
    for (std::size_t c = 0; c < rules.components.size(); ++c)
      add(ComponentId(c), knowledge_.discovered.has(ComponentId(c)));
    for (std::size_t i = 0; i < rules.inputs.size(); ++i) look_at(InputId(i));
    return std::move(found_);
  }

 private:
  void look_at(InputId id) {
    const Input& input = knowledge_.rules[id];
    switch (input.subject()) {
      case Input::Subject::kTopic:
        return add(input.topic, knowledge_.discovered.has(input.topic));
      case Input::Subject::kComponent:
        return;
      case Input::Subject::kParameter:
        return add(input.parameter, knowledge_.components[input.parameter].has_value());
      case Input::Subject::kDiagnostic:
        return add(input.diagnostic, knowledge_.signals[id].known);
      case Input::Subject::kSignal:
        return add(input.signal, is_read(id, input.signal));
    }
  }

  bool is_read(InputId id, SignalId signal) const {
    const auto* field = std::get_if<TopicField>(&knowledge_.rules[signal].source);
    return knowledge_.signals.read_at(id) != kLongAgo ||
           (field != nullptr && knowledge_.discovered.has(field->topic));
  }

  template <class What>
  void add(What what, bool was_seen) {
    const bool is_there = std::any_of(found_.begin(), found_.end(), [&](const Named& each) {
      return each.what == Nameable(what);
    });
    if (!is_there) found_.push_back({what, was_seen});
  }

  const Knowledge& knowledge_;
  std::vector<Named> found_;
};

std::string nearest_node(const Component& component, const DependencyGraph& graph) {
  const std::vector<std::string> nodes = graph.nodes();
  if (!component.node.empty())
    return closest_full_name(component.node, {nodes.begin(), nodes.end()});
  std::vector<std::string_view> own_names;
  for (const std::string& node : nodes)
    own_names.push_back(std::string_view(node).substr(node.rfind('/') + 1));
  const std::string near = closest(component.name, own_names);
  for (std::size_t n = 0; n < nodes.size() && !near.empty(); ++n) {
    if (own_names[n] == near) return nodes[n];
  }
  return "";
}

std::string nearest_topic(const std::string& name, const DependencyGraph& graph) {
  const std::vector<std::string> published = graph.published_topics();
  return closest_full_name(name, {published.begin(), published.end()});
}

std::string nearest_status(const std::string& name, const ReportedNames& heard) {
  std::vector<std::string_view> known;
  for (const StatusHeard& status : heard.statuses) {
    known.push_back(status.name);
    known.push_back(status.hardware_id);
  }
  return closest(name, known);
}

// The nearest key of this status or, if the status was not received, the nearest status. "*": of any.
std::string nearest_key(const std::string& status, const std::string& key,
                        const ReportedNames& heard) {
  std::vector<std::string_view> keys;
  bool is_heard = status == "*";
  for (const StatusHeard& each : heard.statuses) {
    const bool is_it = each.name == status || each.hardware_id == status;
    is_heard |= is_it;
    if (is_it || status == "*") keys.insert(keys.end(), each.keys.begin(), each.keys.end());
  }
  return is_heard ? closest(key, keys) : nearest_status(status, heard);
}

// It may be there, and have no value that a rule could read.
std::string nearest_parameter(const Parameter& parameter, const ReportedNames& heard) {
  const auto listed = heard.parameters.find(parameter.component);
  if (listed == heard.parameters.end()) return "";
  const auto& names = listed->second;
  const std::string near = closest(parameter.name, {names.begin(), names.end()});
  return near == parameter.name ? "" : near;
}

std::string nearest_source(const Signal& signal, const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  if (const auto* field = std::get_if<TopicField>(&signal.source))
    return nearest_topic(rules[field->topic].name, knowledge.graph);
  if (const auto* parameter = std::get_if<ParameterId>(&signal.source))
    return nearest_parameter(rules[*parameter], knowledge.reported_names);
  if (const auto* key = std::get_if<DiagnosticKey>(&signal.source))
    return nearest_key(key->status, key->key, knowledge.reported_names);
  if (std::holds_alternative<GroupId>(signal.source)) return "";
  return nearest_key("*", signal.name, knowledge.reported_names);
}

}  // namespace

std::vector<Named> named_by_rules(const Knowledge& knowledge) { return Finder(knowledge).find(); }

std::string nearest_name(const Nameable& name, const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  if (const auto* component = std::get_if<ComponentId>(&name))
    return nearest_node(rules[*component], knowledge.graph);
  if (const auto* topic = std::get_if<TopicId>(&name))
    return nearest_topic(rules[*topic].name, knowledge.graph);
  if (const auto* signal = std::get_if<SignalId>(&name))
    return nearest_source(rules[*signal], knowledge);
  if (const auto* parameter = std::get_if<ParameterId>(&name))
    return nearest_parameter(rules[*parameter], knowledge.reported_names);
  return nearest_status(rules.diagnostics[std::get<DiagnosticId>(name).index].name,
                        knowledge.reported_names);
}

}  // namespace culprit
