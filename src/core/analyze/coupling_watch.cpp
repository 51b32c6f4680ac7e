#include "analyze/coupling_watch.h"

#include <algorithm>

#include "diagnose/awaited.h"
#include "diagnose/causes.h"
#include "diagnose/touched.h"
#include "knowledge/ambiguity.h"

namespace culprit {

void CouplingWatch::resolved(const Attempt& attempt, bool is_proven, Time now) {
  const StrategyId strategy = attempt.strategy;
  const RuleId cause = knowledge_.rules[strategy].rule;
  // Some show it before the failure that was repaired does.
  for (const Clearing& clearing : clearings_) {
    if (is_proven && clearing.gone > attempt.first_change && clearing.rule != cause &&
        is_only_cause(strategy, clearing.rule, attempt.first_change)) {
      write_.couplings.cleared(cause, clearing.rule);
      note_fired(cause, fired_after(clearing.began, cause));
    }
  }
  settle(knowledge_.rules[strategy].components, cause, attempt.effective, {}, now);
  for (const RuleId effect : knowledge_.states.active()) {
    const RuleState& state = knowledge_.states[effect];
    if (effect == cause || state.attempt) continue;
    if (!is_proven || questions_.size() >= kMostWatched) continue;
    const Time gone = later(now, delay(cause, effect));
    const Time echo = echo_of(cause, effect, now);
    const Time shown = std::max(gone, echo);
    const Time due = std::max(
        later(gone, std::max(knowledge_.signals.latency(effect), knowledge_.rules.cycle)), echo);
    const Time began = diagnose::onset_of(effect, knowledge_).latest;
    questions_.push_back({strategy, effect, attempt.first_change, state.failing_since, gone, shown,
                          due, later(due, kPatience), fired_after(began, cause)});
  }
}

// Until when the effect is taken for an echo of `cause`, which clears now. The next reading of two values shows that.
Time CouplingWatch::echo_of(RuleId cause, RuleId effect, Time now) const {
  const auto is_value = [&](RuleId rule) {
    return diagnose::symptom_of(rule, knowledge_) == diagnose::Symptom::kValue;
  };
  const bool is_mended = diagnose::is_mended(effect, knowledge_.rules);
  if (is_value(effect) && (is_value(cause) || !is_mended)) return now;
  const Time over = diagnose::recovered(cause, gone_since(cause, now), knowledge_);
  return diagnose::echo_ends(effect, cause, over, duration_of(diagnose::kPassing, knowledge_.rules),
                             knowledge_);
}

void CouplingWatch::note_fired(RuleId cause, Duration after) {
  if (after <= kLongestDelay) write_.latencies.fired(cause, after);
}

// How much later than its readings allow the cause was detected, if an effect of it `began` then.
Duration CouplingWatch::fired_after(Time began, RuleId cause) const {
  return knowledge_.states[cause].first_detected() - began -
         diagnose::reading_of(cause, knowledge_) - held(cause);
}

// With HOLD, the evaluations that a rule looks at.
Duration CouplingWatch::held(RuleId rule) const {
  const int window = knowledge_.rules[rule].policies.hold_window;
  return duration_of(Cycles{window > 1 ? window : 0}, knowledge_.rules);
}

// How long `effect` may take to clear after `cause`.
Duration CouplingWatch::delay(RuleId cause, RuleId effect) const {
  const RuleState& of_cause = knowledge_.states[cause];
  const Time cause_came = of_cause.first_detected();
  const Time effect_came = knowledge_.states[effect].first_detected();
  if (effect_came <= cause_came) return held(effect);  // also if the cause never came by itself
  if (effect_came <= later(cause_came, kLongestDelay)) {
    const Duration came = effect_came - cause_came;
    return held(effect) + came + came / 2;
  }
  const bool recurs = of_cause.first_detected() != of_cause.failing_since;
  return held(effect) + (recurs ? duration_of(kUsualDelay, knowledge_.rules) : Duration::zero());
}

// Failures downstream of these components get the time to clear, now that the failure `cause` has
// cleared. A failure is no effect of the cause, and gets no time, in three cases: it is more
// critical and at the same component; it was detected long before the cause began; or only after
// things had `changed`. If an effect may have come `on_its_way`, it may be detected up to so much
// later than the cause.
void CouplingWatch::settle(const std::vector<ComponentId>& repaired, RuleId cause, Time changed,
                           std::optional<Cycles> on_its_way, Time now) {
  std::vector<bool> is_downstream(knowledge_.rules.components.size(), false);
  for (const ComponentId c : repaired) {
    for (const ComponentId d : knowledge_.graph.downstream(c)) is_downstream[d.index] = true;
  }
  const Duration slack = std::max(knowledge_.signals.latency(cause), knowledge_.rules.cycle);
  const Time begun = knowledge_.states[cause].first_detected();
  // Its alarm may have come last.
  const Time last_onset = diagnose::onset_of(cause, knowledge_).earliest;
  const Time onset = std::min(begun, last_onset);
  const auto criticality = knowledge_.rules[cause].policies.criticality;
  for (const RuleId effect : knowledge_.states.active()) {
    const RuleState& state = knowledge_.states[effect];
    if (effect == cause || state.attempt) continue;
    const bool may_be_on_its_way =
        on_its_way && state.first_detected() <=
                          later(begun, duration_of(*on_its_way, knowledge_.rules) + held(effect));
    if (state.failing_since > changed && !may_be_on_its_way) continue;
    const auto& touched = knowledge_.rules[effect].components;
    const bool is_lesser = knowledge_.rules[effect].policies.criticality <= criticality;
    const bool depends = std::any_of(touched.begin(), touched.end(), [&](ComponentId c) {
      return is_downstream[c.index] ||
             (is_lesser && std::find(repaired.begin(), repaired.end(), c) != repaired.end());
    });
    // It was there while a cause that comes and goes was not.
    const Duration lasts =
        diagnose::kLongestPlainEvidence + diagnose::remembers(effect, knowledge_.rules);
    const bool outlasts =
        later(state.failing_since, slack) < last_onset && later(state.failing_since, lasts) < now;
    if (!depends || outlasts || later(state.first_detected(), slack) < onset) continue;
    const Duration latency = std::max(knowledge_.signals.latency(effect), knowledge_.rules.cycle);
    const Time since = later(now, delay(cause, effect));
    if (!state.settling || state.settling->until < later(since, latency))
      write_.states.expect_to_settle(effect, {cause, since, later(since, latency)});
  }
}

// When the repair of a failure took effect: the last change upstream since it was detected, or just
// now if there was none.
Time CouplingWatch::last_change_for(RuleId cleared, Time now) const {
  const Sources sources(knowledge_, cleared);
  const Time detected = knowledge_.states[cleared].failing_since;
  std::optional<Time> last;
  const auto consider = [&](StrategyId strategy, Time effective) {
    if (effective >= detected && effective <= now &&
        sources.have(knowledge_.rules[strategy].components))
      last = std::max(last.value_or(effective), effective);
  };
  for (const Change& change : changes_) consider(change.strategy, change.effective);
  for (const RuleId id : knowledge_.states.active()) {
    const auto& attempt = knowledge_.states[id].attempt;
    if (attempt) consider(attempt->strategy, attempt->effective);
  }
  return last.value_or(now);
}

// When the trigger of a rule that clears now became false. With HOLD it may be true again by chance.
Time CouplingWatch::gone_since(RuleId rule, Time now) const {
  const Detection& detection = knowledge_.states[rule].detection;
  const bool is_false = detection.trigger.known && !detection.trigger.b;
  return is_false ? detection.trigger_since : now;
}

void CouplingWatch::cleared(RuleId rule, Time now) {
  forget_what_is_settled(now);
  const Time gone = gone_since(rule, now);
  clearings_.push_back({rule, gone, now, diagnose::onset_of(rule, knowledge_).latest});
  settle(knowledge_.rules[rule].components, rule, last_change_for(rule, now), kUsualDelay, now);
  std::erase_if(questions_, [&](const Question& q) {
    if (q.effect != rule) return false;
    if (gone > q.since && is_only_cause(q.strategy, rule, q.since)) {
      const RuleId cause = knowledge_.rules[q.strategy].rule;
      write_.couplings.cleared(cause, rule);
      note_fired(cause, q.fired);
    }
    return true;
  });
}

void CouplingWatch::exposed_others(RuleId cause, Time now) {
  const auto& onset = knowledge_.states[cause].onset;
  if (!onset) return;  // an earlier culprit detected it
  const Time began = onset->latest;
  const Time would_show = later(began, diagnose::kUsualDelay);
  const Time gone = gone_since(cause, now);
  if (gone <= would_show) return;
  const double times = seconds(gone - began) / seconds(diagnose::kUsualDelay);
  std::vector<RuleId> effects;
  for (const ComponentId c : knowledge_.graph.downstream(knowledge_.rules[cause].components)) {
    const auto& touching = knowledge_.states.touching(c);
    effects.insert(effects.end(), touching.begin(), touching.end());
  }
  std::ranges::sort(effects);
  effects.erase(std::unique(effects.begin(), effects.end()), effects.end());
  for (const RuleId effect : effects) {
    const RuleState& state = knowledge_.states[effect];
    const bool stayed_away = effect != cause && state.phase == RulePhase::kQuiet &&
                             state.gone_since <= began && is_well_after(would_show, effect);
    if (stayed_away) write_.couplings.stayed_away(cause, effect, std::min(times, kLongestExposure));
  }
}

// Is the trigger false, and has all that it reads come since then?
bool CouplingWatch::is_well_after(Time since, RuleId rule) const {
  const Slot& trigger = knowledge_.states[rule].detection.trigger;
  return trigger.known && !trigger.b &&
         std::ranges::all_of(knowledge_.rules[rule].inputs, [&](InputId id) {
           const Input& input = knowledge_.rules[id];
           if (diagnose::watches_a_component(input)) return true;
           if (!diagnose::watches_a_topic(input)) return knowledge_.signals.read_at(id) > since;
           const auto& last = knowledge_.signals.rhythm(input.topic).last;
           return last && *last > since;
         });
}

void CouplingWatch::ended(const Attempt& attempt, Time now) {
  forget_what_is_settled(now);
  if (attempt.first_change != kNever)
    changes_.push_back({attempt.strategy, attempt.first_change, attempt.effective, now});
}

void CouplingWatch::advance(Time now) {
  std::erase_if(questions_, [&](Question& q) {
    const Time due = diagnose::settles_by(q.effect, q.gone, q.due, knowledge_);
    if (now < due && !knowledge_.signals.is_read_since(q.effect, q.shown)) return false;
    const RuleState& state = knowledge_.states[q.effect];
    const bool is_other = state.phase == RulePhase::kQuiet || state.failing_since != q.detected;
    if (is_other || now >= q.abandoned) return true;
    // On its way out, or out of sight: it is asked again.
    if (!state.detection.trigger.known || !state.detection.trigger.b) {
      q.gone = now;
      q.due = later(now, knowledge_.rules.cycle);
      return false;
    }
    if (is_only_cause(q.strategy, q.effect, q.since))
      write_.couplings.stayed(knowledge_.rules[q.strategy].rule, q.effect);
    return true;
  });
}

Time CouplingWatch::next_deadline() const {
  Time next = kNever;
  for (const Question& q : questions_)
    next = std::min(next, diagnose::settles_by(q.effect, q.gone, q.due, knowledge_));
  return next;
}

// When `change` has had its effect on the failure of `rule`, if it has one.
Time CouplingWatch::shown(const Change& change, RuleId rule) const {
  const RuleId cause = knowledge_.rules[change.strategy].rule;
  const Time came = knowledge_.states[rule].first_detected();
  if (came < change.begin || !may_hide(knowledge_, cause, rule))
    return later(change.end, delay(cause, rule));
  // The change revealed it. How late it appeared is no measure of how long it takes to clear. A
  // fresh reading shows it.
  const Duration usual = held(rule) + duration_of(kUsualDelay, knowledge_.rules);
  return std::max(later(change.end, usual),
                  later(std::min(change.effective, change.end), knowledge_.signals.latency(rule)));
}

// The same, if an attempt at that failure took down components that would have shown the recovery:
// it can show only once they are up again.
Time CouplingWatch::shown_after_all(const Change& change, RuleId rule) const {
  Time at = shown(change, rule);
  const Duration delay = at - change.end;
  for (const Change& own : changes_) {
    const bool is_own = knowledge_.rules[own.strategy].rule == rule;
    if (is_own && own.begin >= change.begin && own.begin < at &&
        begins_anew(knowledge_.rules[own.strategy]))
      at = std::max(at, later(std::min(own.effective, own.end), delay));
  }
  return at;
}

// Can nothing but `strategy` have changed `effect` since then?
bool CouplingWatch::is_only_cause(StrategyId strategy, RuleId effect, Time since) const {
  const RuleId cause = knowledge_.rules[strategy].rule;
  const Sources sources(knowledge_, effect);
  const auto is_rival = [&](StrategyId other) {
    return other != strategy && (knowledge_.rules[other].rule == effect ||
                                 sources.have(knowledge_.rules[other].components));
  };
  for (const Change& change : changes_) {
    // Earlier attempts at the same failure did not help.
    const bool is_own = knowledge_.rules[change.strategy].rule == cause;
    const bool is_over = change.end < since && (is_own || shown(change, effect) <= since);
    if (!is_over && is_rival(change.strategy)) return false;
  }
  for (const RuleId id : knowledge_.states.active()) {
    const auto& attempt = knowledge_.states[id].attempt;
    if (attempt && attempt->first_change != kNever && is_rival(attempt->strategy)) return false;
  }
  const auto& adapted = knowledge_.rules[strategy].components;
  return std::none_of(clearings_.begin(), clearings_.end(), [&](const Clearing& clearing) {
    return clearing.at >= since && clearing.rule != effect && clearing.rule != cause &&
           sources.have(knowledge_.rules[clearing.rule].components) &&
           !can_resolve(knowledge_, adapted, clearing.rule);
  });
}

bool CouplingWatch::is_echo(const Attempt& attempt) const {
  const RuleId rule = knowledge_.rules[attempt.strategy].rule;
  const Sources sources(knowledge_, rule);
  const Time began = diagnose::onset_of(rule, knowledge_).latest;
  const Duration latency = knowledge_.signals.latency(rule);
  return std::any_of(changes_.begin(), changes_.end(), [&](const Change& change) {
    // A failure that began only after the change cannot be about to clear with it.
    return knowledge_.rules[change.strategy].rule != rule &&
           began < later(change.effective, latency) &&
           shown_after_all(change, rule) > attempt.first_change &&
           is_rival(knowledge_, change.strategy, sources, rule);
  });
}

// Was something that it depends on in trouble when it began, and is not any more?
bool CouplingWatch::has_supply_back(RuleId rule) const {
  const Onset& began = *knowledge_.states[rule].onset;
  const auto& upstream = knowledge_.graph.upstream(knowledge_.rules[rule].components);
  return std::ranges::any_of(upstream, [&](ComponentId component) {
    const auto& trouble = knowledge_.components[component].past_trouble;
    return trouble && trouble->may_have_led_to(began);
  });
}

bool CouplingWatch::is_unaided(RuleId rule) const {
  const RuleState& state = knowledge_.states[rule];
  if (!state.onset || has_supply_back(rule)) return false;
  const Time gone = state.detection.trigger_since;
  const Sources sources(knowledge_, rule);
  const auto may_have_helped = [&](StrategyId strategy, Time begin) {
    return begin <= gone && sources.have(knowledge_.rules[strategy].components);
  };
  const bool is_helped = std::ranges::any_of(changes_, [&](const Change& change) {
    return shown(change, rule) >= state.onset->earliest &&
           may_have_helped(change.strategy, change.begin);
  });
  return !is_helped && std::ranges::none_of(knowledge_.states.active(), [&](RuleId id) {
    const auto& attempt = knowledge_.states[id].attempt;
    return attempt && may_have_helped(attempt->strategy, attempt->first_change);
  });
}

bool CouplingWatch::is_changed_since(RuleId rule, Time since) const {
  const Sources sources(knowledge_, rule);
  const auto may_have_helped = [&](StrategyId strategy) {
    const Strategy& other = knowledge_.rules[strategy];
    return other.rule != rule &&
           (sources.have(other.components) || knowledge_.coincidences.coincide(other.rule, rule) ||
            knowledge_.couplings.of(other.rule, rule).cleared > 0);
  };
  const bool has_ended = std::ranges::any_of(changes_, [&](const Change& change) {
    return change.end >= since && may_have_helped(change.strategy);
  });
  return has_ended || std::ranges::any_of(knowledge_.states.active(), [&](RuleId id) {
           const auto& attempt = knowledge_.states[id].attempt;
           return attempt && attempt->first_change != kNever && may_have_helped(attempt->strategy);
         });
}

// No query is about a time before all of these: the last `kPatience`, the first open question, and
// the first attempt under way.
void CouplingWatch::forget_what_is_settled(Time now) {
  Time horizon = now - kPatience;
  for (const Question& q : questions_) horizon = std::min(horizon, q.since);
  for (const RuleId id : knowledge_.states.active()) {
    const auto& attempt = knowledge_.states[id].attempt;
    if (attempt) horizon = std::min(horizon, attempt->first_change);
  }
  std::erase_if(changes_, [&](const Change& change) { return change.end < horizon; });
  std::erase_if(clearings_, [&](const Clearing& clearing) { return clearing.at < horizon; });
}

}  // namespace culprit
