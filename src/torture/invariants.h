// What must hold in every step of every run, whatever breaks.
//
// - No budget is ever exceeded: no interval holds more strategies than allowed, in total, of a
// kind,
//   at a component. Counted here anew, from the events.
// - No process is started while the component's old one is there.
// - While paused nothing is asked that changes anything; at a silenced component nothing is begun;
//   while the robot is known to move nothing is begun.
// - A component is adapted by one strategy at a time, and no planner begins one downstream of what
// is
//   adapted for a failure at least as critical; bayes not even for a lesser one, unless that only
//   waits for its verdict. What a person ordered is the person's.
// - A belief changes by one outcome at a time, and only with the verdict that says so.
// - The manager never wants to be stepped without end.
#pragma once

#include <array>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "manager/manager.h"
#include "torture/scenario.h"

namespace culprit::torture {

struct Violation {
  Time at{};
  std::string what;
};

class Invariants {
 public:
  // What the robot really is like; the manager only knows what it is told.
  struct Truth {
    std::vector<ProcessState> processes;  // by component
    bool is_moving = false;               // for long enough that the manager must know
  };

  // `rules` must outlive the invariants.
  Invariants(const RuleSet& rules, const Scenario& scenario);

  // A manager begins, with nothing under way.
  void begin(const Manager& manager);
  // After each of its steps. The first violation stays.
  void check(const Manager& manager, Time now, std::span<const Command> commands,
             const Truth& truth);
  const std::optional<Violation>& violation() const { return violation_; }

 private:
  struct Budget {
    Intensity limit;
    std::vector<Time> spent;
  };

  void on(const Manager& manager, const StrategyChosen& chosen, const Truth& truth, Time at);
  bool is_downstream_of_an_attempt(const Knowledge& knowledge, const Strategy& strategy,
                                   Time at) const;
  void spend(Budget& budget, const std::string& what, Time at);
  void check_beliefs(const Manager& manager, Time now);
  void check_commands(std::span<const Command> commands, const Truth& truth, Time now);
  void fail(Time at, std::string what);

  const RuleSet& rules_;
  bool is_bayes_;
  Budget overall_;
  std::array<Budget, 3> kinds_;
  std::vector<Budget> components_;
  std::vector<Belief> beliefs_;
  std::set<Silenceable> silenced_;
  std::set<StrategyId> ordered_;    // by a person
  std::set<StrategyId> begun_now_;  // in this step so far
  bool is_paused_ = false;
  Time last_{};
  int steps_at_last_ = 0;
  std::optional<Violation> violation_;
};

}  // namespace culprit::torture
