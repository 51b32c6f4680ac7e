#include "torture/invariants.h"

#include <algorithm>
#include <cmath>

namespace culprit::torture {
namespace {

// Requests and verdicts follow each other at one point of time; so many of them never do.
constexpr int kMostStepsAtOnce = 200;

bool changes_something(const Command& command) {
  return !std::holds_alternative<ReadLifecycle>(command.what) &&
         !std::holds_alternative<ReadParameter>(command.what) &&
         !std::holds_alternative<ReadMode>(command.what);
}

}  // namespace

Invariants::Invariants(const RuleSet& rules, const Scenario& scenario)
    : rules_(rules),
      is_bayes_(!scenario.uses_paper_planner),
      overall_{scenario.governor.limits.overall, {}},
      kinds_{Budget{scenario.governor.limits.per_kind, {}},
             Budget{scenario.governor.limits.per_kind, {}},
             Budget{scenario.governor.limits.per_kind, {}}},
      components_(rules.components.size(), Budget{scenario.governor.limits.per_component, {}}) {}

void Invariants::begin(const Manager& manager) {
  // A manager that begins anew counts anew.
  overall_.spent.clear();
  for (Budget& budget : kinds_) budget.spent.clear();
  for (Budget& budget : components_) budget.spent.clear();
  silenced_.clear();
  is_paused_ = false;
  beliefs_.clear();
  for (std::size_t s = 0; s < rules_.strategies.size(); ++s)
    beliefs_.push_back(manager.knowledge().beliefs[StrategyId(s)]);
}

void Invariants::fail(Time at, std::string what) {
  if (!violation_) violation_ = Violation{at, std::move(what)};
}

void Invariants::check(const Manager& manager, Time now, std::span<const Command> commands,
                       const Truth& truth) {
  begun_now_.clear();
  for (const Event& event : manager.events()) {
    if (const auto* chosen = std::get_if<StrategyChosen>(&event.what)) {
      if (!chosen->dry_run) on(manager, *chosen, truth, event.at);
    } else if (const auto* accepted = std::get_if<OrderAccepted>(&event.what)) {
      const auto& what = accepted->order.what;
      if (std::holds_alternative<Pause>(what)) is_paused_ = true;
      if (std::holds_alternative<Resume>(what)) is_paused_ = false;
      if (const auto* run = std::get_if<RunStrategy>(&what)) ordered_.insert(run->strategy);
      if (const auto* silence = std::get_if<Silence>(&what)) silenced_.insert(silence->what);
      if (const auto* lift = std::get_if<LiftSilence>(&what)) silenced_.erase(lift->what);
    } else if (const auto* ended = std::get_if<SilenceEnded>(&event.what)) {
      silenced_.erase(ended->what);
    }
  }
  check_commands(commands, truth, now);
  check_beliefs(manager, now);
  steps_at_last_ = now == last_ ? steps_at_last_ + 1 : 0;
  last_ = now;
  if (steps_at_last_ > kMostStepsAtOnce) fail(now, "the manager steps without end");
}

void Invariants::on(const Manager& manager, const StrategyChosen& chosen, const Truth& truth,
                    Time at) {
  const Strategy& strategy = rules_[chosen.strategy];
  const std::string name = rules_[strategy.rule].name + "." + strategy.name;
  spend(overall_, "overall", at);
  spend(kinds_[static_cast<std::size_t>(kind_of(strategy))], "of its kind", at);
  for (const ComponentId component : strategy.components) {
    const std::string& where = rules_[component].name;
    spend(components_[component.index], "of " + where, at);
    if (silenced_.contains(component)) fail(at, name + " is begun at the silenced " + where);
    int busy = 0;
    for (const RuleId id : manager.knowledge().states.active()) {
      const auto& attempt = manager.knowledge().states[id].attempt;
      if (!attempt || attempt->stage == Attempt::Stage::kSuspended) continue;
      const auto& adapted = rules_[attempt->strategy].components;
      if (std::binary_search(adapted.begin(), adapted.end(), component)) ++busy;
    }
    if (busy > 1) fail(at, where + " is adapted by several strategies at once");
  }
  if (is_downstream_of_an_attempt(manager.knowledge(), strategy, at))
    fail(at, name + " is begun downstream of what is being adapted");
  begun_now_.insert(chosen.strategy);
  if (silenced_.contains(strategy.rule)) fail(at, name + " is begun though its rule is silenced");
  if (is_paused_) fail(at, name + " is begun while paused");
  if (truth.is_moving) fail(at, name + " is begun though the robot moves");
}

bool Invariants::is_downstream_of_an_attempt(const Knowledge& knowledge, const Strategy& strategy,
                                             Time at) const {
  for (const RuleId id : knowledge.states.active()) {
    const auto& attempt = knowledge.states[id].attempt;
    if (!attempt || id == strategy.rule || ordered_.contains(attempt->strategy)) continue;
    const bool is_later = attempt->chosen == at && !begun_now_.contains(attempt->strategy);
    const bool is_lesser =
        rules_[id].policies.criticality < rules_[strategy.rule].policies.criticality;
    if (is_later) continue;
    // With bayes, what only waits for its verdict gives way to what is worse, by itself or by what
    // it explains.
    if (is_bayes_ ? attempt->effective != kNever : is_lesser) continue;
    const auto& adapted = rules_[attempt->strategy].components;
    for (const ComponentId component : strategy.components) {
      // The dead are replaced side by side.
      if (is_bayes_ && knowledge.components[component].process != ProcessState::kRunning) continue;
      for (const ComponentId upstream : knowledge.graph.upstream(component)) {
        if (std::binary_search(adapted.begin(), adapted.end(), upstream)) return true;
      }
    }
  }
  return false;
}

void Invariants::spend(Budget& budget, const std::string& what, Time at) {
  if (budget.limit.most == 0) return;
  budget.spent.push_back(at);
  const auto recent = std::count_if(budget.spent.begin(), budget.spent.end(),
                                    [&](Time t) { return at - t < budget.limit.period; });
  if (recent > budget.limit.most) fail(at, "the budget " + what + " is exceeded");
}

void Invariants::check_commands(std::span<const Command> commands, const Truth& truth, Time now) {
  for (const Command& command : commands) {
    const std::string& name = rules_[command.component].name;
    if (is_paused_ && changes_something(command))
      fail(now, name + ": " + to_string(command) + " is asked while paused");
    const bool is_there = truth.processes[command.component.index] != ProcessState::kGone;
    if (std::holds_alternative<StartProcess>(command.what) && is_there)
      fail(now, name + " is started while its old process is there");
  }
}

void Invariants::check_beliefs(const Manager& manager, Time now) {
  for (std::size_t s = 0; s < beliefs_.size(); ++s) {
    const StrategyId id(s);
    const Belief belief = manager.knowledge().beliefs[id];
    if (belief == beliefs_[s]) continue;
    const double helped = belief.alpha - beliefs_[s].alpha;
    const double failed = belief.beta - beliefs_[s].beta;
    beliefs_[s] = belief;
    int successes = 0;
    int failures = 0;
    for (const Event& event : manager.events()) {
      const auto* counted = std::get_if<OutcomeCounted>(&event.what);
      if (counted == nullptr || counted->strategy != id) continue;
      successes += counted->as == OutcomeCounted::As::kSuccess ? 1 : 0;
      failures += counted->as == OutcomeCounted::As::kFailure ? 1 : 0;
    }
    const auto is_earned_by = [](double change, int outcomes) {
      constexpr double kRounding = 1e-9;
      return std::abs(change) < kRounding || std::abs(change - outcomes) < kRounding;
    };
    const bool is_earned = is_earned_by(helped, successes) && is_earned_by(failed, failures);
    if (!is_earned) fail(now, "the belief in " + rules_[id].name + " is no sum of outcomes");
  }
}

}  // namespace culprit::torture
