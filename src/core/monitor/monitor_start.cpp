// The monitor's part about the first seconds: it expects the parts of the robot that an earlier run
// saw, and ends discovery once all of them are there.
//
// Until `discovered` absence is not knowledge (monitor.h). But a run that comes soon after another one
// knows what there is to discover (KnownRobot). All of it is there once
//
//   components   their nodes are in the graph, each alone, with the ends that they had
//   topics       those that it saw, and those that are published now, were received
//   values       all that it read was read: signals, diagnostics, parameters, lifecycles
//
// or if it is certain that a silent topic would be received: the earlier run received it; one
// component published it, and does so now, still in the same process; and that process has proven
// since that it knows its subscriber (ListenerKnown). From that proof on its silence counts.
//
// While any part is missing, all silence waits until `discovered`, as in a first run: a missing part
// may only be late, and may be the cause of the rest. It waits, too, if a component leaves meanwhile,
// or if culprit was deaf for a while: then the robot is not the expected one.
#include <algorithm>

#include "monitor/monitor.h"

namespace culprit {
namespace {

using Kind = Input::Kind;

}  // namespace

void Monitor::expect(const KnownRobot& known) {
  if (!known.is_whole) return;
  const RuleSet& rules = knowledge_.rules;
  Expected& expected = expected_.emplace();
  expected.seen.resize(rules.topics.size());
  expected.heard.resize(rules.topics.size());
  for (const KnownRobot::Part& part : known.parts) {
    const auto component = std::ranges::find_if(rules.components, [&](const Component& c) {
      return c.name == part.component && (c.node.empty() || c.node == part.node);
    });
    if (component == rules.components.end()) continue;
    const auto place = static_cast<std::size_t>(component - rules.components.begin());
    expected.parts.push_back({ComponentId(place), part.pid});
  }
  const auto note = [&](const std::vector<std::string>& names, std::vector<bool>& marks) {
    for (const std::string& name : names) {
      for (std::size_t t = 0; t < marks.size(); ++t) {
        if (rules.label(TopicId(t)) == name) marks[t] = true;
      }
    }
  };
  note(known.topics, expected.seen);
  note(known.heard, expected.heard);
  const std::unordered_set<std::string> read(known.read.begin(), known.read.end());
  for (std::size_t i = 0; i < rules.inputs.size(); ++i) {
    if (read.contains(value_name(rules.inputs[i], rules))) expected.values.emplace_back(i);
  }
  deadlines_.set(look_at_expected_slot(), later(start_, kLook));
}

void Monitor::expect_no_more() {
  expected_.reset();
  deadlines_.clear(look_at_expected_slot());
}

void Monitor::on(Time at, const ListenerKnown& seen) {
  auto& listened = topics_[seen.topic.index].listened;
  if (expected_ && !listened) listened = at;
}

void Monitor::look_at_expected(Time now) {
  if (!expected_) return;
  if (now >= discovered_) return expect_no_more();
  if (!is_all_there()) return deadlines_.set(look_at_expected_slot(), later(now, kLook));
  std::vector<TopicId> silent;
  for (std::size_t t = 0; t < topics_.size(); ++t) {
    const auto component = certainly_silent(TopicId(t));
    if (topics_[t].last || !component) continue;
    topics_[t].silent_since = topics_[t].listened;
    topics_[t].silent_one = *component;
    silent.emplace_back(t);
  }
  expect_no_more();
  for (const TopicId topic : silent) {
    for (const InputId id : topics_[topic.index].inputs) update(id, now);
  }
}

bool Monitor::is_all_there() const {
  if (is_deaf_) return false;
  for (const Expected::Part& part : expected_->parts) {
    if (!is_there(part.component)) return false;
  }
  for (std::size_t t = 0; t < topics_.size(); ++t) {
    if (!is_there(TopicId(t))) return false;
  }
  return std::ranges::all_of(expected_->values, [&](InputId id) { return is_there(id); });
}

bool Monitor::is_there(ComponentId component) const {
  const ComponentState& state = knowledge_.components[component];
  return state.in_graph && state.alive == true && state.namesakes == 0 &&
         knowledge_.graph.has_all_ends(component);
}

bool Monitor::is_there(TopicId topic) const {
  const Topic& state = topics_[topic.index];
  const bool is_awaited =
      expected_->seen[topic.index] || knowledge_.graph.publisher_count(knowledge_.rules[topic]) > 0;
  // A topic whose rhythm is not read has only fields, which are values.
  return state.inputs.empty() || !is_awaited || state.last || certainly_silent(topic);
}

bool Monitor::is_there(InputId id) const {
  const Input& input = knowledge_.rules[id];
  const bool is_measured =
      input.kind == Kind::kCpu || input.kind == Kind::kMemory || input.kind == Kind::kLogs;
  if (input.subject() == Input::Subject::kTopic || input.kind == Kind::kAlive || is_measured)
    return true;
  if (input.kind == Kind::kLifecycle || input.kind == Kind::kParameter ||
      input.kind == Kind::kLevel)
    return knowledge_.signals[id].known;
  const auto& source = knowledge_.rules[input.signal].source;
  if (std::holds_alternative<GroupId>(source)) return knowledge_.signals[id].known;
  const auto* field = std::get_if<TopicField>(&source);
  return signals_[input.signal.index].last || (field != nullptr && certainly_silent(field->topic));
}

// The only publisher of the topic, if the topic is certainly silent.
std::optional<ComponentId> Monitor::certainly_silent(TopicId topic) const {
  const culprit::Topic& rule_topic = knowledge_.rules[topic];
  if (!expected_->heard[topic.index] || !topics_[topic.index].listened) return std::nullopt;
  if (knowledge_.graph.publisher_count(rule_topic) != 1) return std::nullopt;
  for (const Expected::Part& part : expected_->parts) {
    if (part.pid != 0 && knowledge_.components[part.component].node_pid == part.pid &&
        knowledge_.graph.publishes(part.component, rule_topic))
      return part.component;
  }
  return std::nullopt;
}

// Its process exited, or is another now, which has all the time that it needs.
void Monitor::forget_what_was_heard_of(ComponentId component, Time now) {
  for (const KnownRobot::End& end : knowledge_.graph.ends_of(component)) {
    if (end.kind != EndpointKind::kPublisher) continue;
    for (const TopicId topic : topics_of(component, end.name)) {
      write_.discovered.forget_received(topic);
      forget_goals(topic, now);
    }
  }
  for (Topic& topic : topics_) {
    if (!topic.silent_since || topic.silent_one != component) continue;
    topic.silent_since.reset();
    topic.listened.reset();
    for (const InputId id : topic.inputs) update(id, now);
  }
}

}  // namespace culprit
