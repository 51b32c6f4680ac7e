#include "monitor/monitor.h"

#include <algorithm>

#include "knowledge/named.h"

namespace culprit {
namespace {

using Kind = Input::Kind;

// Where `value` lies among `thresholds`: between which two, or on which one. No comparison changes
// its result while this stays the same.
std::size_t position(double value, const std::vector<double>& thresholds) {
  const auto above = std::lower_bound(thresholds.begin(), thresholds.end(), value);
  const auto below = static_cast<std::size_t>(above - thresholds.begin());
  return 2 * below + (above != thresholds.end() && *above == value ? 1 : 0);
}

// @pre `kind` is that of a signal's window
monitor::ValueWindow::Of statistic(Kind kind) {
  using Of = monitor::ValueWindow::Of;
  switch (kind) {
    case Kind::kMin:
      return Of::kMin;
    case Kind::kMax:
      return Of::kMax;
    case Kind::kStddev:
      return Of::kStddev;
    default:
      return Of::kMean;
  }
}

double as_number(const Slot& slot, Type type) {
  if (type == Type::kInt) return static_cast<double>(slot.i);
  return type == Type::kDuration ? seconds(Duration(slot.i)) : slot.d;
}

// Does it count what came within a window?
bool counts_samples(const Input& input) {
  return input.kind == Kind::kRate || input.kind == Kind::kLoss || input.kind == Kind::kGoals;
}

}  // namespace

Monitor::Monitor(const Knowledge& knowledge, Writes writes, Time start, Time discovered)
    : knowledge_(knowledge),
      write_(writes),
      start_(start),
      discovered_(discovered),
      topics_(knowledge.rules.topics.size()),
      signals_(knowledge.rules.signals.size()),
      derived_(knowledge.rules.inputs.size()),
      component_inputs_(knowledge.rules.components.size()),
      part_misses_(knowledge.rules.components.size()),
      has_answered_(knowledge.rules.components.size(), false),
      parameter_inputs_(knowledge.rules.parameters.size()),
      parameter_signals_(knowledge.rules.parameters.size()),
      diagnostic_inputs_(knowledge.rules.diagnostics.size()),
      deadlines_(knowledge.rules.inputs.size() + 3 + 3 * knowledge.rules.components.size() +
                 knowledge.rules.groups.size()) {
  const RuleSet& rules = knowledge.rules;
  for (std::size_t i = 0; i < rules.inputs.size(); ++i) {
    const Input& input = rules.inputs[i];
    const InputId id(i);
    const bool counts_events = input.kind == Kind::kGoals || input.kind == Kind::kLogs;
    write_.signals.set_latency(id, counts_events ? input.window : rules.cycle);
    switch (input.subject()) {
      case Input::Subject::kTopic:
        topics_[input.topic.index].inputs.push_back(id);
        topics_[input.topic.index].needs_phi |= input.kind == Kind::kPhi;
        if (input.kind == Kind::kRate || input.kind == Kind::kGoals)
          derived_[i].count = monitor::SlidingCount(input.window);
        for (const double threshold : input.thresholds) {
          if (input.kind == Kind::kPhi)
            derived_[i].deviations.push_back(monitor::PhiAccrual::deviations(threshold));
        }
        break;
      case Input::Subject::kSignal:
        signals_[input.signal.index].inputs.push_back(id);
        if (input.window > Duration::zero() && input.kind != Kind::kFrozen) {
          const Duration longest_pause = rules[input.signal].stale.value_or(input.window);
          derived_[i].values.emplace(statistic(input.kind), input.window, longest_pause);
        }
        break;
      case Input::Subject::kComponent:
        if (input.kind == Kind::kLogs) derived_[i].count = monitor::SlidingCount(input.window);
        component_inputs_[input.component.index].push_back(id);
        break;
      case Input::Subject::kParameter:
        parameter_inputs_[input.parameter.index].push_back(id);
        break;
      case Input::Subject::kDiagnostic:
        diagnostic_inputs_[input.diagnostic.index].push_back(id);
        break;
    }
  }
  for (const Rule& rule : rules.rules) note_how_far_it_looks_back(rule);
  for (std::size_t t = 0; t < rules.topics.size(); ++t)
    topic_ids_[rules.topics[t].name].emplace_back(t);
  for (std::size_t s = 0; s < rules.signals.size(); ++s) {
    if (const auto* parameter = std::get_if<ParameterId>(&rules.signals[s].source)) {
      parameter_signals_[parameter->index].push_back(SignalId(s));
    }
  }
  deadlines_.set(rules.inputs.size(), discovered_);
}

void Monitor::note_how_far_it_looks_back(const Rule& rule) {
  const RuleSet& rules = knowledge_.rules;
  const Duration held =
      rule.policies.hold_for + rules.cycle * std::int64_t{rule.policies.hold_window};
  for (const InputId id : rule.inputs) {
    const Input& input = rules[id];
    const auto* field = input.subject() == Input::Subject::kSignal
                            ? std::get_if<TopicField>(&rules[input.signal].source)
                            : nullptr;
    if (field == nullptr && input.subject() != Input::Subject::kTopic) continue;
    Duration& longest = topics_[(field != nullptr ? field->topic : input.topic).index].looked_back;
    longest = std::max(longest, input.window + held);
  }
}

void Monitor::observe(const Observation& observation, Time at) {
  std::visit([&](const auto& seen) { on(at, seen); }, observation.what);
  settle_departures(at);
}

void Monitor::restart(Time since, Time now) {
  for (std::size_t t = 0; t < topics_.size(); ++t) resume(TopicId(t), since, now);
  is_deaf_ = false;
  expect_no_more();
  awake_ = now;
  write_.signals.hear_again(now);
  graced_ = later(now, kGrace);
  deadlines_.set(knowledge_.rules.inputs.size() + 1, graced_);
  for (Topic& topic : topics_) {
    topic.loss.restart(now);
    topic.regained.reset();
  }
  begin_windows_anew(now);
  for (std::size_t c = 0; c < knowledge_.rules.components.size(); ++c) {
    ComponentState& state = write_.components[ComponentId(c)];
    state.missed_probes = 0;
    if (state.changes_until != kNever)
      state.changes_until = std::max(state.changes_until, later(now, kGrace));
  }
  for (std::size_t i = 0; i < knowledge_.rules.inputs.size(); ++i) {
    const Kind kind = knowledge_.rules.inputs[i].kind;
    if (kind == Kind::kRate || kind == Kind::kAge || kind == Kind::kPhi || kind == Kind::kLoss ||
        kind == Kind::kLogs)
      update(InputId(i), now);
  }
}

void Monitor::advance(Time now) {
  settle_departures(now);
  while (const auto due = deadlines_.pop_due(now)) {
    if (*due < knowledge_.rules.inputs.size()) {
      update(InputId(*due), now);
      continue;
    }
    if (*due == look_at_expected_slot()) {
      look_at_expected(now);
      continue;
    }
    if (*due > look_at_expected_slot()) {
      update_group(GroupId(*due - look_at_expected_slot() - 1), now);
      continue;
    }
    if (*due >= return_of(ComponentId(0))) {
      write_.components.set_host_silent(ComponentId(*due - return_of(ComponentId(0))), {});
      continue;
    }
    if (*due >= farewell_of(ComponentId(0))) {
      note_known_dead(ComponentId(*due - farewell_of(ComponentId(0))), now);
      continue;
    }
    if (*due > knowledge_.rules.inputs.size() + 1) {
      const ComponentId component(*due - knowledge_.rules.inputs.size() - 2);
      if (is_at_its_start(component, now)) {
        await_ends(component, now);
      } else {
        await_ends_no_more(component, now);
        note_missing_part(component, now);
      }
      continue;
    }
    for (std::size_t c = 0; c < knowledge_.rules.components.size(); ++c) {
      const ComponentState& state = knowledge_.components[ComponentId(c)];
      const char* absence =
          state.node_seen == kLongAgo ? "it is not there any more" : "its node left the graph";
      update_alive(ComponentId(c), now,
                   state.process_remark.empty() ? absence : state.process_remark);
    }
    if (*due > knowledge_.rules.inputs.size()) continue;
    if (!is_deaf_) {
      if (discovered_ - start_ >= kGrace) write_.discovered.complete();
      tell_never_seen(now);
    } else {
      deadlines_.set(*due, later(now, kGrace));
    }
  }
}

void Monitor::remember(const KnownRobot& known) {
  for (const KnownRobot::Part& part : known.parts) {
    const auto& components = knowledge_.rules.components;
    const auto fits = [&](const Component& c) {
      return c.name == part.component && (c.node.empty() || c.node == part.node);
    };
    const auto component = std::find_if(components.begin(), components.end(), fits);
    if (component == components.end()) continue;
    const ComponentId id(static_cast<std::size_t>(component - components.begin()));
    see(id, start_);
    write_.graph.remember(id, part.ends);
    write_.components[id].host = part.host;
  }
  for (const std::string& name : known.topics) {
    for (std::size_t t = 0; t < knowledge_.rules.topics.size(); ++t) {
      if (knowledge_.rules.label(TopicId(t)) == name) see(TopicId(t), start_);
    }
  }
  for (const auto& [status, node] : known.publishers)
    write_.discovered.note_publisher(status, node);
  expect(known);
}

// Those of the rules that are what `publisher` publishes as `name`; empty: a node that is none.
std::vector<TopicId> Monitor::topics_of(std::optional<ComponentId> publisher,
                                        const std::string& name) const {
  std::vector<TopicId> topics;
  const auto known = topic_ids_.find(name);
  if (known == topic_ids_.end()) return topics;
  for (const TopicId topic : known->second) {
    const auto& wanted = knowledge_.rules[topic].publisher;
    if (!wanted || wanted == publisher) topics.push_back(topic);
  }
  return topics;
}

void Monitor::tell_never_seen(Time at) {
  for (const Named& named : named_by_rules(knowledge_)) {
    if (named.was_seen) continue;
    if (const auto* component = std::get_if<ComponentId>(&named.what))
      write_.components[*component].is_missed = true;
    write_.events.tell(at, NeverSeen{named.what, nearest_name(named.what, knowledge_)});
  }
}

void Monitor::refresh(const Program& program, Time now) {
  for (const Instruction& instruction : program.code) {
    if (instruction.op == Op::kInput) update(InputId(instruction.operand), now);
  }
}

void Monitor::put_held(InputId id) {
  write_.signals.forget(id, WhyUnknown::kNotCovered);
  deadlines_.set(id.index, kNever);
}

void Monitor::update(InputId id, Time now) {
  const Input& input = knowledge_.rules[id];
  if (input.subject() == Input::Subject::kTopic && topics_[input.topic.index].held)
    return put_held(id);
  Slot value;
  switch (input.kind) {
    case Kind::kRate:
      value = rate(id, now);
      break;
    case Kind::kAge:
      value = age(id, now);
      break;
    case Kind::kPhi:
      value = phi(id, now);
      break;
    case Kind::kLoss:
      value = loss(id, now);
      break;
    case Kind::kGoals:
      value = goals(id, now);
      break;
    case Kind::kLogs:
      value = logs(id, now);
      break;
    case Kind::kGoalAge:
      value = goal_age(input.topic, now);
      break;
    case Kind::kChanged:
      return update_changed(id, now);
    case Kind::kFrozen:
      return update_frozen(id, now);
    case Kind::kMean:
    case Kind::kMin:
    case Kind::kMax:
    case Kind::kStddev:
      return update_window(id, now);
    case Kind::kSignal:
    case Kind::kIsNan:
      // Its deadline is its staleness. A refresh comes earlier and changes nothing.
      if (is_stale(input.signal, now)) write_.signals.forget(id, WhyUnknown::kStale);
      return;
    default:
      return;
  }
  const Slot& before = knowledge_.signals[id];
  const bool same_place = before.known && value.known && input.only_compared &&
                          position(as_number(before, input.type), input.thresholds) ==
                              position(as_number(value, input.type), input.thresholds);
  if (same_place) {
    write_.signals.set_quietly(id, value);
  } else if (value.known) {
    write_.signals.set(id, value);
  } else {
    const bool has_begun = input.kind == Kind::kLogs
                               ? knowledge_.discovered.has(input.component)
                               : counts_samples(input) && topics_[input.topic.index].first;
    write_.signals.forget(id, derived_[id.index].is_overflow_told ? WhyUnknown::kOverflow
                              : has_begun                         ? WhyUnknown::kNotCovered
                                                                  : WhyUnknown::kNoValue);
  }
  deadlines_.set(id.index, next_crossing(id, now));
}

}  // namespace culprit
