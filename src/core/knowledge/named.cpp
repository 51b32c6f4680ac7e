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
      add(ComponentId(c), knowledge_.sightings.has(ComponentId(c)));
    for (std::size_t i = 0; i < rules.inputs.size(); ++i) look_at(InputId(i));
    return std::move(found_);
  }

 private:
  void look_at(InputId id) {
    const Input& input = knowledge_.rules[id];
    switch (input.kind) {
      case Input::Kind::kRate:
      case Input::Kind::kAge:
      case Input::Kind::kPhi:
        return add(input.topic, knowledge_.sightings.has(input.topic));
      case Input::Kind::kAlive:
      case Input::Kind::kLifecycle:
        return;
      case Input::Kind::kParameter:
        return add(input.parameter, knowledge_.components[input.parameter].has_value());
      case Input::Kind::kLevel:
        return add(input.diagnostic, knowledge_.signals[id].known);
      default:
        return add(input.signal, is_read(id, input.signal));
    }
  }

  bool is_read(InputId id, SignalId signal) const {
    const auto* field = std::get_if<TopicField>(&knowledge_.rules[signal].source);
    return knowledge_.signals.read_at(id) != kLongAgo ||
           (field != nullptr && knowledge_.sightings.has(field->topic));
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

}  // namespace

std::vector<Named> named_by_rules(const Knowledge& knowledge) { return Finder(knowledge).find(); }

std::string nearest_name(const Nameable& name, const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  if (const auto* component = std::get_if<ComponentId>(&name))
    return nearest_node(rules[*component], knowledge.graph);
  if (const auto* topic = std::get_if<TopicId>(&name))
    return nearest_topic(rules[*topic].name, knowledge.graph);
  if (const auto* signal = std::get_if<SignalId>(&name)) {
    const auto* field = std::get_if<TopicField>(&rules[*signal].source);
    if (field != nullptr) return nearest_topic(rules[field->topic].name, knowledge.graph);
  }
  return "";
}

}  // namespace culprit
