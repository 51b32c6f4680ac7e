#include "knowledge/rule_states.h"

#include <algorithm>
#include <utility>

#include "base/invariant.h"

namespace culprit {

RuleStates::RuleStates(const RuleSet& rules)
    : rules_(rules),
      states_(rules.rules.size()),
      bars_(rules.strategies.size()),
      failing_(rules.components.size()) {
  find_touching();
  for (std::size_t r = 0; r < rules.rules.size(); ++r) {
    states_[r].search = Search(rules.rules[r].strategies.size());
    const int window = rules.rules[r].policies.hold_window;
    if (window > 1) states_[r].detection.history.assign(static_cast<std::size_t>(window), false);
    const bool has_last = std::ranges::any_of(
        rules.rules[r].strategies, [&](StrategyId id) { return rules[id].is_last_resort; });
    if (has_last) with_last_resort_.emplace_back(r);
  }
  active_.reserve(rules.rules.size());
  exhausted_.reserve(rules.rules.size());
}

RuleStates::RuleStates(const RuleSet& rules, const RuleStates& other)
    : rules_(rules),
      states_(other.states_),
      active_(other.active_),
      exhausted_(other.exhausted_),
      with_last_resort_(other.with_last_resort_),
      bars_(other.bars_),
      failing_(other.failing_),
      touching_(other.touching_),
      first_touching_(other.first_touching_) {}

void RuleStates::find_touching() {
  std::vector<std::pair<ComponentId, RuleId>> pairs;
  for (std::size_t r = 0; r < rules_.rules.size(); ++r) {
    for (const ComponentId c : rules_.rules[r].components) pairs.emplace_back(c, RuleId(r));
  }
  std::sort(pairs.begin(), pairs.end());
  touching_.reserve(pairs.size());
  first_touching_.reserve(rules_.components.size() + 1);
  for (std::size_t c = 0, next = 0; c <= rules_.components.size(); ++c) {
    first_touching_.push_back(next);
    for (; next < pairs.size() && pairs[next].first == ComponentId(c); ++next)
      touching_.push_back(pairs[next].second);
  }
}

std::span<const RuleId> RuleStates::touching(ComponentId component) const {
  CULPRIT_ASSERT(component.index + 1 < first_touching_.size());
  const std::size_t first = first_touching_[component.index];
  return std::span(touching_).subspan(first, first_touching_[component.index + 1] - first);
}

std::size_t RuleStates::place_of(StrategyId id) const {
  const auto& siblings = rules_[rules_[id].rule].strategies;
  const auto found = std::find(siblings.begin(), siblings.end(), id);
  CULPRIT_ASSERT(found != siblings.end());  // another strategy would count as tried
  return static_cast<std::size_t>(found - siblings.begin());
}

bool RuleStates::is_tried(StrategyId id) const {
  return states_[rules_[id].rule.index].search.tried[place_of(id)];
}

bool RuleStates::was_ever_tried(StrategyId id) const {
  return states_[rules_[id].rule.index].search.ever_tried[place_of(id)];
}

void RuleStates::set_tried(StrategyId id, bool tried) {
  Search& search = states_[rules_[id].rule.index].search;
  search.tried[place_of(id)] = tried;
  if (tried) search.ever_tried[place_of(id)] = true;
}

void RuleStates::begin_search(RuleId id, Time now) {
  RuleState& state = states_[id.index];
  state.failing_since = now;
  if (const auto left_off = std::exchange(state.left_off, std::nullopt)) {
    state.search = left_off->search;
    state.recurring_since = left_off->since;
  } else {
    state.search = Search(rules_[id].strategies.size());
    state.search.times = 1;
  }
  state.search.attempts_before = state.search.attempts;
  state.search.retry_at = std::max(now, state.search.retry_at);
}

void RuleStates::go_on_searching(RuleId id, Time now) {
  RuleState& state = states_[id.index];
  state.failing_since = now;
  state.search.attempts_before = state.search.attempts;
  ++state.search.times;
}

void RuleStates::advise_anew() {
  for (RuleState& state : states_) state.is_advised = state.is_last_resort_advised = false;
}

namespace {

void change(std::vector<RuleId>& set, RuleId id, bool is_in) {
  const auto place = std::lower_bound(set.begin(), set.end(), id);
  // A rule that is in it twice stays in it for ever: its components stay reserved.
  CULPRIT_ASSERT(is_in == (place == set.end() || *place != id));
  if (is_in) {
    set.insert(place, id);
  } else {
    set.erase(place);
  }
}

}  // namespace

void RuleStates::enter(RuleId id, RulePhase phase) {
  const RulePhase before = std::exchange(states_[id.index].phase, phase);
  const bool was_exhausted = before == RulePhase::kExhausted;
  const bool is_exhausted = phase == RulePhase::kExhausted;
  if (was_exhausted != is_exhausted) change(exhausted_, id, is_exhausted);
  const bool was = is_active(before);
  const bool is = is_active(phase);
  if (was == is) return;
  change(active_, id, is);
  const auto level = static_cast<std::size_t>(rules_[id].policies.criticality);
  for (const ComponentId component : rules_[id].components) {
    int& rules = failing_[component.index][level];
    rules += is ? 1 : -1;
    CULPRIT_ASSERT(rules >= 0);  // it would look well while another rule fails
  }
}

bool RuleStates::is_sick(ComponentId component, Criticality level, RuleId except) const {
  int rules = 0;
  for (auto l = static_cast<std::size_t>(level); l < 3; ++l) rules += failing_[component.index][l];
  if (rules != 1) return rules > 1;
  // The one rule may be the exception.
  if (!is_active(states_[except.index].phase) || rules_[except].policies.criticality < level)
    return true;
  const auto& touched = rules_[except].components;
  return !std::binary_search(touched.begin(), touched.end(), component);
}

template <class Counts>
std::optional<RuleId> RuleStates::worst_at(ComponentId component, Criticality level, RuleId except,
                                           Counts counts) const {
  std::optional<RuleId> worst;
  for (const RuleId id : touching(component)) {
    if (id == except || rules_[id].policies.criticality < level || !counts(id)) continue;
    const auto rank = [&](RuleId r) {
      return std::pair<int, const std::string&>(-static_cast<int>(rules_[r].policies.criticality),
                                                rules_[r].name);
    };
    if (!worst || rank(id) < rank(*worst)) worst = id;
  }
  return worst;
}

std::optional<RuleId> RuleStates::sickness(ComponentId component, Criticality level,
                                           RuleId except) const {
  return worst_at(component, level, except, [this](RuleId id) { return is_active(id); });
}

bool RuleStates::awaits_person(RuleId id) const {
  const RuleState& state = states_[id.index];
  const Slot& trigger = state.detection.trigger;
  return state.phase == RulePhase::kExhausted && (!trigger.known || trigger.b);
}

std::optional<RuleId> RuleStates::awaiting_person_at(ComponentId component, Criticality level,
                                                     RuleId except) const {
  return worst_at(component, level, except, [this](RuleId id) { return awaits_person(id); });
}

bool RuleStates::reserves(const std::optional<Attempt>& attempt, ComponentId component) const {
  if (!attempt || attempt->stage == Attempt::Stage::kSuspended) return false;
  const auto& adapted = rules_[attempt->strategy].components;
  return std::binary_search(adapted.begin(), adapted.end(), component);
}

const Attempt* RuleStates::reservation(ComponentId component) const {
  const auto is_last_resort = [&](const Attempt& each) {
    return rules_[each.strategy].is_last_resort;
  };
  const Attempt* found = nullptr;
  for_each_reservation(component, [&](const Attempt& each) {
    if (found == nullptr || (is_last_resort(each) && !is_last_resort(*found))) found = &each;
  });
  return found;
}

const Attempt* RuleStates::attempt_of(StrategyId id) const {
  const RuleState& state = states_[rules_[id].rule.index];
  const auto& attempt = rules_[id].is_last_resort ? state.last_resort : state.attempt;
  return attempt && attempt->strategy == id ? &*attempt : nullptr;
}

std::optional<Attempt>& RuleStates::slot_of(StrategyId id) {
  RuleState& state = states_[rules_[id].rule.index];
  return rules_[id].is_last_resort ? state.last_resort : state.attempt;
}

}  // namespace culprit
