#include "diagnose/awaited.h"

#include <algorithm>

#include "diagnose/touched.h"
#include "diagnose/unclear.h"

namespace culprit::diagnose {
namespace {

// An outage costs more than a bad value, so it waits for no long window, and for no monitor that is slower than this.
constexpr Duration kLongestReading = Latencies::kSlowMonitor;
// A coupling that was learned stands for a dependency from here on.
constexpr double kCoupled = 0.5;

std::size_t at(Symptom symptom) { return static_cast<std::size_t>(symptom); }

// Since when the rule does not show its failure; kLongAgo: it does, or never did. An exhausted failure
// that its trigger does not show any more is about to clear.
Time gone_since(RuleId rule, const Knowledge& knowledge) {
  const RuleState& state = knowledge.states[rule];
  if (state.phase == RulePhase::kQuiet) return state.gone_since;
  const bool is_clearing = state.phase == RulePhase::kExhausted && state.detection.trigger.known &&
                           !state.detection.trigger.b;
  return is_clearing ? state.detection.trigger_since : kLongAgo;
}

bool cleared_within(Duration time, RuleId rule, const Knowledge& knowledge) {
  const Time gone = gone_since(rule, knowledge);
  return gone != kLongAgo && knowledge.now < later(gone, time);
}

// So long what is over may be shown by one of the failures.
Duration longest_echo(std::span<const RuleId> failures, const Knowledge& knowledge) {
  Duration longest{};
  for (const RuleId rule : failures) longest = std::max(longest, remembers(rule, knowledge.rules));
  return kLongestEvidence + longest;
}

// When the last of what the cause did until then has reached the failure.
Time last_passed_on(RuleId failure, std::optional<RuleId> cause, Time over, Duration passing,
                    const Knowledge& knowledge) {
  // It may have been as bad until its rule cleared: a silence shows at once that it is over.
  const bool ends_late = cause && symptom_of(*cause, knowledge) == Symptom::kValue &&
                         symptom_of(failure, knowledge) == Symptom::kOutage;
  const Duration shown =
      ends_late ? knowledge.latencies.lateness(*cause).presumed : Duration::zero();
  return later(over, shown + passing);
}

}  // namespace

Time echo_ends(RuleId failure, std::optional<RuleId> cause, Time over, Duration passing,
               const Knowledge& knowledge) {
  const Time passed = last_passed_on(failure, cause, over, passing, knowledge);
  // A window looks back on the time before, unless what it watches has failed anew.
  const Duration window = is_bad_anew(failure, passed, knowledge)
                              ? Duration::zero()
                              : remembers(failure, knowledge.rules);
  return later(passed, std::min(clears_within(failure, knowledge), kLongestEvidence + window));
}

Time recovered(RuleId rule, Time gone, const Knowledge& knowledge) {
  return gone - knowledge.latencies.lateness(rule).presumed;
}

void Awaited::Two::add(const Best& other) {
  if (!other.rule) return;
  if (first.rule == other.rule) {
    first.within = std::max(first.within, other.within);
  } else if (!first.rule || other.within > first.within) {
    second = first;
    first = other;
  } else if (!second.rule || other.within > second.within) {
    second = other;
  }
}

void Awaited::Two::add(const Two& other) {
  add(other.first);
  add(other.second);
}

const Awaited::Best& Awaited::Two::without(RuleId rule) const {
  return first.rule == rule ? second : first;
}

Awaited::Awaited(const Knowledge& knowledge, std::span<const RuleId> failures)
    : knowledge_(knowledge) {
  const bool is_any_new = std::any_of(failures.begin(), failures.end(), [&](RuleId rule) {
    return knowledge.now <
           later(knowledge.states[rule].failing_since, kLongestEvidence + kLongestPlainEvidence);
  });
  find_past(longest_echo(failures, knowledge));
  const bool looks_any_back = std::ranges::any_of(
      failures, [&](RuleId failure) { return knowledge.now < looks_back_until(failure); });
  if (!is_any_new && past_.empty() && !looks_any_back) return;
  Time latest = kLongAgo;
  for (const RuleId failure : failures)
    latest = std::max(latest, onset_of(failure, knowledge).latest);
  collect(latest);
  place_past();
  carry();
  for (const RuleId failure : failures) look_at(failure);
}

void Awaited::collect(Time latest_onset) {
  places_.resize(knowledge_.graph.condensation().size());
  is_circle_.resize(places_.size(), false);
  std::vector<bool> is_taken(places_.size(), false);
  for (std::size_t c = 0; c < knowledge_.rules.components.size(); ++c) {
    const auto scc = knowledge_.graph.scc_of(ComponentId(c));
    if (!scc) continue;
    if (is_taken[*scc]) is_circle_[*scc] = true;
    is_taken[*scc] = true;
  }
  for (std::size_t r = 0; r < knowledge_.rules.rules.size(); ++r) {
    const RuleId rule(r);
    const Duration within = evidence_within(rule, latest_onset, knowledge_);
    if (within == Duration::zero()) continue;
    const bool is_gone = cleared_within(kLongestEvidence, rule, knowledge_);
    for (const ComponentId c : spreads_from(rule, knowledge_)) {
      const auto scc = knowledge_.graph.scc_of(c);
      if (!scc) continue;
      Place& place = places_[*scc];
      auto& own = (is_gone ? place.own_again : place.own)[at(symptom_of(rule, knowledge_))];
      own.add(Best{within, rule});
    }
  }
}

void Awaited::find_past(Duration within) {
  const auto is_recent = [&](Time over) { return knowledge_.now < later(over, within); };
  for (std::size_t r = 0; r < knowledge_.rules.rules.size(); ++r) {
    const RuleId rule(r);
    if (cleared_within(within, rule, knowledge_))
      past_.push_back({rule,
                       {},
                       onset_of(rule, knowledge_).earliest,
                       recovered(rule, gone_since(rule, knowledge_), knowledge_),
                       symptom_of(rule, knowledge_)});
  }
  for (std::size_t c = 0; c < knowledge_.rules.components.size(); ++c) {
    const auto& anew = knowledge_.components[ComponentId(c)].begun_anew;
    if (anew && is_recent(anew->done))
      past_.push_back({knowledge_.rules[anew->by].rule, ComponentId(c), anew->since, anew->done,
                       Symptom::kOutage});
    const auto& trouble = knowledge_.components[ComponentId(c)].past_trouble;
    if (trouble && is_recent(trouble->over))
      past_.push_back({{}, ComponentId(c), trouble->since, trouble->over, Symptom::kOutage});
  }
}

void Awaited::place_past() {
  own_past_ = BitRows(places_.size(), past_.size());
  upstream_past_ = BitRows(places_.size(), past_.size());
  const auto mark = [&](ComponentId c, std::size_t p) {
    if (const auto scc = knowledge_.graph.scc_of(c)) set(own_past_[*scc], p);
  };
  for (std::size_t p = 0; p < past_.size(); ++p) {
    if (past_[p].component) {
      mark(*past_[p].component, p);
    } else {
      for (const ComponentId c : spreads_from(*past_[p].rule, knowledge_)) mark(c, p);
    }
  }
}

void Awaited::carry() {
  const Condensation& graph = knowledge_.graph.condensation();
  for (Condensation::Scc scc = 0; scc < places_.size(); ++scc) {
    Place& place = places_[scc];
    for (const Condensation::Scc producer : graph.producers(scc)) {
      const Place& before = places_[producer];
      for (const std::size_t s : {at(Symptom::kOutage), at(Symptom::kValue)}) {
        place.upstream[s].add(before.upstream[s]);
        place.upstream[s].add(before.own[s]);
        place.upstream_again[s].add(before.upstream_again[s]);
        place.upstream_again[s].add(before.own_again[s]);
      }
      add(upstream_past_[scc], upstream_past_[producer]);
      add(upstream_past_[scc], own_past_[producer]);
    }
  }
}

void Awaited::look_at(RuleId failure) {
  const Awaiting found = awaiting(failure);
  if (knowledge_.now < found.until) found_.emplace_back(failure, found);
}

Duration Awaited::next_reading(const Best& evidence) const {
  return std::min<Duration>(evidence.within,
                            reading_of(*evidence.rule, knowledge_) + knowledge_.rules.cycle);
}

Time Awaited::shows_value(RuleId supplier, RuleId failure) const {
  const Duration lateness = knowledge_.latencies.is_late(supplier)
                                ? knowledge_.latencies.lateness(supplier).most
                                : Duration::zero();
  const Duration shown = reading_of(supplier, knowledge_) + lateness + knowledge_.rules.cycle;
  return later(first_onset_of(failure, knowledge_), std::min(shown, kLongestReading));
}

Awaiting Awaited::of_declared_supplier(RuleId failure, ComponentId consumer) const {
  Awaiting found;
  for (const Dependency& d : knowledge_.rules.dependencies) {
    const auto scc = knowledge_.graph.scc_of(d.producer);
    if (d.consumer != consumer || !scc) continue;
    const Best& evidence = places_[*scc].own[at(Symptom::kValue)].without(failure);
    if (!evidence.rule) continue;
    const Time until = shows_value(*evidence.rule, failure);
    if (until > found.until) found = {until, *evidence.rule, false};
  }
  return found;
}

Awaiting Awaited::of_learned_supplier(RuleId failure) const {
  Awaiting found;
  const std::vector<ComponentId> own = touched_by(failure, knowledge_);
  for (const auto& [cause, coupling] : knowledge_.couplings.of(failure)) {
    const bool is_learned = coupling.cleared > 0 && coupling.mean(Coupling::kRare) > kCoupled;
    if (!is_learned || symptom_of(cause, knowledge_) != Symptom::kValue ||
        evidence_within(cause, knowledge_.now, knowledge_) == Duration::zero() ||
        touched_by(cause, knowledge_) == own)  // what it shows is no supplier
      continue;
    const Time until = shows_value(cause, failure);
    if (until > found.until) found = {until, cause, false};
  }
  return found;
}

// A window that still holds what a strategy has repaired comes and goes at its limit. Only of topics and events is it known
// whether they have failed anew.
Time Awaited::looks_back_until(RuleId failure) const {
  const RuleState& state = knowledge_.states[failure];
  const auto& inputs = knowledge_.rules[failure].inputs;
  const bool has_window = remembers(failure, knowledge_.rules) > Duration::zero() &&
                          std::ranges::none_of(inputs, [&](InputId id) {
                            return is_over_window(knowledge_.rules[id]);
                          });
  if (state.repaired == kLongAgo || !has_window || state.repaired <= state.unhelped_at)
    return kLongAgo;
  return echo_ends(failure, {}, state.repaired, Duration::zero(), knowledge_);
}

Awaiting Awaited::awaiting(RuleId failure) const {
  const RuleState& state = knowledge_.states[failure];
  const Time onset = onset_of(failure, knowledge_).latest;
  const Time first_onset = first_onset_of(failure, knowledge_);
  const bool is_value = symptom_of(failure, knowledge_) == Symptom::kValue;
  const Duration lateness = presumed_lateness(failure, knowledge_);
  Awaiting found;
  const auto wait_for = [&](const Two& all, Time latest, Time detected) {
    const Best& evidence = all.without(failure);
    if (!evidence.rule) return;
    const Time until =
        std::clamp(later(latest - lateness, evidence.within), later(latest, next_reading(evidence)),
                   later(detected, std::max(kLongestEvidence, evidence.within)));
    if (until > found.until) found = {until, *evidence.rule, false};
  };
  const Duration passing = duration_of(kPassing, knowledge_.rules);
  const auto fade = [&](const Past& past, Duration passed_on) {
    const Time until = fades(failure, past, passed_on);
    if (until > found.until) found = {until, past.rule.value_or(failure), true, past.component};
  };
  for (const ComponentId c : downstream_of_causes(failure, knowledge_)) {
    const auto scc = knowledge_.graph.scc_of(c);
    if (!scc) continue;
    const Place& place = places_[*scc];
    for (const Symptom symptom : {Symptom::kOutage, Symptom::kValue}) {
      if (symptom == Symptom::kValue && !is_value) continue;  // bad data ends no data
      const std::size_t s = at(symptom);
      wait_for(place.upstream[s], first_onset, state.first_detected());
      wait_for(place.upstream_again[s], onset, state.failing_since);
      if (!is_circle_[*scc]) continue;
      wait_for(place.own[s], first_onset, state.first_detected());
      wait_for(place.own_again[s], onset, state.failing_since);
    }
    const Awaiting supplier = of_declared_supplier(failure, c);
    if (!is_value && supplier.until > found.until) found = supplier;
    for_each(upstream_past_[*scc], [&](std::size_t p) { fade(past_[p], passing); });
    for_each(own_past_[*scc], [&](std::size_t p) {
      const bool is_its_own = past_[p].component == c;
      const bool was_judged = is_its_own && past_[p].over <= state.unhelped_at;
      if (was_judged) return;  // the verdict has waited for its echo
      if (is_its_own || is_circle_[*scc]) fade(past_[p], is_its_own ? Duration{} : passing);
    });
  }
  const Awaiting learned = of_learned_supplier(failure);
  if (learned.until > found.until) found = learned;
  const Time looks_back = looks_back_until(failure);
  if (looks_back > found.until) found = {looks_back, failure, true, {}};
  return found;
}

Time Awaited::fades(RuleId failure, const Past& past, Duration passing) const {
  // One reading of a common monitor shows both values: it decides whether the failure settles
  // (Settling). A reconfiguration would not be in vain for long.
  const bool is_value = symptom_of(failure, knowledge_) == Symptom::kValue;
  const bool is_of_outage =
      !past.component && past.symptom == Symptom::kOutage && is_mended(failure, knowledge_.rules);
  const bool has_echo = !is_value || is_of_outage || knowledge_.latencies.is_late(failure) ||
                        remembers(failure, knowledge_.rules) > Duration::zero();
  const Onset onset = onset_of(failure, knowledge_);
  const std::optional<RuleId> cause = past.component ? std::nullopt : past.rule;
  const Time passed = last_passed_on(failure, cause, past.over, passing, knowledge_);
  const bool is_known = knowledge_.states[failure].onset.has_value();
  const Time latest =
      is_known ? std::max(onset.latest, unclear_until(failure, knowledge_)) : onset.latest;
  if (cause == failure || !has_echo || past.began > latest || onset.earliest > passed)
    return kLongAgo;
  return echo_ends(failure, cause, past.over, passing, knowledge_);
}

std::optional<Awaiting> Awaited::of(RuleId failure) const {
  const auto found = std::lower_bound(
      found_.begin(), found_.end(), failure,
      [](const std::pair<RuleId, Awaiting>& each, RuleId rule) { return each.first < rule; });
  if (found == found_.end() || found->first != failure) return std::nullopt;
  return found->second;
}

}  // namespace culprit::diagnose
