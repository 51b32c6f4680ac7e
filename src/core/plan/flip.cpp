#include "plan/flip.h"

#include <algorithm>
#include <cmath>

#include "base/invariant.h"
#include "plan/ties.h"

namespace culprit::plan {
namespace {

// More failures in the way than this are no explanation that anybody reads.
constexpr std::size_t kMostHindrances = 8;

constexpr int kCertain = 1000;  // probabilities are sought in thousandths

// Between `loses` and `wins`, in either order: the value nearest to `loses` that still wins.
template <class Wins>
std::int64_t nearest_win(std::int64_t loses, std::int64_t wins, Wins does_win) {
  while (std::abs(wins - loses) > 1) {
    const std::int64_t middle = loses + (wins - loses) / 2;
    (does_win(middle) ? wins : loses) = middle;
  }
  return wins;
}

// The failure that has `component` under repair.
std::optional<RuleId> repaired_for(ComponentId component, const Knowledge& knowledge) {
  const Attempt* attempt = knowledge.states.reservation(component);
  if (attempt == nullptr) return std::nullopt;
  return knowledge.rules[attempt->strategy].rule;
}

}  // namespace

FlipFinder::FlipFinder(const Planner& planner, std::vector<RuleId> failures,
                       const Knowledge& knowledge)
    : planner_(planner),
      failures_(std::move(failures)),
      what_if_(knowledge),
      decisions_(planner.plan(failures_, what_if_.knowledge())) {}

std::vector<Change> FlipFinder::flips(StrategyId loser) {
  CULPRIT_ASSERT(std::any_of(decisions_.begin(), decisions_.end(), [&](const Decision& decision) {
    const auto& all = decision.candidates;
    return decision.chosen != loser && std::any_of(all.begin(), all.end(), [&](const Candidate& c) {
             return c.strategy == loser;
           });
  }));
  const Outcome now = outcome(decisions_, loser);
  std::vector<Change> flips;
  const auto add = [&](std::optional<Change> flip) {
    if (flip) flips.push_back(std::move(*flip));
  };
  add(success_of(loser, kCertain, loser));
  add(impact(loser));
  if (now.rival) add(success_of(*now.rival, 0, loser));
  std::stable_sort(flips.begin(), flips.end(), [&](const Change& a, const Change& b) {
    return parts(size(a)) < parts(size(b));
  });
  add(resolved(now, loser));
  for (Change& change : circumstances(now, loser)) {
    if (wins_with(change, loser)) add(std::move(change));
  }
  return flips;
}

FlipFinder::Outcome FlipFinder::outcome(const std::vector<Decision>& decisions,
                                        StrategyId loser) const {
  const Knowledge& knowledge = what_if_.knowledge();
  Outcome outcome;
  const auto own = std::find_if(decisions.begin(), decisions.end(), [&](const Decision& v) {
    return v.rule == knowledge.rules[loser].rule;
  });
  if (own == decisions.end()) return outcome;
  const auto candidate = std::find_if(own->candidates.begin(), own->candidates.end(),
                                      [&](const Candidate& c) { return c.strategy == loser; });
  if (candidate == own->candidates.end()) return outcome;
  outcome.is_chosen = own->chosen == loser;
  outcome.rival = own->chosen;
  outcome.excluded = candidate->excluded;
  outcome.component = candidate->component;
  if (candidate->excluded == Condition::kDependency) outcome.hindrance = candidate->failure;
  if (candidate->excluded == Condition::kAdapting)
    outcome.hindrance = repaired_for(candidate->component, knowledge);
  if (candidate->excluded == Condition::kAffected) {
    for (const Decision& other : decisions) {
      if (!other.chosen) continue;
      const auto& adapted = knowledge.rules[*other.chosen].components;
      if (!std::binary_search(adapted.begin(), adapted.end(), candidate->component)) continue;
      outcome.rival = other.chosen;
      outcome.hindrance = other.rule;
    }
  }
  return outcome;
}

FlipFinder::Outcome FlipFinder::outcome_with(const Change& change, StrategyId loser) {
  what_if_.assume(change);
  std::vector<RuleId> failures;
  std::copy_if(failures_.begin(), failures_.end(), std::back_inserter(failures), [&](RuleId id) {
    return what_if_.knowledge().states[id].phase == RulePhase::kFailing;
  });
  Outcome result = outcome(planner_.plan(failures, what_if_.knowledge()), loser);
  what_if_.undo();
  return result;
}

// The success probability of `changed` nearest to what it is, toward `end`, with which the loser is
// chosen.
std::optional<Change> FlipFinder::success_of(StrategyId changed, int end, StrategyId loser) {
  const double now = kCertain * what_if_.knowledge().beliefs[changed].mean().value;
  const auto change = [&](std::int64_t thousandths) {
    return SuccessChange{changed, {static_cast<double>(thousandths) / kCertain}};
  };
  const auto wins = [&](std::int64_t thousandths) { return wins_with(change(thousandths), loser); };
  if (!wins(end)) return std::nullopt;
  const auto loses = static_cast<std::int64_t>(end > now ? std::floor(now) : std::ceil(now));
  return change(nearest_win(loses, end, wins));
}

std::optional<Change> FlipFinder::impact(StrategyId loser) {
  const auto change = [&](std::int64_t cycles) { return ImpactChange{loser, {cycles}}; };
  const auto wins = [&](std::int64_t cycles) { return wins_with(change(cycles), loser); };
  const std::int64_t now = what_if_.knowledge().rules[loser].impact.count;
  if (now <= 1 || !wins(1)) return std::nullopt;
  return change(nearest_win(now, 1, wins));
}

// As many failures as it takes, found one behind the other, and none that it does not take.
std::optional<Change> FlipFinder::resolved(const Outcome& now, StrategyId loser) {
  ResolvedChange change;
  for (Outcome next = now; !next.is_chosen; next = outcome_with(change, loser)) {
    if (!next.hindrance || change.rules.size() == kMostHindrances) return std::nullopt;
    change.rules.push_back(*next.hindrance);
  }
  for (std::size_t i = 0; change.rules.size() > 1 && i < change.rules.size();) {
    ResolvedChange without = change;
    without.rules.erase(without.rules.begin() + static_cast<std::ptrdiff_t>(i));
    if (wins_with(without, loser)) {
      change = std::move(without);
    } else {
      ++i;
    }
  }
  return change;
}

// Changes that could make a difference; whether they do is to be tried.
std::vector<Change> FlipFinder::circumstances(const Outcome& now, StrategyId loser) const {
  if (now.excluded == Condition::kTried) return {TriedChange{loser, false}};
  if (now.excluded == Condition::kInvalid) {
    using enum ComponentChange::Situation;
    std::vector<Change> changes = {WhenChange{loser}};
    for (const auto situation : {kAlive, kActive, kInactive, kAbsent, kLaunchable})
      changes.push_back(ComponentChange{now.component, situation});
    return changes;
  }
  if (now.rival) return {TriedChange{*now.rival, true}};
  return {};
}

double FlipFinder::size(const Change& change) const {
  const Knowledge& knowledge = what_if_.knowledge();
  if (const auto* success = std::get_if<SuccessChange>(&change))
    return std::abs(success->success.value - knowledge.beliefs[success->strategy].mean().value);
  const auto& impact = std::get<ImpactChange>(change);
  return static_cast<double>(knowledge.rules[impact.strategy].impact.count - impact.impact.count) /
         static_cast<double>(knowledge.rules.heaviest.count);
}

}  // namespace culprit::plan
