#include "rule_test/expectation.h"

#include <algorithm>
#include <cstdio>

#include "knowledge/describe.h"

namespace culprit::rule_test {
namespace {

using Kind = Expectation::Kind;

std::string at_time(Time t) {
  char text[32];
  std::snprintf(text, sizeof text, "at %.3f s", seconds(t.time_since_epoch()));
  return text;
}

const std::vector<Candidate>* candidates_of(const Event& event) {
  if (const auto* chosen = std::get_if<StrategyChosen>(&event.what)) return &chosen->candidates;
  if (const auto* held = std::get_if<FailureHeldBack>(&event.what)) return &held->candidates;
  return nullptr;
}

const Candidate* candidate_of(const Event& event, StrategyId strategy) {
  const auto* candidates = candidates_of(event);
  if (candidates == nullptr) return nullptr;
  const auto found = std::find_if(candidates->begin(), candidates->end(),
                                  [&](const Candidate& c) { return c.strategy == strategy; });
  return found == candidates->end() ? nullptr : &*found;
}

bool contains(const auto& items, const auto& item) {
  return std::find(items.begin(), items.end(), item) != items.end();
}

class Matcher {
 public:
  Matcher(const Expectation& expectation, const RuleSet& rules) : e_(expectation), rules_(rules) {}

  bool operator()(const Event& event) const {
    return std::visit([&](const auto& what) { return is(what); }, event.what) || weighs(event);
  }

 private:
  bool is(const FailureDetected& what) const {
    return e_.kind == Kind::kDetected && what.rule == e_.rule;
  }
  bool is(const FailureResolved& what) const {
    return e_.kind == Kind::kResolved && what.rule == e_.rule &&
           (!e_.strategy || what.strategy == e_.strategy);
  }
  bool is(const RuleExhausted& what) const {
    return e_.kind == Kind::kExhausted && what.rule == e_.rule;
  }
  bool is(const RuleBlind& what) const { return e_.kind == Kind::kBlind && what.rule == e_.rule; }
  bool is(const FailureLost& what) const { return e_.kind == Kind::kLost && what.rule == e_.rule; }
  bool is(const StrategyFailed& what) const {
    return e_.kind == Kind::kFailed && what.strategy == e_.strategy;
  }
  // Adaptations are carried out one after the other, so the last one completes the strategy.
  bool is(const AdaptationDone& what) const {
    return e_.kind == Kind::kExecuted && what.strategy == e_.strategy &&
           what.adaptation + 1 == rules_[what.strategy].adaptations.size();
  }
  bool is(const StrategyChosen& what) const {
    const Strategy& strategy = rules_[what.strategy];
    const bool touches = !e_.component || contains(strategy.components, *e_.component);
    switch (e_.kind) {
      case Kind::kChosen:
        return what.strategy == e_.strategy;
      case Kind::kBlamed:
        return touches &&
               (!e_.rule || strategy.rule == *e_.rule || contains(what.explains, *e_.rule));
      case Kind::kAnyChosen:
        return touches && (!e_.rule || strategy.rule == *e_.rule);
      default:
        return false;
    }
  }
  // It was preferred to all others, and may not be begun.
  bool is(const ActionHeldBack& what) const {
    return e_.kind == Kind::kExcluded && what.strategy == e_.strategy &&
           e_.condition.value_or(Condition::kWithheld) == Condition::kWithheld &&
           (!e_.component || contains(rules_[what.strategy].components, *e_.component));
  }
  bool is(const auto&) const { return false; }

  bool weighs(const Event& event) const {
    if (e_.kind != Kind::kExcluded) return false;
    const Candidate* candidate = candidate_of(event, *e_.strategy);
    return candidate != nullptr && candidate->excluded &&
           (!e_.condition || candidate->excluded == e_.condition) &&
           (!e_.component || candidate->component == *e_.component);
  }

  const Expectation& e_;
  const RuleSet& rules_;
};

// The place by cost when the strategy was weighed first; 0 if it never was.
std::size_t rank_of(StrategyId strategy, std::span<const Event> events, Time& at) {
  for (const Event& event : events) {
    const Candidate* candidate = candidate_of(event, strategy);
    if (candidate == nullptr) continue;
    at = event.at;
    return static_cast<std::size_t>(candidate - candidates_of(event)->data()) + 1;
  }
  return 0;
}

std::optional<std::string> rank_disappointment(const Expectation& e,
                                               std::span<const Event> events) {
  Time at{};
  const std::size_t rank = rank_of(*e.strategy, events, at);
  if ((rank == e.rank) == e.wanted) return std::nullopt;
  if (rank == 0) return "it was never weighed";
  return at_time(at) + " its cost was number " + std::to_string(rank);
}

std::string what_is_said_of(const Event& event, StrategyId strategy, const RuleSet& rules) {
  const auto* held = std::get_if<ActionHeldBack>(&event.what);
  if (held != nullptr && held->strategy == strategy) return describe(event, rules);
  const Candidate* candidate = candidate_of(event, strategy);
  return candidate == nullptr ? "" : describe_exclusion(*candidate, rules);
}

// The plans' reasons about the strategy, each once.
std::string what_was_said_of(StrategyId strategy, std::span<const Event> events,
                             const RuleSet& rules) {
  std::vector<std::string> reasons;
  for (const Event& event : events) {
    std::string reason = what_is_said_of(event, strategy, rules);
    if (!reason.empty() && !contains(reasons, reason)) reasons.push_back(std::move(reason));
  }
  std::string all;
  for (const std::string& reason : reasons) all += (all.empty() ? "" : "; ") + reason;
  return all.empty() ? "it was never weighed" : "what was said of it: " + all;
}

}  // namespace

std::optional<std::string> disappointment(const Expectation& e, std::span<const Event> events,
                                          const RuleSet& rules) {
  if (e.kind == Kind::kRanked) return rank_disappointment(e, events);
  const Matcher matches(e, rules);
  const Time earliest{e.after};
  const Time latest = e.by ? Time{*e.by} : kNever;
  const Event* outside = nullptr;
  for (const Event& event : events) {
    if (!matches(event)) continue;
    if (event.at < earliest || event.at > latest) {
      if (outside == nullptr) outside = &event;
      continue;
    }
    if (e.wanted) return std::nullopt;
    return "it happened " + at_time(event.at);
  }
  if (!e.wanted) return std::nullopt;
  if (outside != nullptr)
    return std::string(outside->at < earliest ? "it happened too early, " : "it happened later, ") +
           at_time(outside->at);
  if (e.kind == Kind::kExcluded) return what_was_said_of(*e.strategy, events, rules);
  return "it did not happen";
}

}  // namespace culprit::rule_test
