#include "bag/bag_reading.h"

#include <algorithm>
#include <set>

#include "base/closest.h"
#include "base/ros_names.h"
#include "knowledge/component_states.h"
#include "knowledge/describe.h"
#include "knowledge/signal_store.h"
#include "link/goals.h"
#include "robot/unreadable.h"
#include "ros2/parameter_store.h"

namespace culprit::bag {
namespace {

constexpr std::string_view kTransitions = "/transition_event";

rtps::ByteView view(std::string_view bytes) {
  return {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
}

// The name with which a node signs its messages on /rosout: of "/arm/gripper" it is "arm.gripper"
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

std::string counted(std::uint64_t count, const char* what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

}  // namespace

BagReading::BagReading(const RuleSet& rules, const BagContents& contents,
                       ros2::MessageLibrary& library)
    : rules_(rules),
      contents_(contents),
      library_(library),
      diagnostics_(rules),
      binding_(rules),
      signals_(rules.signals.size()),
      levels_(rules.diagnostics.size()),
      components_(rules.components.size()),
      lifecycles_(rules.components.size()),
      parameters_(rules.parameters.size()),
      counted_logs_(link::counted_log_levels(rules)) {
  diagnostics_.on_level = [this](DiagnosticId id, std::uint8_t level) {
    levels_[id.index] = true;
    put(DiagnosticRead{id, level});
  };
  diagnostics_.on_signal = [this](SignalId id, const std::string& text) {
    read_signal(id, Value(text));
  };
  diagnostics_.on_status = [this](StatusHeard heard) {
    statuses_.insert(heard.name);
    statuses_.insert(heard.hardware_id);
    put(std::move(heard));
  };
  for (std::size_t c = 0; c < rules.components.size(); ++c) {
    const std::string& declared = binding_.node_of(ComponentId(c));
    const std::string node = declared.empty() ? "/" + rules.components[c].name : declared;
    loggers_.try_emplace(logger_of(node), node);
    for (const std::string& other : binding_.other_nodes(ComponentId(c)))
      loggers_.try_emplace(logger_of(other), other);
  }
}

BagReading::Plan BagReading::plan_for(const BagTopic& topic) {
  Plan plan;
  for (std::size_t t = 0; t < rules_.topics.size(); ++t) {
    if (rules_.topics[t].name == topic.name && !rules_.topics[t].publisher) plan.topic = TopicId(t);
  }
  if (plan.topic) plan_fields(topic, plan);
  if (topic.type == ros2::msg::DiagnosticArray::kType && diagnostics_.is_wanted())
    plan.use = Use::kDiagnostics;
  if (topic.type == ros2::msg::Log::kType) plan.use = Use::kLog;
  if (topic.type == ros2::msg::ParameterEvent::kType) plan.use = Use::kParameters;
  if (topic.type == ros2::msg::GoalStatusArray::kType && plan.topic) plan.use = Use::kGoals;
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
    SignalSeen& seen = signals_[s];
    if (topic.encoding != "cdr") {
      seen.why_unreadable =
          "the messages of " + topic.name + " are in '" + topic.encoding + "', not in CDR";
      continue;
    }
    if (const std::string* definition = contents_.definition_of(topic.type))
      library_.learn(topic.type, *definition);
    auto reader = ros2::FieldReader::compile(library_, topic.type, field->field);
    if (!reader) {
      seen.why_unreadable = reader.error();
      continue;
    }
    seen.is_number = reader->reads_number();
    plan.fields.push_back({SignalId(s), std::move(*reader)});
  }
  if (plan.fields.empty()) return;
  if (auto whole = ros2::FieldReader::compile_whole(library_, topic.type))
    plan.whole = std::move(*whole);
}

void BagReading::read(const BagMessage& message, std::vector<Observation>& observations) {
  while (plans_.size() <= message.topic)  // The bag tells of its topics as it comes to them.
    plans_.push_back(plan_for(contents_.topics()[plans_.size()]));
  Plan& plan = plans_[message.topic];
  const BagTopic& topic = contents_.topics()[message.topic];
  const rtps::ByteView payload = view(message.bytes);
  ++plan.messages;
  now_ = Time(Duration(message.at));
  recorded_at_ = message.recorded_at;
  out_ = &observations;
  if (plan.topic) put(SampleArrived{*plan.topic, 1});
  if (!plan.fields.empty()) read_fields(plan, payload, decodes(plan, topic, payload));
  switch (plan.use) {
    case Use::kNone:
      break;
    case Use::kDiagnostics:
      if (const auto array = decoded<ros2::msg::DiagnosticArray>(plan, topic, payload))
        diagnostics_.read(*array);
      break;
    case Use::kParameters:
      if (const auto event = decoded<ros2::msg::ParameterEvent>(plan, topic, payload))
        read_parameters(*event);
      break;
    case Use::kTransition:
      if (const auto event = decoded<ros2::msg::TransitionEvent>(plan, topic, payload))
        read_transition(plan.node, *event);
      break;
    case Use::kLog:
      if (const auto log = decoded<ros2::msg::Log>(plan, topic, payload)) read_log(*log);
      break;
    case Use::kGoals:
      if (auto goals = link::goals_in(*plan.topic, payload)) put(std::move(*goals));
      break;
  }
}

bool BagReading::decodes(Plan& plan, const BagTopic& topic, rtps::ByteView payload) {
  const ros2::PayloadFit fit = plan.whole ? plan.whole->fit(payload) : ros2::PayloadFit::kFits;
  if (fit == ros2::PayloadFit::kFits) return true;
  note_undecoded(plan, topic, fit == ros2::PayloadFit::kTooLong);
  return false;
}

template <class Message>
std::optional<Message> BagReading::decoded(Plan& plan, const BagTopic& topic,
                                           rtps::ByteView payload) {
  auto message = rtps::decode<Message>(payload);
  if (!message && plan.fields.empty()) note_undecoded(plan, topic, false);
  return message;
}

void BagReading::note_undecoded(Plan& plan, const BagTopic& topic, bool is_longer) {
  if (++plan.undecoded > 1) return;
  const bool is_described = contents_.definition_of(topic.type) != nullptr;
  plan.why_undecoded =
      is_longer ? "they do not fit the definition of " + topic.type +
                      (is_described ? " in the bag" : "; give the recorder's with --message-path")
                : "they are cut short, or are not of " + topic.type;
}

void BagReading::read_fields(const Plan& plan, rtps::ByteView payload, bool is_decoded) {
  for (const Field& field : plan.fields) {
    Value value;
    const bool is_read =
        is_decoded && field.reader.read(payload, value, recorded_at_) == ros2::FieldStatus::kRead;
    read_signal(field.signal, is_read ? std::move(value) : unreadable_value());
  }
}

void BagReading::read_signal(SignalId signal, Value value) {
  SignalSeen& seen = signals_[signal.index];
  // A field has one type, so only texts may be usable now and then.
  const bool may_differ = std::holds_alternative<std::string>(value) && seen.example.empty();
  if ((!seen.was_usable || may_differ) && !is_unreadable(value)) {
    seen.was_read = true;
    std::string text;
    const bool is_usable = as_type(value, rules_[signal].type, text).known;
    seen.was_usable |= is_usable;
    if (!is_usable) seen.example = to_string(value);
  }
  put(SignalRead{signal, std::move(value)});
}

void BagReading::read_parameters(const ros2::msg::ParameterEvent& event) {
  const auto component = node_seen(event.node);
  if (!component) return;
  for (const auto* changes : {&event.new_parameters, &event.changed_parameters}) {
    for (const ros2::msg::Parameter& changed : *changes) {
      for (std::size_t p = 0; p < rules_.parameters.size(); ++p) {
        const Parameter& wanted = rules_.parameters[p];
        if (wanted.component != *component || wanted.name != changed.name) continue;
        auto value = ros2::to_value(changed.value);
        if (!value) continue;
        parameters_[p] = true;
        put(ParameterRead{ParameterId(p), std::move(*value)});
      }
    }
  }
}

void BagReading::read_transition(const std::string& node, const ros2::msg::TransitionEvent& event) {
  const auto component = node_seen(node);
  if (!component) return;
  lifecycles_[component->index] = true;
  put(LifecycleRead{*component, lifecycle_from(event.goal_state.label)});
}

// Also what a part of a node says: "arm.gripper.planner" is of "/arm/gripper".
void BagReading::read_log(const ros2::msg::Log& log) {
  constexpr std::size_t kLongestName = 1024;
  if (log.name.size() > kLongestName) return;
  for (std::size_t end = log.name.size(); end != std::string::npos && end > 0;
       end = log.name.rfind('.', end - 1)) {
    const auto logger = loggers_.find(log.name.substr(0, end));
    if (logger == loggers_.end()) continue;
    return count_log(node_seen(logger->second), log);
  }
}

void BagReading::count_log(std::optional<ComponentId> component, const ros2::msg::Log& log) {
  const auto wanted = component ? counted_logs_[component->index] : std::nullopt;
  const LogLevel level = log_level(log.level);
  if (wanted && level >= *wanted) put(LogSeen{*component, level});
}

std::optional<ComponentId> BagReading::node_seen(const std::string& node) {
  constexpr std::size_t kMaxNodes = 100'000;  // the file decides how many there are
  const auto known = nodes_.find(node);
  if (known != nodes_.end()) return known->second;
  if (nodes_.size() >= kMaxNodes) return std::nullopt;
  put(NodeAppeared{node, 0});
  const auto component = binding_.bind(node);
  if (component) components_[component->index] = true;
  return nodes_[node] = component;
}

void BagReading::put(ObservationWhat what) { out_->push_back({now_, std::move(what)}); }

std::uint64_t BagReading::messages_of(const std::string& topic) const {
  std::uint64_t count = 0;
  for (std::size_t t = 0; t < plans_.size(); ++t) {
    if (contents_.topics()[t].name == topic) count += plans_[t].messages;
  }
  return count;
}

bool BagReading::has_type(std::string_view type) const {
  for (std::size_t t = 0; t < plans_.size(); ++t) {
    if (contents_.topics()[t].type == type && plans_[t].messages > 0) return true;
  }
  return false;
}

std::string BagReading::why_no_topic(TopicId topic) const {
  if (rules_[topic].publisher)
    return "topic " + rules_.label(topic) +
           ": a recording does not say which node published a "
           "message";
  const std::string& name = rules_[topic].name;
  if (messages_of(name) > 0) return "";
  std::vector<std::string_view> known;
  for (const BagTopic& each : contents_.topics()) {
    if (each.name == name)
      return "topic " + name + " was announced, but no message of it was recorded";
    known.push_back(each.name);
  }
  const std::string near = closest_full_name(name, known);
  return "topic " + name + " is not in the bag" +
         (near.empty() ? "" : "; did you mean " + near + "?");
}

std::string BagReading::why_no_status(const std::string& status) const {
  if (!has_type(ros2::msg::DiagnosticArray::kType)) return "no diagnostics were recorded";
  if (statuses_.contains(status)) return "";
  const std::string near = closest(status, {statuses_.begin(), statuses_.end()});
  return "the diagnostics have no status '" + status + "'" +
         (near.empty() ? "" : "; did you mean '" + near + "'?");
}

std::string BagReading::why_no_component(ComponentId component) const {
  if (components_[component.index]) return "";
  const std::string& node = binding_.node_of(component);
  return "nothing was recorded of " + (node.empty() ? rules_[component].name : "node " + node) +
         ": no parameter event, transition or log";
}

std::string BagReading::why_no_lifecycle(ComponentId component) const {
  if (std::string why = why_no_component(component); !why.empty()) return why;
  return lifecycles_[component.index]
             ? ""
             : "no transition of " + rules_[component].name + " was recorded";
}

std::string BagReading::why_no_parameter(ParameterId parameter) const {
  if (parameters_[parameter.index]) return "";
  const Parameter& wanted = rules_[parameter];
  if (std::string why = why_no_component(wanted.component); !why.empty()) return why;
  return "no value of parameter " + wanted.name + " of " + rules_[wanted.component].name +
         " was recorded";
}

bool BagReading::is_compared_with_text(SignalId signal) const {
  const SignalSeen& seen = signals_[signal.index];
  return seen.was_usable && seen.is_number && rules_[signal].type == Type::kString;
}

std::string BagReading::why_no_signal(SignalId signal) const {
  const Signal& declared = rules_[signal];
  const SignalSeen& seen = signals_[signal.index];
  if (const auto* parameter = std::get_if<ParameterId>(&declared.source))
    return why_no_parameter(*parameter);
  if (const auto* group = std::get_if<GroupId>(&declared.source)) {
    std::string why;
    for (const ComponentId member : rules_.groups[group->index].members) {
      if (why.empty()) why = why_no_lifecycle(member);
    }
    return why;
  }
  const auto* field = std::get_if<TopicField>(&declared.source);
  if (field != nullptr) {
    if (std::string why = why_no_topic(field->topic); !why.empty()) return why;
    if (!seen.was_read && !seen.why_unreadable.empty()) return seen.why_unreadable;
    if (is_compared_with_text(signal))
      return declared.name + " is a number in the bag, and the rule compares it with a text";
  }
  if (seen.was_usable && seen.example.empty()) return "";
  if (seen.was_read)
    return declared.name + (seen.was_usable ? " also has" : " has") + " values such as " +
           seen.example + ", which the rule cannot compare";
  if (field != nullptr) {
    for (std::size_t t = 0; t < plans_.size(); ++t) {
      const bool is_it = contents_.topics()[t].name == rules_[field->topic].name;
      if (is_it && plans_[t].undecoded > 0)
        return "the messages of " + rules_[field->topic].name +
               " cannot be decoded: " + plans_[t].why_undecoded;
    }
    return "no message of " + rules_[field->topic].name + " has " + field->field;
  }
  if (const auto* key = std::get_if<DiagnosticKey>(&declared.source)) {
    const bool is_any = key->status == "*";
    if (std::string why = is_any ? "" : why_no_status(key->status); !why.empty()) return why;
    return "the diagnostics have no key '" + key->key + "'" +
           (is_any ? "" : " in status '" + key->status + "'");
  }
  if (!has_type(ros2::msg::DiagnosticArray::kType)) return "no diagnostics were recorded";
  return "the diagnostics have no key '" + declared.name + "'";
}

std::string BagReading::why_unknown(InputId id) const {
  const Input& input = rules_[id];
  switch (input.kind) {
    case Input::Kind::kRate:
    case Input::Kind::kAge:
    case Input::Kind::kPhi:
    case Input::Kind::kGoals:
    case Input::Kind::kGoalAge:
      return why_no_topic(input.topic);
    case Input::Kind::kLoss:
      return describe(input, rules_) + ": a recording does not say which messages were lost";
    case Input::Kind::kCpu:
    case Input::Kind::kMemory:
      return describe(input, rules_) + ": a recording does not say what processes use";
    case Input::Kind::kLogs:
      return has_type(ros2::msg::Log::kType)
                 ? why_no_component(input.component)
                 : describe(input, rules_) + ": no log (/rosout) was recorded";
    case Input::Kind::kAlive:
      return why_no_component(input.component);
    case Input::Kind::kLifecycle:
      return why_no_lifecycle(input.component);
    case Input::Kind::kParameter:
      return why_no_parameter(input.parameter);
    case Input::Kind::kLevel:
      return levels_[input.diagnostic.index]
                 ? ""
                 : why_no_status(rules_.diagnostics[input.diagnostic.index].name);
    case Input::Kind::kSignal:
    case Input::Kind::kMean:
    case Input::Kind::kMin:
    case Input::Kind::kMax:
    case Input::Kind::kStddev:
    case Input::Kind::kChanged:
    case Input::Kind::kIsNan:
    case Input::Kind::kFrozen:
      break;
  }
  return why_no_signal(input.signal);
}

bool BagReading::is_misread(InputId id) const {
  const Input& input = rules_[id];
  return input.kind == Input::Kind::kLoss ||
         (input.kind == Input::Kind::kLogs && !has_type(ros2::msg::Log::kType)) ||
         (input.kind == Input::Kind::kSignal && is_compared_with_text(input.signal));
}

std::vector<std::string> BagReading::missing() const {
  std::set<std::string> lines;
  for (std::size_t i = 0; i < rules_.inputs.size(); ++i) {
    if (std::string why = why_unknown(InputId(i)); !why.empty()) lines.insert(std::move(why));
  }
  return {lines.begin(), lines.end()};
}

std::vector<std::string> BagReading::undecoded() const {
  std::vector<std::string> lines;
  for (std::size_t t = 0; t < plans_.size(); ++t) {
    const Plan& plan = plans_[t];
    if (plan.undecoded == 0) continue;
    lines.push_back(std::to_string(plan.undecoded) + " of " + counted(plan.messages, "message") +
                    " of " + contents_.topics()[t].name + " cannot be decoded (" +
                    plan.why_undecoded + "); their values are unknown");
  }
  return lines;
}

}  // namespace culprit::bag
