#include "execute/storm_watch.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/sort_unique.h"
#include "diagnose/awaited.h"
#include "diagnose/causes.h"
#include "diagnose/imminent.h"
#include "diagnose/touched.h"

namespace culprit::execute {

StormWatch::StormWatch(const Knowledge& knowledge, EventLog& events, Options options)
    : knowledge_(knowledge),
      events_(events),
      options_(options),
      is_dead_(knowledge.rules.components.size()),
      recent_(knowledge.rules.rules.size()) {}

void StormWatch::advance(Time now) {
  if (options_.share <= 0) return;
  note(knowledge_.events);
  const bool is_due = look_again_ <= now;
  if (!std::exchange(has_news_, false) && !storm_ && !is_due) return;
  look_again_ = kNever;
  doubt_.reset();
  if (auto seen = look(now)) {
    if (!storm_) events_.tell(now, StormBegan{seen->restraint, seen->reason});
    storm_ = std::move(seen);
    over_ = later(now, options_.calm);
  } else if (storm_ && over_ <= now) {
    storm_.reset();
    events_.tell(now, StormEnded{});
  }
}

bool StormWatch::is_much(std::size_t components) const {
  const auto all = static_cast<double>(knowledge_.rules.components.size());
  return components >= static_cast<std::size_t>(options_.least) &&
         static_cast<double>(components) >= options_.share * all;
}

std::optional<StormWatch::Storm> StormWatch::look(Time now) {
  look_for_dead();
  look_for_failures(now);
  const std::size_t all = knowledge_.rules.components.size();
  std::size_t unseen = 0;
  std::size_t out_of_reach = 0;
  for (std::size_t c = 0; c < all; ++c) {
    const ComponentState& state = knowledge_.components[ComponentId(c)];
    const bool runs = state.pid != 0 && state.process == ProcessState::kRunning;
    if (state.alive != false || !knowledge_.discovered.has(ComponentId(c))) continue;
    if (!state.in_graph && runs) ++unseen;
    // Its lease may say for long that it is there.
    if (state.known_pid() == 0 && !knowledge_.is_unheard(ComponentId(c))) ++out_of_reach;
  }
  const auto count = [all](std::size_t some) {
    return std::to_string(some) + " of " + std::to_string(all) + " components";
  };
  if (is_much(unseen)) {
    return Storm{Restraint::kGraphInDoubt,
                 count(unseen) + " left the graph while their processes run; is it the network?"};
  }
  if (is_much(out_of_reach)) {
    return Storm{Restraint::kGraphInDoubt, count(out_of_reach) +
                                               " are on another computer and do not answer; is it "
                                               "the network?"};
  }
  if (knowledge_.states.active().size() + lately_.size() < static_cast<std::size_t>(options_.least))
    return {};
  if (!is_much(ill_roots({std::vector<bool>(all), {all, std::nullopt}}).components))
    return std::nullopt;
  Suspects suspects = all_suspects();
  IllRoots ill = ill_roots(suspects);
  if (!is_much(ill.components)) return std::nullopt;
  add_awaited(suspects);
  const std::string many = count(ill.components) + " failed at once, and ";
  if (is_much(ill_roots(suspects).components))
    return Storm{Restraint::kStorm, many + "none explains the others"};
  doubt_ = Doubt{std::move(ill.failures), many + "a rule that may still fire may explain them"};
  return std::nullopt;
}

void StormWatch::look_for_dead() {
  std::vector<bool> is_ill(is_dead_.size());
  for (const RuleId id : knowledge_.states.active()) {
    for (const ComponentId component : knowledge_.rules[id].components)
      is_ill[component.index] = true;
  }
  for (std::size_t c = 0; c < is_dead_.size(); ++c) {
    const ComponentState& state = knowledge_.components[ComponentId(c)];
    const bool is_gone = state.pid != 0 && state.process == ProcessState::kGone;
    is_dead_[c] = is_gone || (is_dead_[c] && is_ill[c]);
  }
}

void StormWatch::look_for_failures(Time now) {
  const auto is_recent = [&](Time began) { return now < later(began, options_.together); };
  for (const RuleId id : knowledge_.states.active()) {
    const RuleState& state = knowledge_.states[id];
    if (!is_recent(state.failing_since)) continue;
    Recent& recent = recent_[id.index];
    if (recent.began == kLongAgo) lately_.push_back(id);
    recent.began = state.failing_since;
    // During an attempt it may be culprit that ended the process.
    const auto& components = knowledge_.rules[id].components;
    recent.has_clear_cause |=
        !state.attempt &&
        (knowledge_.unheard_behind(id) ||
         std::ranges::any_of(components, [&](ComponentId c) { return is_dead_[c.index]; }));
  }
  std::erase_if(lately_, [&](RuleId id) {
    if (is_recent(recent_[id.index].began)) return false;
    recent_[id.index] = {};
    return true;
  });
}

StormWatch::Suspects StormWatch::all_suspects() const {
  Suspects suspects{std::vector<bool>(knowledge_.rules.components.size()),
                    diagnose::all_troubles(knowledge_)};
  for (const RuleId rule : diagnose::imminent_rules(knowledge_)) {
    for (const ComponentId component : knowledge_.rules[rule].components)
      suspects.rules[component.index] = true;
  }
  return suspects;
}

// Where a rule can still fire as the cause of a failure: until then, their number proves nothing.
void StormWatch::add_awaited(Suspects& suspects) {
  const diagnose::Awaited awaited(knowledge_, knowledge_.states.active());
  for (const RuleId failure : knowledge_.states.active()) {
    const auto found = awaited.of(failure);
    if (!found || found->is_echo) continue;
    for (const ComponentId component : diagnose::spreads_from(found->because, knowledge_))
      suspects.rules[component.index] = true;
    look_again_ = std::min(look_again_, found->until);
  }
}

// Components that a failing rule is about, or one whose failure began a moment ago and is gone, and that
// nothing upstream explains; and these failures.
StormWatch::IllRoots StormWatch::ill_roots(const Suspects& suspects) const {
  std::vector<RuleId> failures = knowledge_.states.active();
  std::ranges::copy_if(lately_, std::back_inserter(failures),
                       [&](RuleId id) { return !knowledge_.states.is_active(id); });
  IllRoots found;
  std::vector<ComponentId> roots;
  for (const RuleId id : failures) {
    for (const ComponentId component : knowledge_.rules[id].components) {
      if (has_clear_cause(id, component)) continue;
      const auto& upstream = knowledge_.graph.upstream(component);
      const bool is_explained = std::ranges::any_of(upstream, [&](ComponentId other) {
        return other != component && is_explained_by(other, id, suspects);
      });
      if (is_explained) continue;
      roots.push_back(component);
      found.failures.push_back(id);
      break;  // one failure of several components is one that has failed
    }
  }
  sort_unique(roots);
  found.components = roots.size();
  return found;
}

// The death of a component is no riddle; it is to be brought back.
bool StormWatch::has_clear_cause(RuleId failure, ComponentId component) const {
  const Recent& recent = recent_[failure.index];
  if (recent.began != kLongAgo) return recent.has_clear_cause;
  return is_dead_[component.index] || knowledge_.unheard_behind(failure);
}

bool StormWatch::is_explained_by(ComponentId component, RuleId failure,
                                 const Suspects& suspects) const {
  return is_dead_[component.index] || suspects.rules[component.index] ||
         is_or_was_ill(component, failure) || is_in_trouble(component, failure, suspects) ||
         was_in_trouble(component, failure);
}

// Is or was there a failure of it, other than that of `except`?
bool StormWatch::is_or_was_ill(ComponentId component, RuleId except) const {
  if (knowledge_.states.is_sick(component, Criticality::kNonCritical, except)) return true;
  return std::ranges::any_of(knowledge_.states.touching(component), [&](RuleId rule) {
    return rule != except && recent_[rule.index].began != kLongAgo;
  });
}

// Is it in a trouble that can explain the failure? A function that worked beside it for long failed for another cause.
bool StormWatch::is_in_trouble(ComponentId component, RuleId failure,
                               const Suspects& suspects) const {
  const auto& trouble = suspects.troubles[component.index];
  if (!trouble) return false;
  const RuleState& state = knowledge_.states[failure];
  const bool never_worked = state.detection.last_false == kLongAgo;
  return never_worked || !state.onset ||
         state.onset->earliest <= later(trouble->onset.latest, diagnose::kUsualDelay);
}

// Did the failure begin with a trouble of it that is over?
bool StormWatch::was_in_trouble(ComponentId component, RuleId failure) const {
  const auto& past = knowledge_.components[component].past_trouble;
  const auto& onset = knowledge_.states[failure].onset;
  return past && onset && past->may_have_led_to(*onset) &&
         onset->earliest <= later(past->since, diagnose::kUsualDelay);
}

}  // namespace culprit::execute
