#include "journal/history.h"

#include <algorithm>

#include "journal/event_json.h"

namespace culprit::journal {
namespace {

template <class... What>
bool is_any_of(const Event& event) {
  return (std::holds_alternative<What>(event.what) || ...);
}

template <class What>
const What* order_of(const Event& event) {
  const auto* accepted = std::get_if<OrderAccepted>(&event.what);
  return accepted == nullptr ? nullptr : std::get_if<What>(&accepted->order.what);
}

// For each component only the last event of this kind counts.
template <class What>
bool replaces_older(const Event& event, History& kept) {
  const auto* newer = std::get_if<What>(&event.what);
  if (newer == nullptr) return false;
  std::erase_if(kept, [&](const Event& old) {
    const auto* older = std::get_if<What>(&old.what);
    return older != nullptr && older->component == newer->component;
  });
  kept.push_back(event);
  return true;
}

// A component that stays down does so until it is discovered again, or a person orders otherwise. A node that was shut down
// may be discovered as it is: until it is in another state. True if the event is about that alone.
bool ends_stay(const Event& event, const RuleSet& rules, History& kept) {
  if (std::holds_alternative<StaysDown>(event.what)) {
    kept.push_back(event);
    return true;
  }
  const auto* found = std::get_if<ComponentFound>(&event.what);
  const auto* state = std::get_if<LifecycleIntended>(&event.what);
  const auto* run = order_of<RunStrategy>(event);
  const bool is_revival = order_of<Revive>(event) != nullptr;
  if (found == nullptr && state == nullptr && run == nullptr && !is_revival) return false;
  for (Event& old : kept) {
    auto* down = std::get_if<StaysDown>(&old.what);
    if (down == nullptr) continue;
    std::erase_if(down->components, [&](ComponentId component) {
      const bool is_run =
          run != nullptr && std::ranges::count(rules[run->strategy].components, component) > 0;
      const bool is_back = down->why == StaysDown::Why::kShutDown
                               ? state != nullptr && state->component == component &&
                                     state->state != Lifecycle::kFinalized
                               : found != nullptr && found->component == component;
      return is_revival || is_run || is_back;
    });
  }
  std::erase_if(kept, [](const Event& old) {
    const auto* down = std::get_if<StaysDown>(&old.what);
    return down != nullptr && down->components.empty();
  });
  return is_revival;
}

// The oldest outcome of the strategy that waits does so no longer.
void forget_pending(StrategyId strategy, History& kept) {
  const auto oldest = std::find_if(kept.begin(), kept.end(), [&](const Event& event) {
    const auto* pending = std::get_if<OutcomePending>(&event.what);
    return pending != nullptr && pending->strategy == strategy;
  });
  if (oldest != kept.end()) kept.erase(oldest);
}

bool is_over(const Silence& silence, Time began, Time now) {
  return silence.lasts && later(began, *silence.lasts) <= now;
}

// The rule that an event of a search is about; nothing for others.
std::optional<RuleId> searched(const Event& event, const RuleSet& rules) {
  if (const auto* e = std::get_if<FailureDetected>(&event.what)) return e->rule;
  if (const auto* e = std::get_if<RoundSpent>(&event.what)) return e->rule;
  if (const auto* e = std::get_if<LastResortReached>(&event.what)) return e->rule;
  if (const auto* e = std::get_if<LastResortDone>(&event.what)) return rules[e->strategy].rule;
  if (const auto* e = std::get_if<RuleExhausted>(&event.what)) return e->rule;
  if (const auto* e = std::get_if<StrategyFailed>(&event.what)) return rules[e->strategy].rule;
  return std::nullopt;
}

// Has its failure been cleared for so long that a new one would count as another?
bool is_long_gone(const Event& event, Time now) { return later(event.at, kPastCounts) <= now; }

// By rule: from which event on its failure is there, or may still come back; past.size() if not.
std::vector<std::size_t> open_since(const History& past, Time now, const RuleSet& rules) {
  std::vector<std::size_t> since(rules.rules.size(), past.size());
  for (std::size_t i = 0; i < past.size(); ++i) {
    if (const auto* e = std::get_if<FailureDetected>(&past[i].what))
      since[e->rule.index] = std::min(since[e->rule.index], i);
    if (!is_long_gone(past[i], now)) continue;
    if (const auto* e = std::get_if<FailureResolved>(&past[i].what))
      since[e->rule.index] = past.size();
    if (const auto* e = std::get_if<FailureLost>(&past[i].what)) since[e->rule.index] = past.size();
  }
  return since;
}

// The rule whose failure went away, or out of sight; nothing for other events.
std::optional<RuleId> went(const Event& event) {
  if (const auto* e = std::get_if<FailureResolved>(&event.what)) return e->rule;
  if (const auto* e = std::get_if<FailureLost>(&event.what)) return e->rule;
  return std::nullopt;
}

// An event that each process repeats about a failure that has not cleared. @pre its failure is
// there
bool is_said_again(const Event& event, const History& kept, const RuleSet& rules) {
  if (!is_any_of<FailureDetected, LastResortReached, RuleExhausted>(event)) return false;
  const auto rule = searched(event, rules);
  for (auto old = kept.rbegin(); old != kept.rend(); ++old) {
    if (went(*old) == rule) return false;  // it came back
    if (old->what.index() == event.what.index() && searched(*old, rules) == rule) return true;
  }
  return false;
}

}  // namespace

bool is_remembered(const Event& event) {
  if (const auto* chosen = std::get_if<StrategyChosen>(&event.what)) return !chosen->dry_run;
  return is_any_of<FailureDetected, FailureResolved, FailureLost, RoundSpent, LastResortReached,
                   LastResortDone, RuleExhausted, StrategyFailed, StrategyResumed, AdaptationDone,
                   OutcomePending, OutcomeCounted, ComponentFound, LifecycleIntended, CameUp,
                   StaysDown>(event) ||
         order_of<RunStrategy>(event) != nullptr || order_of<Silence>(event) != nullptr ||
         order_of<LiftSilence>(event) != nullptr || order_of<Revive>(event) != nullptr;
}

History still_counting(const History& past, Time now, const RuleSet& rules) {
  const std::vector<std::size_t> open = open_since(past, now, rules);
  History kept;
  for (std::size_t i = 0; i < past.size(); ++i) {
    const Event& event = past[i];
    const auto* silence = order_of<Silence>(event);
    const auto* lift = order_of<LiftSilence>(event);
    if (silence != nullptr || lift != nullptr) {
      const Silenceable& what = silence != nullptr ? silence->what : lift->what;
      std::erase_if(kept, [&](const Event& old) {
        const auto* other = order_of<Silence>(old);
        return other != nullptr && other->what == what;
      });
      if (silence != nullptr && !is_over(*silence, event.at, now)) kept.push_back(event);
      continue;
    }
    if (ends_stay(event, rules, kept)) continue;
    // culprit did not run when the verdict was due.
    const auto* pending = std::get_if<OutcomePending>(&event.what);
    if (pending != nullptr && pending->due <= now) continue;
    if (const auto* counted = std::get_if<OutcomeCounted>(&event.what)) {
      forget_pending(counted->strategy, kept);
      continue;
    }
    if (replaces_older<ComponentFound>(event, kept) ||
        replaces_older<LifecycleIntended>(event, kept) || replaces_older<CameUp>(event, kept))
      continue;
    const auto rule = searched(event, rules);
    if (rule && i > open[rule->index] && is_said_again(event, kept, rules)) continue;
    const bool is_open = rule && i >= open[rule->index];
    const bool is_only_of_search =
        is_any_of<StrategyFailed, RoundSpent, LastResortReached, LastResortDone, RuleExhausted>(
            event);
    const bool is_recent = later(event.at, kPastCounts) > now && !is_only_of_search;
    if (is_open || is_recent) kept.push_back(event);
  }
  return kept;
}

History of_people(const History& past, Duration shift) {
  History kept;
  for (const Event& event : past) {
    if (order_of<Silence>(event) == nullptr && order_of<LiftSilence>(event) == nullptr) continue;
    kept.push_back(event);
    kept.back().at += shift;
  }
  return kept;
}

Json to_json(const History& past, const RuleSet& rules) {
  Json json = Json::array();
  for (const Event& event : past) {
    json.push_back(to_json(event, rules));
    // For people there is the row that it came from.
    json.back().erase("text");
  }
  return json;
}

History history_from_json(const Json& json, const RuleSet& rules) {
  History past;
  if (!json.is_array()) return past;
  for (const Json& each : json) {
    auto event = event_from_json(each, rules);
    if (event && is_remembered(*event)) past.push_back(std::move(*event));
  }
  return past;
}

}  // namespace culprit::journal
