#include "plan/what_if.h"

#include <algorithm>

namespace culprit::plan {

WhatIf::WhatIf(const Knowledge& knowledge)
    : rules_(knowledge.rules), knowledge_(rules_, knowledge) {}

void WhatIf::assume(const Change& assumed) {
  std::visit([&](const auto& what) { change(what); }, assumed);
}

void WhatIf::undo() {
  for (; !undo_.empty(); undo_.pop_back()) undo_.back()();
}

template <class T>
void WhatIf::set(T& place, T value) {
  undo_.push_back([&place, before = place] { place = before; });
  place = std::move(value);
}

void WhatIf::change(const SuccessChange& change) {
  const Belief before = knowledge_.beliefs[change.strategy];
  const double weight = before.alpha + before.beta;
  undo_.push_back([this, id = change.strategy, before] { knowledge_.beliefs.set(id, before); });
  knowledge_.beliefs.set(change.strategy,
                         {weight * change.success.value, weight * (1 - change.success.value)});
}

void WhatIf::change(const ImpactChange& change) {
  set(rules_.strategies[change.strategy.index].impact, change.impact);
  Cycles heaviest = change.impact;
  for (const Strategy& strategy : rules_.strategies) heaviest = std::max(heaviest, strategy.impact);
  set(rules_.heaviest, heaviest);
}

void WhatIf::change(const TriedChange& change) {
  undo_.push_back(
      [this, id = change.strategy, before = knowledge_.states.is_tried(change.strategy)] {
        knowledge_.states.set_tried(id, before);
      });
  knowledge_.states.set_tried(change.strategy, change.is_tried);
}

void WhatIf::change(const ResolvedChange& change) {
  for (const RuleId id : change.rules) {
    undo_.push_back(
        [this, id, before = knowledge_.states[id].phase] { knowledge_.states.enter(id, before); });
    knowledge_.states.enter(id, RulePhase::kQuiet);
    for (const InputId input : rules_[id].inputs) hear(rules_[input]);
    for (const ComponentId component : rules_[id].components) {
      if (knowledge_.components[component].process != ProcessState::kRunning)
        this->change(ComponentChange{component, ComponentChange::Situation::kAlive});
    }
  }
}

// A topic whose failure is resolved is not silent.
void WhatIf::hear(const Input& input) {
  using Kind = Input::Kind;
  if (input.kind != Kind::kAge && input.kind != Kind::kRate && input.kind != Kind::kPhi) return;
  const SignalStore::Rhythm before = knowledge_.signals.rhythm(input.topic);
  undo_.push_back(
      [this, topic = input.topic, before] { knowledge_.signals.set_rhythm(topic, before); });
  SignalStore::Rhythm now = before;
  now.last = knowledge_.now;
  knowledge_.signals.set_rhythm(input.topic, now);
}

void WhatIf::change(const ComponentChange& change) {
  using enum ComponentChange::Situation;
  if (change.situation == kLaunchable) {
    Component& component = rules_.components[change.component.index];
    return set(component.launch, {component.name});
  }
  ComponentState state = knowledge_.components[change.component];
  state.alive = change.situation != kAbsent;
  if (change.situation != kAbsent) state.process = ProcessState::kRunning;
  if (change.situation == kActive) state.lifecycle = Lifecycle::kActive;
  if (change.situation == kInactive) state.lifecycle = Lifecycle::kInactive;
  if (change.situation == kAbsent) state.pid = state.node_pid = 0;
  set(knowledge_.components[change.component], std::move(state));
  set_signals(change.component);
}

// A WHEN condition may look at the component too.
void WhatIf::set_signals(ComponentId component) {
  const ComponentState& state = knowledge_.components[component];
  for (std::size_t i = 0; i < rules_.inputs.size(); ++i) {
    const Input& input = rules_.inputs[i];
    if (input.component != component) continue;
    Slot value;
    if (input.kind == Input::Kind::kAlive) {
      value = Slot::of(*state.alive);
    } else if (input.kind == Input::Kind::kLifecycle) {
      if (state.lifecycle != Lifecycle::kUnknown) value = Slot::of(to_string(state.lifecycle));
    } else {
      continue;
    }
    set_signal(InputId(i), value);
  }
}

// The text of a slot is the store's, so the old one is kept here.
void WhatIf::set_signal(InputId id, const Slot& value) {
  const Slot before = knowledge_.signals[id];
  undo_.push_back([this, id, before, text = std::string(before.s)] {
    Slot restored = before;
    restored.s = text;
    knowledge_.signals.set(id, restored);
  });
  knowledge_.signals.set(id, value);
}

void WhatIf::change(const WhenChange& change) {
  set(rules_.strategies[change.strategy.index].when, Program());
}

}  // namespace culprit::plan
