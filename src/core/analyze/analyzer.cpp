#include "analyze/analyzer.h"

#include <algorithm>
#include <utility>

#include "analyze/backoff.h"
#include "diagnose/timing.h"
#include "knowledge/ambiguity.h"
#include "knowledge/undoes.h"

namespace culprit {

Analyzer::Analyzer(const Knowledge& knowledge, Writes writes, Time start, Time discovered)
    : knowledge_(knowledge),
      write_(writes),
      deadlines_(knowledge.rules.rules.size()),
      blind_(knowledge, {writes.blindness, writes.events}, start, discovered),
      detector_(knowledge, writes.states),
      verdicts_(knowledge, detector_),
      left_off_(knowledge, writes.states),
      couplings_(knowledge, {writes.states, writes.couplings, writes.latencies}),
      lateness_(knowledge, writes.latencies),
      outcomes_(knowledge, {writes.beliefs, writes.outcomes, writes.events}),
      fights_(knowledge, writes.states),
      last_resorts_(knowledge, {writes.states, writes.events, couplings_, fights_}) {}

void Analyzer::advance(Time now) {
  write_.transients.advance(now);
  for (const RuleId id : write_.signals.take_touched()) look_at(id, now);
  while (const auto due = deadlines_.pop_due(now)) look_at(RuleId(*due), now);
  couplings_.advance(now);
  outcomes_.advance(now);
  lateness_.advance(now);
}

void Analyzer::restart(Time now) {
  couplings_.restart();
  outcomes_.restart();
  blind_.restart(now);
  write_.transients.restart();
  for (std::size_t r = 0; r < knowledge_.rules.rules.size(); ++r) {
    const RuleId id(r);
    RuleState& state = write_.states.state(id);
    detector_.restart(id, now);
    if (state.attempt) {
      state.attempt->is_ambiguous = true;
      if (state.attempt->stage == Attempt::Stage::kWaiting) state.attempt->effective = now;
    }
    look_at(id, now);
  }
}

std::vector<RuleId> Analyzer::plannable(Time now) const {
  std::vector<RuleId> ids;
  for (const RuleId id : knowledge_.states.active()) {
    const RuleState& state = knowledge_.states[id];
    const bool wants_help = state.phase == RulePhase::kFailing && is_true(state.detection.trigger);
    if (wants_help && state.search.retry_at <= now && !state.is_advised) ids.push_back(id);
  }
  for (const RuleId id : knowledge_.states.exhausted()) {
    const RuleState& state = knowledge_.states[id];
    const bool is_due = goes_on(id) && state.search.retry_at <= now && !state.is_advised;
    if (is_due) ids.insert(std::ranges::upper_bound(ids, id), id);
  }
  return ids;
}

bool Analyzer::goes_on(RuleId id) const {
  if (!knowledge_.states.awaits_person(id)) return false;
  return std::ranges::any_of(knowledge_.rules[id].strategies,
                             [&](StrategyId strategy) { return knowledge_.goes_on(strategy); });
}

bool Analyzer::anything_to_do(Time now) const {
  const auto is_open = [&](RuleId id) {
    return knowledge_.states[id].last_resort || last_resorts_.next(id) ||
           (goes_on(id) && knowledge_.states[id].search.retry_at <= now);
  };
  return !knowledge_.states.active().empty() ||
         std::ranges::any_of(knowledge_.states.exhausted(), is_open);
}

Time Analyzer::next_start() const {
  Time next = kNever;
  for (const RuleId id : knowledge_.states.exhausted()) {
    if (goes_on(id)) next = std::min(next, knowledge_.states[id].search.retry_at);
  }
  return next;
}

void Analyzer::remember(const History& past) {
  for (const Event& event : past) {
    outcomes_.remember(event);
    left_off_.remember(event);
  }
}

bool Analyzer::is_proven(Time gone, Time now) const {
  return later(gone, knowledge_.outcomes.healthy) <= now;
}

void Analyzer::look_at(RuleId id, Time now) {
  evaluate_trigger(id, now);
  last_resorts_.judge(id, now);
  switch (knowledge_.states[id].phase) {
    case RulePhase::kQuiet:
      if (detector_.detects(id, now)) detect(id, now);
      break;
    case RulePhase::kFailing:
    case RulePhase::kExhausted:
      watch_failing(id, now);
      break;
    case RulePhase::kAttempting:
      judge(id, now);
      break;
  }
  last_resorts_.watch(id, now);
  schedule(id, now);
}

void Analyzer::evaluate_trigger(RuleId id, Time now) {
  RuleState& state = write_.states.state(id);
  detector_.evaluate(id, now);
  if (is_true(state.detection.trigger)) state.cleared_by.reset();
  if (is_false(state.detection.trigger) && state.left_off && !state.left_off->gone &&
      !verdicts_.missing_group(id, now))
    forget_left_off(id, now);
  blind_.evaluated(id, now);
}

// An earlier process left this failure unresolved, and it cleared before this process looked.
void Analyzer::forget_left_off(RuleId id, Time now) {
  LeftOff& left_off = *write_.states.state(id).left_off;
  left_off.gone = now;
  write_.events.tell(
      now, FailureResolved{id, FailureResolved::How::kWithoutStrategy, {}, now - left_off.since});
}

// And its function is there again: a component of a group is of no use while the group is not active, but for
// a pause, which somebody wishes.
bool Analyzer::is_gone(RuleId id, Time now) const {
  return detector_.is_cleared(id, now) && !verdicts_.missing_group(id, now);
}

void Analyzer::detect(RuleId id, Time now) {
  RuleState& state = write_.states.state(id);
  const bool was_repaired = state.repaired != kLongAgo && state.repaired == state.gone_since;
  const Duration soon = was_repaired ? kOutlasts : kRecurs;
  const bool recurs = state.gone_since != kLongAgo && now < later(state.gone_since, soon);
  // A rule with ON_CHANGE acts on each edge.
  // It may have become unknown, or false for another reason than that its function works.
  const Time worked = state.detection.last_false;
  const bool was_seen_working = worked == kLongAgo || worked > state.failing_since;
  const bool may_be_there = !was_seen_working || !is_proven(state.gone_since, now);
  const bool is_same =
      state.search.times > 0 && may_be_there && !knowledge_.rules[id].policies.on_change;
  left_off_.detected(id, now);
  // An earlier process detected it.
  const bool is_left_off = state.left_off.has_value();
  const bool is_said_to_be_exhausted = is_same && state.search.is_exhausted;
  state.recurring_since = recurs ? state.first_detected() : kNever;
  write_.transients.came_back(id);
  state.detection.armed = false;
  state.is_advised = state.is_last_resort_advised = false;
  state.tried_alone.reset();
  state.settling.reset();
  state.cleared_by.reset();
  // It is due anew, also if the failure is the same one.
  state.search.is_at_last_resort = false;
  state.search.last_resort_at = kLongAgo;
  state.search.refused.clear();
  if (is_same) {
    if (now < state.search.ready_until) take_back_starts(id);
    write_.states.go_on_searching(id, now);
  } else {
    write_.states.begin_search(id, now);
  }
  state.onset = diagnose::onset_now(id, now, knowledge_);
  state.masked_until = masked_until(id);
  state.unhelped_at = kLongAgo;
  if (!recurs) {
    state.first_onset = state.onset->latest;
    state.worked_until = state.detection.last_false;
  }
  if (!is_same && !recurs && !is_left_off) note_coincidence(id);
  for (const StrategyId strategy : knowledge_.rules[id].strategies) {
    const Strategy& last = knowledge_.rules[strategy];
    if (last.is_last_resort && !begins_anew(last)) write_.states.set_tried(strategy, false);
  }
  write_.states.enter(id, RulePhase::kFailing);
  write_.events.tell(now, detector_.detected(id));
  outcomes_.detected(id, now);
  fights_.detected(id, now);
  if (state.search.times == kFlaps) write_.events.tell(now, FailureFlaps{id, state.search.times});
  if (is_said_to_be_exhausted) {
    stay_exhausted(id, now);
  } else if (state.search.is_exhausted) {
    exhaust(id, now);
  } else {
    exhaust_if_spent(id, now);
  }
}

// A process that the last strategy started has ended within its READY: that was a try of one attempt.
void Analyzer::take_back_starts(RuleId id) {
  for (const StrategyId strategy : knowledge_.rules[id].strategies) {
    const auto& all = knowledge_.rules[strategy].adaptations;
    const bool has_ended = std::ranges::any_of(all, [&](const Adaptation& a) {
      return launches(a) && knowledge_.is_known_gone(a.component);
    });
    if (!has_ended || !knowledge_.states.is_tried(strategy)) continue;
    write_.states.set_tried(strategy, false);
    int& attempts = write_.states.state(id).search.attempts;
    attempts = std::max(attempts - 1, 0);  // one that was excused was not counted
  }
}

// Until when an end of what the attempt started is a try of it. A later try begins no new READY.
void Analyzer::note_ready(RuleId id, const Attempt& attempt) {
  Search& search = write_.states.state(id).search;
  if (attempt.first_change == kNever || attempt.first_change < search.ready_until) return;
  for (const Adaptation& a : knowledge_.rules[attempt.strategy].adaptations) {
    if (launches(a))
      search.ready_until = std::max(
          search.ready_until, later(attempt.first_change, knowledge_.rules[a.component].ready));
  }
}

// When it counts no more, since it can no longer be evaluated. A last resort holds until the failure is gone, and others wait
// for a person beside one at which nothing helped.
Time Analyzer::lost_at(RuleId id) const {
  const RuleState& state = knowledge_.states[id];
  if (!state.standing.empty()) return kNever;
  const bool is_exhausted = state.phase == RulePhase::kExhausted;
  return later(state.detection.trigger_since,
               is_exhausted ? kExhaustedLostAfter : DueVerdicts::kLostAfter);
}

void Analyzer::watch_failing(RuleId id, Time now) {
  const RuleState& state = knowledge_.states[id];
  if (is_gone(id, now)) {
    const auto tried = std::exchange(write_.states.state(id).tried_alone, std::nullopt);
    if (tried && !couplings_.is_changed_since(id, tried->effective))
      note_latency(id, tried->effective);
    if (const auto cleared_by = std::exchange(write_.states.state(id).cleared_by, std::nullopt)) {
      resolve(id, {id, FailureResolved::How::kByStrategy, cleared_by->strategy, {}}, now);
      outcomes_.judged(*cleared_by, true, now);
    } else if (const auto helped = last_resorts_.that_helped(id)) {
      resolve(id, {id, FailureResolved::How::kByStrategy, *helped, {}}, now);
    } else {
      note_transient(id);
      resolve(id, {id, FailureResolved::How::kWithoutStrategy, {}, {}}, now);
    }
  } else if (!state.detection.trigger.known && now >= lost_at(id)) {
    leave(id, now);
    write_.events.tell(now, FailureLost{id});
  }
}

void Analyzer::judge(RuleId id, Time now) {
  RuleState& state = write_.states.state(id);
  Attempt& attempt = *state.attempt;
  switch (attempt.stage) {
    case Attempt::Stage::kAdapting:
      if (attempt.obstacle.empty()) return;
      attempt.is_ambiguous |= couplings_.is_echo(attempt);
      return fail(id, now);
    case Attempt::Stage::kWaiting:
      break;
    case Attempt::Stage::kSuspended:
      if (!verdicts_.has_components_back(attempt)) break;
      attempt.stage = Attempt::Stage::kWaiting;
      attempt.effective = now;
      break;
    case Attempt::Stage::kUndoing:
      return;
    case Attempt::Stage::kOver: {
      const bool had_failure = !attempt.has_no_failure;
      end_attempt(id, now);
      if (!had_failure) return look_at(id, now);  // the failure may have come meanwhile
      exhaust_if_spent(id, now);
      return watch_failing(id, now);
    }
  }
  if (attempt.has_no_failure) {
    write_.events.tell(now, OrderCarriedOut{attempt.strategy});
    end_attempt(id, now);
    return look_at(id, now);
  }
  // Before anybody knows how it ends: what keeps an outcome from counting must not depend on it.
  if (attempt.deadline == kNever) {
    fights_.took_effect(attempt.strategy);
    note_that_it_stayed(id);
    attempt.is_ambiguous |=
        couplings_.is_echo(attempt) ||
        (!state.standing.empty() && attempt.effective <= state.search.last_resort_at);
  }

  // Anew each time: how long a signal takes to show a change may have become known meanwhile.
  if (attempt.spoke == kNever && verdicts_.has_spoken(attempt)) attempt.spoke = now;
  attempt.deadline = verdicts_.deadline(attempt);
  switch (verdicts_.verdict(attempt, now)) {
    case DueVerdicts::Verdict::kNotYet:
      return;
    case DueVerdicts::Verdict::kSucceeds:
      return succeed(id, now);
    case DueVerdicts::Verdict::kFails:
      return fail(id, now);
  }
}

void Analyzer::end_attempt(RuleId id, Time now) {
  const Attempt attempt = *std::exchange(write_.states.state(id).attempt, std::nullopt);
  couplings_.ended(attempt, now);
  // A start of what is gone, or a person's order: the failure was left to that person before.
  const bool is_left = knowledge_.states[id].search.is_exhausted;
  const RulePhase there = is_left ? RulePhase::kExhausted : RulePhase::kFailing;
  write_.states.enter(id, attempt.has_no_failure ? RulePhase::kQuiet : there);
}

void Analyzer::abandon(RuleId id, Time now) {
  end_attempt(id, now);
  look_at(id, now);  // the failure may be gone already, or have come
}

void Analyzer::yield_to_last_resort(RuleId id, Time now) {
  const Attempt& attempt = *knowledge_.states[id].attempt;
  if (attempt.first_change != kNever && !attempt.has_no_failure) {
    write_.states.set_tried(attempt.strategy, true);
    ++write_.states.state(id).search.attempts;
  }
  abandon(id, now);
}

void Analyzer::make_way(RuleId id, StrategyId other, Time now) {
  Attempt& attempt = *write_.states.state(id).attempt;
  const RuleSet& rules = knowledge_.rules;
  if (attempt.has_no_failure || undoes(rules[other], rules[attempt.strategy]))
    return abandon(id, now);
  attempt.stage = Attempt::Stage::kSuspended;
  attempt.is_ambiguous = true;
  schedule(id, now);
}

void Analyzer::succeed(RuleId id, Time now) {
  RuleState& state = write_.states.state(id);
  // As a failure would not count either.
  state.attempt->is_ambiguous |= verdicts_.unheard_behind(*state.attempt).has_value();
  const Attempt attempt = *std::exchange(state.attempt, std::nullopt);
  // The strategy that reserves its components meanwhile is as likely the cause.
  const bool is_suspended = attempt.stage == Attempt::Stage::kSuspended;
  const bool caused = !is_suspended && !verdicts_.went_away_before(attempt);
  if (caused) couplings_.resolved(attempt, !attempt.is_ambiguous, now);
  couplings_.ended(attempt, now);
  const auto& before = state.tried_alone;
  if (caused && before && before->strategy == attempt.strategy) {
    // Either time may have helped: the next time there is more patience with the first one.
    write_.latencies.suspect(id, state.detection.trigger_since - before->effective);
  } else if (caused && !attempt.is_ambiguous) {
    note_latency(id, attempt.effective);
  } else if (!caused && !is_suspended && before &&
             !couplings_.is_changed_since(id, before->effective)) {
    note_latency(id, before->effective);  // it helped after all, and its rule showed that late
  }
  state.tried_alone.reset();
  // Its components are free for what brings up the group.
  if (!knowledge_.rules[id].policies.on_change && verdicts_.missing_group(id, now)) {
    ++state.search.attempts;
    write_.states.set_tried(attempt.strategy, true);
    if (caused) state.cleared_by = attempt;
    return write_.states.enter(id, RulePhase::kFailing);
  }
  if (caused) {
    resolve(id, {id, FailureResolved::How::kByStrategy, attempt.strategy, {}}, now);
  } else {
    if (!is_suspended) note_transient(id);
    resolve(id, {id, FailureResolved::How::kWithoutStrategy, {}, {}}, now);
  }
  // If the failure comes back, this one was tried.
  note_ready(id, attempt);
  ++state.search.attempts;
  write_.states.set_tried(attempt.strategy, true);
  if (caused) outcomes_.judged(attempt, true, now);
}

void Analyzer::note_latency(RuleId id, Time effective) {
  const Time cleared = knowledge_.states[id].detection.trigger_since;
  if (effective != kNever && cleared >= effective)
    write_.latencies.cleared(id, cleared - effective);
}

// The failure clears, and no strategy was begun for it. A report has none: others may have repaired it.
void Analyzer::note_transient(RuleId id) {
  if (knowledge_.rules[id].strategies.empty()) return;
  const RuleState& state = knowledge_.states[id];
  const Search& search = state.search;
  if (search.attempts == search.attempts_before && couplings_.is_unaided(id))
    write_.transients.cleared(id, state.failing_since, state.detection.trigger_since);
}

// The first strategy for it takes effect. Was it left alone until then for as long as such failures take to
// clear by themselves?
void Analyzer::note_that_it_stayed(RuleId id) {
  const RuleState& state = knowledge_.states[id];
  const Search& search = state.search;
  const Duration patience = write_.transients.patience(id);
  if (patience > Duration::zero() && search.attempts == search.attempts_before &&
      state.attempt->first_change >= later(state.first_detected(), patience) &&
      is_true(state.detection.trigger))
    write_.transients.stayed(id);
}

// Began another failure with it that the graph does not connect with it?
void Analyzer::note_coincidence(RuleId id) {
  constexpr Duration kTogether = std::chrono::milliseconds(500);
  const Onset onset = *knowledge_.states[id].onset;
  const auto& own = knowledge_.rules[id].components;
  std::vector<RuleId> others;
  for (const RuleId other : knowledge_.states.active()) {
    if (others.size() > Coincidences::kMostTogether) break;  // no pair of so many counts
    const auto& began = knowledge_.states[other].onset;
    // A repair of the other one may have caused this one.
    if (!began || other == id || onset.latest > knowledge_.states[other].failing_since) continue;
    // One that recurs, or that an earlier process detected, began then.
    const Time latest = std::min(began->latest, knowledge_.states[other].first_detected());
    const bool is_together = began->earliest <= later(onset.latest, kTogether) &&
                             onset.earliest <= later(latest, kTogether);
    const auto& theirs = knowledge_.rules[other].components;
    if (is_together && !can_resolve(knowledge_, own, other) && !can_resolve(knowledge_, theirs, id))
      others.push_back(other);
  }
  write_.coincidences.began(id, others);
}

// It ends without a verdict. A strategy that avoided the unreachable computer, and did not help, is
// not retried meanwhile.
void Analyzer::excuse(RuleId id, ComponentId unheard, Time now) {
  Attempt& attempt = *write_.states.state(id).attempt;
  const auto& adapted = knowledge_.rules[attempt.strategy].components;
  if (std::ranges::none_of(adapted, [&](ComponentId c) { return knowledge_.is_unheard(c); }))
    write_.states.set_tried(attempt.strategy, true);
  attempt.stage = Attempt::Stage::kUndoing;
  write_.events.tell(now, StrategyAbandoned{attempt.strategy, knowledge_.rules[unheard].name + " " +
                                                                  knowledge_.why_unheard(unheard)});
}

// It was no attempt.
void Analyzer::excuse(RuleId id, std::string why, Time now) {
  Attempt& attempt = *write_.states.state(id).attempt;
  attempt.stage = Attempt::Stage::kUndoing;
  write_.events.tell(now, StrategyAbandoned{attempt.strategy, std::move(why)});
}

void Analyzer::forgive_unheard(Time now) {
  outcomes_.host_fell_silent();
  const auto forgive = [&](RuleId id) {
    RuleState& state = write_.states.state(id);
    Search& search = state.search;
    // Attempts of an earlier process began before the computer became unreachable.
    if (state.left_off || !knowledge_.unheard_behind(id)) return;
    search.attempts = search.attempts_before;
    search.round = 0;
    search.retry_at = now;
    forget_tried(knowledge_.rules[id], knowledge_.rules, search);
    if (state.phase != RulePhase::kExhausted) return;
    search.is_exhausted = false;
    write_.states.enter(id, RulePhase::kFailing);
  };
  std::vector<RuleId> all = knowledge_.states.active();
  const auto& exhausted = knowledge_.states.exhausted();
  all.insert(all.end(), exhausted.begin(), exhausted.end());
  for (const RuleId id : all) forgive(id);
}

void Analyzer::fail(RuleId id, Time now) {
  RuleState& state = write_.states.state(id);
  Attempt& attempt = *state.attempt;
  if (!attempt.has_no_failure) {
    if (const auto unheard = verdicts_.unheard_behind(attempt)) return excuse(id, *unheard, now);
    if (auto why = verdicts_.why_no_attempt(attempt)) return excuse(id, std::move(*why), now);
    write_.states.set_tried(attempt.strategy, true);
    ++state.search.attempts;
    if (!verdicts_.went_away_before(attempt)) outcomes_.judged(attempt, false, now);
    state.tried_alone.reset();
    if (attempt.effective != kNever) state.unhelped_at = now;
    if (!attempt.is_ambiguous && attempt.effective != kNever) {
      state.tried_alone = {attempt.strategy, attempt.effective};
      write_.latencies.stays(id, now - attempt.effective);
    }
  }
  const auto group =
      is_false(state.detection.trigger) ? verdicts_.missing_group(id, now) : std::nullopt;
  const std::string reason = !attempt.obstacle.empty() ? attempt.obstacle
                             : group ? "group " + knowledge_.rules[*group].name + " is not active"
                             : state.detection.trigger.known
                                 ? "the failure is still there"
                                 : "it is unknown whether the failure is still there";
  // A strategy that may have helped is not undone.
  const bool is_unknown = attempt.obstacle.empty() && !state.detection.trigger.known;
  attempt.stage = is_unknown ? Attempt::Stage::kOver : Attempt::Stage::kUndoing;
  write_.events.tell(now, StrategyFailed{attempt.strategy, reason});
  if (is_unknown) judge(id, now);
}

void Analyzer::resolve(RuleId id, FailureResolved how, Time now) {
  RuleState& state = write_.states.state(id);
  how.reaction = now - state.failing_since;
  state.quiet_until = later(now, knowledge_.rules[id].policies.cooldown);
  if (how.strategy) state.repaired = now;
  leave(id, now);
  if (!how.strategy && state.search.attempts == state.search.attempts_before)
    couplings_.cleared(id, now);
  write_.events.tell(now, std::move(how));
}

void Analyzer::leave(RuleId id, Time now) {
  couplings_.exposed_others(id, now);
  write_.states.state(id).gone_since = now;
  write_.states.state(id).standing.clear();
  write_.states.enter(id, RulePhase::kQuiet);
  unmask_effects_of(id, now);
}

// A failure downstream that outlasts this cause has another cause, which may have begun until now.
void Analyzer::unmask_effects_of(RuleId gone, Time now) {
  if (knowledge_.states.active().empty()) return;
  const Time began = diagnose::onset_of(gone, knowledge_).earliest;
  for (const ComponentId c : knowledge_.graph.downstream(knowledge_.rules[gone].components)) {
    for (const RuleId effect : knowledge_.states.touching(c)) {
      const bool may_be = effect != gone && knowledge_.states.is_active(effect) &&
                          began <= diagnose::onset_of(effect, knowledge_).latest;
      if (may_be) write_.states.state(effect).masked_until = now;
    }
  }
}

// The same for a failure that is detected only now: until when a failure upstream was there that may have
// caused it, and has cleared. kLongAgo: none was.
Time Analyzer::masked_until(RuleId effect) const {
  const Time began = diagnose::onset_of(effect, knowledge_).latest;
  Time until = kLongAgo;
  for (const ComponentId c : knowledge_.graph.upstream(knowledge_.rules[effect].components)) {
    for (const RuleId cause : knowledge_.states.touching(c)) {
      const RuleState& past = knowledge_.states[cause];
      const bool may_be = cause != effect && past.phase == RulePhase::kQuiet &&
                          past.gone_since > began &&
                          diagnose::onset_of(cause, knowledge_).earliest <= began;
      if (may_be) until = std::max(until, past.gone_since);
    }
  }
  return until;
}

void Analyzer::round_is_spent(RuleId id, Time now) {
  RuleState& state = write_.states.state(id);
  ++state.search.round;
  forget_tried(knowledge_.rules[id], knowledge_.rules, state.search);
  state.search.retry_at = later(now, pause_after(state.search.round));
  exhaust_if_spent(id, now);
  if (state.phase == RulePhase::kFailing)
    write_.events.tell(now, RoundSpent{id, state.search.retry_at});
  schedule(id, now);
}

void Analyzer::exhaust_if_spent(RuleId id, Time now) {
  const Search& search = knowledge_.states[id].search;
  const int limit = knowledge_.rules[id].policies.attempts;
  const bool is_spent = search.is_exhausted || search.attempts >= limit || search.round >= limit;
  if (is_spent) give_up(id, now);
}

void Analyzer::give_up(RuleId id, Time now) {
  last_resorts_.turn_to(id, now);
  if (knowledge_.states[id].search.is_exhausted) {
    stay_exhausted(id, now);
  } else {
    exhaust(id, now);
  }
}

void Analyzer::exhaust(RuleId id, Time now) {
  write_.states.state(id).search.is_exhausted = true;
  write_.events.tell(now, RuleExhausted{id});
  stay_exhausted(id, now);
}

// Strategies that go on nevertheless (Knowledge::goes_on) do so after a while.
void Analyzer::stay_exhausted(RuleId id, Time now) {
  Search& search = write_.states.state(id).search;
  const int beyond = search.attempts - knowledge_.rules[id].policies.attempts;
  const Duration pause = kFirstPauseOfStarts * (1 << std::clamp(beyond, 0, 10));
  search.retry_at = later(now, std::min<Duration>(pause, kLongestPauseOfStarts));
  forget_tried(knowledge_.rules[id], knowledge_.rules, search);
  write_.states.enter(id, RulePhase::kExhausted);
}

// When the rule must be looked at next if nothing that it reads changes.
void Analyzer::schedule(RuleId id, Time now) {
  const RuleState& state = knowledge_.states[id];
  Time next = detector_.next(id, now);
  const auto want = [&](Time at) {
    if (at > now) next = std::min(next, at);
  };
  if (!state.detection.trigger.known && state.phase != RulePhase::kQuiet) want(lost_at(id));
  if (state.phase == RulePhase::kFailing) want(state.search.retry_at);
  want(last_resorts_.next_time(id));
  // A process that begins anew has lost what a last resort has changed, and may do what was refused.
  const bool awaits_process = !state.standing.empty() || !state.search.refused.empty();
  if (awaits_process && state.phase != RulePhase::kQuiet) want(later(now, knowledge_.rules.cycle));
  if (state.attempt) want(verdicts_.next(*state.attempt, now));
  deadlines_.set(id.index, next);
}

}  // namespace culprit
