#include "bag/bag_reading.h"

#include <algorithm>

#include "knowledge/component_states.h"
#include "ros2/parameter_store.h"

namespace culprit::bag {
namespace {

constexpr std::string_view kTransitions = "/transition_event";

ros2::ByteView view(std::string_view bytes) {
  return {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
}

// What a node's messages on /rosout are signed with: of "/arm/gripper" it is "arm.gripper"
// (design.ros2.org/articles/logging.html, rcl's node.c).
std::string logger_of(const std::string& node) {
  std::string name = node.substr(1);
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

Lifecycle lifecycle_from(const std::string& label) {
  for (const Lifecycle state : {Lifecycle::kUnconfigured, Lifecycle::kInactive, Lifecycle::kActive,
                                Lifecycle::kFinalized}) {
    if (label == to_string(state)) return state;
  }
  return Lifecycle::kTransition;
}

}  // namespace

BagReading::BagReading(const RuleSet& rules, const BagContents& contents,
                       ros2::MessageLibrary& library)
    : rules_(rules), contents_(contents), library_(library), diagnostics_(rules), binding_(rules) {
  diagnostics_.on_level = [this](DiagnosticId id, std::uint8_t level) {
    put(DiagnosticRead{id, level});
  };
  diagnostics_.on_signal = [this](SignalId id, const std::string& text) {
    put(SignalRead{id, Value(text)});
  };
  diagnostics_.on_status = [this](StatusHeard heard) { put(std::move(heard)); };
  for (std::size_t c = 0; c < rules.components.size(); ++c) {
    const std::string& declared = binding_.node_of(ComponentId(c));
    const std::string node = declared.empty() ? "/" + rules.components[c].name : declared;
    loggers_.try_emplace(logger_of(node), node);
  }
}

BagReading::Plan BagReading::plan_for(const BagTopic& topic) {
  Plan plan;
  for (std::size_t t = 0; t < rules_.topics.size(); ++t) {
    if (rules_.topics[t].name == topic.name && !rules_.topics[t].publisher) plan.topic = TopicId(t);
  }
  plan_fields(topic, plan);
  if (topic.encoding != "cdr") return plan;
  if (topic.type == ros2::msg::DiagnosticArray::kType && diagnostics_.is_wanted())
    plan.use = Use::kDiagnostics;
  if (topic.type == ros2::msg::Log::kType) plan.use = Use::kLog;
  if (topic.type == ros2::msg::ParameterEvent::kType) plan.use = Use::kParameters;
  if (topic.type == ros2::msg::TransitionEvent::kType && topic.name.ends_with(kTransitions)) {
    plan.use = Use::kTransition;
    plan.node = topic.name.substr(0, topic.name.size() - kTransitions.size());
  }
  return plan;
}

void BagReading::plan_fields(const BagTopic& topic, Plan& plan) {
  for (std::size_t s = 0; s < rules_.signals.size(); ++s) {
    const auto* field = std::get_if<TopicField>(&rules_.signals[s].source);
    if (field == nullptr || plan.topic != field->topic) continue;
    const std::string& name = rules_.signals[s].name;
    if (topic.encoding != "cdr") {
      unreadable_.push_back("signal " + name + ": its messages are in '" + topic.encoding +
                            "', not in CDR");
      continue;
    }
    if (const std::string* definition = contents_.definition_of(topic.type))
      library_.learn(topic.type, *definition);
    auto reader = ros2::FieldReader::compile(library_, topic.type, field->field);
    if (reader) {
      plan.fields.push_back({SignalId(s), std::move(*reader)});
    } else {
      unreadable_.push_back("signal " + name + ": " + reader.error());
    }
  }
}

std::vector<std::string> BagReading::missing() const {
  const auto has = [&](const auto& is_it) {
    return std::any_of(contents_.topics().begin(), contents_.topics().end(), is_it);
  };
  std::vector<std::string> missing = unreadable_;
  for (std::size_t t = 0; t < rules_.topics.size(); ++t) {
    const Topic& topic = rules_.topics[t];
    if (topic.publisher)
      missing.push_back("topic " + rules_.label(TopicId(t)) +
                        ": a recording does not say who published a message");
    else if (!has([&](const BagTopic& each) { return each.name == topic.name; }))
      missing.push_back("topic " + topic.name);
  }
  if (diagnostics_.is_wanted() &&
      !has([](const BagTopic& each) { return each.type == ros2::msg::DiagnosticArray::kType; }))
    missing.emplace_back("/diagnostics");
  return missing;
}

void BagReading::read(const BagMessage& message, std::vector<Observation>& observations) {
  while (plans_.size() <= message.topic)  // The bag tells of its topics as it comes to them.
    plans_.push_back(plan_for(contents_.topics()[plans_.size()]));
  const Plan& plan = plans_[message.topic];
  const ros2::ByteView payload = view(message.bytes);
  now_ = Time(Duration(message.at));
  out_ = &observations;
  if (plan.topic) put(SampleArrived{*plan.topic, 1});
  for (const Field& field : plan.fields) {
    Value value;
    if (field.reader.read(payload, value) == ros2::FieldStatus::kRead)
      put(SignalRead{field.signal, std::move(value)});
  }
  if (plan.use == Use::kDiagnostics) {
    if (const auto array = ros2::decode<ros2::msg::DiagnosticArray>(payload))
      diagnostics_.read(*array);
  } else if (plan.use == Use::kParameters) {
    read_parameters(payload);
  } else if (plan.use == Use::kTransition) {
    read_transition(plan.node, payload);
  } else if (plan.use == Use::kLog) {
    read_log(payload);
  }
}

void BagReading::read_parameters(ros2::ByteView payload) {
  const auto event = ros2::decode<ros2::msg::ParameterEvent>(payload);
  if (!event) return;
  const auto component = node_seen(event->node);
  if (!component) return;
  for (const auto* changes : {&event->new_parameters, &event->changed_parameters}) {
    for (const ros2::msg::Parameter& changed : *changes) {
      for (std::size_t p = 0; p < rules_.parameters.size(); ++p) {
        const Parameter& wanted = rules_.parameters[p];
        if (wanted.component != *component || wanted.name != changed.name) continue;
        if (auto value = ros2::to_value(changed.value))
          put(ParameterRead{ParameterId(p), std::move(*value)});
      }
    }
  }
}

void BagReading::read_transition(const std::string& node, ros2::ByteView payload) {
  const auto event = ros2::decode<ros2::msg::TransitionEvent>(payload);
  if (!event) return;
  if (const auto component = node_seen(node))
    put(LifecycleRead{*component, lifecycle_from(event->goal_state.label)});
}

// Also what a part of a node says: "arm.gripper.planner" is of "/arm/gripper".
void BagReading::read_log(ros2::ByteView payload) {
  const auto log = ros2::decode<ros2::msg::Log>(payload);
  constexpr std::size_t kLongestName = 1024;
  if (!log || log->name.size() > kLongestName) return;
  for (std::size_t end = log->name.size(); end != std::string::npos && end > 0;
       end = log->name.rfind('.', end - 1)) {
    const auto logger = loggers_.find(log->name.substr(0, end));
    if (logger == loggers_.end()) continue;
    (void)node_seen(logger->second);
    return;
  }
}

std::optional<ComponentId> BagReading::node_seen(const std::string& node) {
  constexpr std::size_t kMaxNodes = 100'000;  // the file decides how many there are
  const auto known = nodes_.find(node);
  if (known != nodes_.end()) return known->second;
  if (nodes_.size() >= kMaxNodes) return std::nullopt;
  put(NodeAppeared{node, 0});
  return nodes_[node] = binding_.bind(node);
}

void BagReading::put(ObservationWhat what) { out_->push_back({now_, std::move(what)}); }

}  // namespace culprit::bag
