#include "web/metrics.h"

#include <algorithm>

#include <fmt/core.h>

#include "knowledge/describe.h"
#include "web/component_health.h"
#include "web/process_metrics.h"

namespace culprit::web {
namespace {

// A label's value: names of rules have no such characters, names of robots may.
std::string escaped(std::string_view value) {
  std::string out;
  for (const char c : value) {
    if (c == '\\' || c == '"') out += '\\';
    out += c == '\n' ? std::string("\\n") : std::string(1, c);
  }
  return out;
}

std::string label(std::string_view name, std::string_view value) {
  return fmt::format("{}=\"{}\"", name, escaped(value));
}

std::string of_rule(RuleId id, const RuleSet& rules) {
  return label("rule", rules[id].name) + "," +
         label("criticality", culprit::to_string(rules[id].policies.criticality));
}

std::string of_strategy(StrategyId id, const RuleSet& rules, std::string_view outcome) {
  const Strategy& strategy = rules[id];
  return label("rule", rules[strategy.rule].name) + "," + label("strategy", strategy.name) + "," +
         label("outcome", outcome);
}

// The reason that held an action back (knowledge/event.h).
std::string_view word_of(Restraint restraint) {
  constexpr std::string_view kWords[] = {
      "paused",   "quiet_period", "storm",     "graph_in_doubt", "interlock", "overall",
      "silenced", "refused",      "component", "class",          "backoff",   "identity",
      "evidence", "never_seen",   "leaving",   "launch_ended",   "container", "restarts"};
  static_assert(std::size(kWords) == static_cast<std::size_t>(Restraint::kRestarts) + 1);
  return kWords[static_cast<std::size_t>(restraint)];
}

constexpr std::string_view kPlanResults[] = {"chosen", "advised", "approval_asked", "waiting"};

}  // namespace

void Metrics::watch(const Manager& manager) {
  const RuleSet& rules = manager.knowledge().rules;
  const MutexLock lock(mutex_);
  for (std::size_t r = 0; r < rules.rules.size(); ++r) {
    for (Series* series : {&counts_.detected, &counts_.resolved, &counts_.exhausted})
      series->try_emplace(of_rule(RuleId(r), rules), 0);
  }
  for (std::size_t s = 0; s < rules.strategies.size(); ++s) {
    for (const char* outcome : {"resolved", "failed", "abandoned"})
      counts_.strategies.try_emplace(of_strategy(StrategyId(s), rules, outcome), 0);
  }
  for (const std::string_view result : kPlanResults)
    counts_.plans.try_emplace(label("result", result), 0);
  for (std::size_t i = 0; i <= static_cast<std::size_t>(Restraint::kRestarts); ++i)
    counts_.holds.try_emplace(label("restraint", word_of(static_cast<Restraint>(i))), 0);
  for (const char* result : {"accepted", "refused"})
    counts_.orders.try_emplace(label("result", result), 0);
  counts_.info = label("robot", rules.robot);
  look(manager, counts_);
  is_discovered_ = false;
}

void Metrics::count_dropped(std::function<std::uint64_t()> dropped) {
  const MutexLock lock(dropped_mutex_);
  if (dropped_) dropped_before_ += dropped_();
  dropped_ = std::move(dropped);
}

void Metrics::stepped(Duration took, std::size_t observations, const Manager& manager) {
  constexpr auto kRelaxed = std::memory_order_relaxed;
  const auto bound = std::lower_bound(kStepBounds.begin(), kStepBounds.end(), seconds(took));
  step_times_[static_cast<std::size_t>(bound - kStepBounds.begin())].fetch_add(1, kRelaxed);
  step_nanoseconds_.fetch_add(static_cast<std::uint64_t>(took.count()), kRelaxed);
  observations_.fetch_add(observations, kRelaxed);
  hears_ = manager.hears();
  is_discovered_ = manager.knowledge().now >= manager.discovered();
  if (!manager.events().empty()) {
    const MutexLock lock(mutex_);
    for (const Event& event : manager.events()) count(event, manager.knowledge().rules, counts_);
    look(manager, counts_);
  }
  ++steps_;  // last: whoever waits for a step sees all of it
}

void Metrics::count(const Event& event, const RuleSet& rules, Counts& counts) {
  const auto& what = event.what;
  const auto plan = [&](std::string_view result) { ++counts.plans[label("result", result)]; };
  const auto strategy = [&](StrategyId id, std::string_view outcome) {
    ++counts.strategies[of_strategy(id, rules, outcome)];
  };
  if (const auto* detected = std::get_if<FailureDetected>(&what)) {
    ++counts.detected[of_rule(detected->rule, rules)];
  } else if (const auto* resolved = std::get_if<FailureResolved>(&what)) {
    ++counts.resolved[of_rule(resolved->rule, rules)];
    const bool by_strategy = resolved->how == FailureResolved::How::kByStrategy;
    if (by_strategy && resolved->strategy) strategy(*resolved->strategy, "resolved");
  } else if (const auto* exhausted = std::get_if<RuleExhausted>(&what)) {
    ++counts.exhausted[of_rule(exhausted->rule, rules)];
  } else if (const auto* chosen = std::get_if<StrategyChosen>(&what)) {
    plan(chosen->dry_run ? "advised" : "chosen");
  } else if (std::holds_alternative<ApprovalAsked>(what)) {
    plan("approval_asked");
  } else if (std::holds_alternative<FailureHeldBack>(what)) {
    plan("waiting");
  } else if (const auto* failed = std::get_if<StrategyFailed>(&what)) {
    strategy(failed->strategy, "failed");
  } else if (const auto* abandoned = std::get_if<StrategyAbandoned>(&what)) {
    strategy(abandoned->strategy, "abandoned");
  } else if (const auto* held = std::get_if<ActionHeldBack>(&what)) {
    ++counts.holds[label("restraint", word_of(held->restraint))];
  } else if (std::holds_alternative<OrderAccepted>(what)) {
    ++counts.orders[label("result", "accepted")];
  } else if (std::holds_alternative<OrderRefused>(what)) {
    ++counts.orders[label("result", "refused")];
  }
}

// The present state. It changes with events only.
void Metrics::look(const Manager& manager, Counts& counts) {
  const Knowledge& knowledge = manager.knowledge();
  counts.open.clear();
  for (const Criticality c :
       {Criticality::kNonCritical, Criticality::kWarning, Criticality::kError})
    counts.open[label("criticality", culprit::to_string(c))] = 0;
  for (std::size_t r = 0; r < knowledge.rules.rules.size(); ++r) {
    if (!knowledge.states.has_failure(RuleId(r))) continue;
    const Criticality c = knowledge.rules.rules[r].policies.criticality;
    ++counts.open[label("criticality", culprit::to_string(c))];
  }
  counts.blind.clear();
  for (std::size_t r = 0; r < knowledge.rules.rules.size(); ++r)
    counts.blind[of_rule(RuleId(r), knowledge.rules)] = knowledge.blindness[RuleId(r)] ? 1 : 0;
  counts.components.clear();
  for (const std::string_view word : kHealthWords) counts.components[label("health", word)] = 0;
  for (const std::size_t health : health_of_components(knowledge))
    ++counts.components[label("health", kHealthWords[health])];
  counts.approvals_pending = manager.governor().asked().size();
  counts.silences = manager.governor().silences().size();
  counts.is_paused = manager.governor().is_paused();
  counts.is_dry_run = manager.autonomy() == Autonomy::kAdvise;
  counts.is_storm = manager.governor().storm().has_value();
}

std::string Metrics::step_times() const {
  std::string out;
  std::uint64_t below = 0;
  for (std::size_t i = 0; i < kStepBounds.size(); ++i) {
    below += step_times_[i];
    out += fmt::format("culprit_step_seconds_bucket{{le=\"{}\"}} {}\n", kStepBounds[i], below);
  }
  below += step_times_.back();
  out += fmt::format("culprit_step_seconds_bucket{{le=\"+Inf\"}} {}\n", below);
  return out + fmt::format("culprit_step_seconds_sum {}\nculprit_step_seconds_count {}\n",
                           static_cast<double>(step_nanoseconds_) / 1e9, below);
}

std::string Metrics::text() const {
  Counts counts;
  {
    const MutexLock lock(mutex_);
    counts = counts_;
  }
  std::string out;
  const auto begin = [&](const char* name, const char* type, const char* help) {
    out += fmt::format("# HELP {0} {2}\n# TYPE {0} {1}\n", name, type, help);
  };
  const auto all = [&](const char* name, const char* type, const char* help, const Series& series) {
    begin(name, type, help);
    for (const auto& [labels, value] : series)
      out += fmt::format("{}{{{}}} {}\n", name, labels, value);
  };
  const auto one = [&](const char* name, const char* type, const char* help, std::uint64_t value) {
    begin(name, type, help);
    out += fmt::format("{} {}\n", name, value);
  };
  all("culprit_failures_detected_total", "counter", "Failures that were detected.",
      counts.detected);
  all("culprit_failures_resolved_total", "counter", "Failures that cleared.", counts.resolved);
  all("culprit_failures_exhausted_total", "counter",
      "Failures about which nothing was left to try.", counts.exhausted);
  all("culprit_plans_total", "counter", "Decisions about a failure.", counts.plans);
  all("culprit_strategies_total", "counter", "Strategies that ended, by outcome.",
      counts.strategies);
  all("culprit_governor_holds_total", "counter",
      "Strategies that were chosen and held back by the governor.", counts.holds);
  all("culprit_orders_total", "counter", "Orders of people.", counts.orders);
  all("culprit_failures_open", "gauge", "Failures that are there now.", counts.open);
  all("culprit_rule_blind", "gauge", "1 while the rule's trigger has no value.", counts.blind);
  all("culprit_components", "gauge", "Components of the rules by health.", counts.components);
  one("culprit_hears", "gauge", "1 while culprit receives the robot's messages.", hears_ ? 1 : 0);
  {
    const MutexLock dropping(dropped_mutex_);
    one("culprit_foreign_datagrams_total", "counter",
        "Datagrams that were dropped: they came from elsewhere than the participant that they "
        "speak for.",
        dropped_before_ + (dropped_ ? dropped_() : 0));
  }
  one("culprit_approvals_pending", "gauge", "Strategies that wait for a person's word.",
      counts.approvals_pending);
  one("culprit_silences", "gauge", "Components and rules that are muted now.", counts.silences);
  one("culprit_paused", "gauge", "1 while a person has paused it.", counts.is_paused ? 1 : 0);
  one("culprit_dry_run", "gauge", "1 while it only says what it would do.",
      counts.is_dry_run ? 1 : 0);
  one("culprit_storm", "gauge", "1 while a storm of failures stops all actions.",
      counts.is_storm ? 1 : 0);
  one("culprit_observations_total", "counter", "Observations of the robot.", observations_);

  begin("culprit_step_seconds", "histogram", "How long the manager's steps took.");
  out += step_times();
  begin("culprit_robot_info", "gauge", "Always 1; the robot's name.");
  out += fmt::format("culprit_robot_info{{{}}} 1\n", counts.info);
  return out + process_metrics();
}

}  // namespace culprit::web
