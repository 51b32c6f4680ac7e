// Invariants of every step of every run, under every mishap.
//
// - No budget is ever exceeded: no interval holds more strategies than allowed, in total, of a
//   kind, at a component. Counted here anew, from the events.
// - No component is restarted more often than its bound allows, whichever rules ask for it, unless its
//   process is known to be gone.
// - No process is started while the component's old one is there.
// - While paused nothing is asked that changes anything; at a muted component nothing is begun;
//   while the robot is known to move nothing is begun.
// - A component is adapted by one strategy at a time. No planner begins one downstream of an
//   adaptation for a failure at least as critical; bayes not even for a lesser one, unless that is
//   only pending verification. An order of a person is exempt.
// - A last resort is begun WITHIN its time of the detection, whatever holds the other strategies, where
//   its component can do it: only a person's pause or silence holds it. It spends no budget.
// - With bayes, the repair of a component that the operating system knows to be dead begins within
//   one decision of its detection where the governor allows, whatever the levels.
// - With bayes, no process is replaced for a silence that a dead or exhausted component which it
//   needs, and that does not seem to need it in turn, explains. One with a fault of its own may be if
//   that component worked in between.
// - No failure is treated more often than its ATTEMPTS allow, until it was proven gone; starts of components known to be gone do not count.
// - A component that was never there is not started.
// - No healthy process is replaced, as long as samples and clocks are not tampered with.
// - No strategy begins while culprit is deaf.
// - No strategy begins at a component while another node has its name, or after it has left because
//   its launch is being ended.
// - A rule whose trigger has had no value for a minute is blind: it never counts as well.
// All of this holds across crashes of the manager: budgets, pauses and silences go on.
// - A belief changes by one outcome at a time, and only with the verdict that says so.
// - The manager never wants to be stepped without end.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "manager/manager.h"
#include "torture/torture_scenario.h"

namespace culprit::torture {

struct Violation {
  Time at{};
  std::string what;
};

class Invariants {
 public:
  // The real state of the robot; the manager only knows its observations.
  struct Truth {
    std::vector<ProcessState> processes;  // by component
    std::vector<bool> is_faulty;          // by component: it fails by itself, whatever it hears
    // By component: its launcher has just started it, and the manager may not know.
    std::vector<bool> is_launched;
    std::vector<bool> was_there;   // by component: its process ran once
    std::vector<Time> well_since;  // by component; kNever: it does not work
    // By component: it has left because its launch is being ended, and the manager must know.
    std::vector<bool> is_leaving;
    bool is_moving = false;  // for long enough that the manager must know
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
  void check_replacement(const Manager& manager, const Strategy& strategy, const Truth& truth,
                         Time at);
  void note_the_dead(const Manager& manager, Time now);
  void count_attempts(const Event& event);
  void check_last_resorts(const Manager& manager, Time now);
  void check_the_dead(const Manager& manager, Time now);
  void check_sight(const Manager& manager, Time now);
  bool fell_silent_before(const Manager& manager, std::size_t part, Time at) const;
  bool is_given_up(const Manager& manager, ComponentId component, Time failed,
                   bool is_effect_faulty) const;
  bool is_excused(const Manager& manager, StrategyId strategy) const;
  void spend(Budget& budget, const std::string& what, Time at);
  void check_beliefs(const Manager& manager, Time now);
  void check_commands(std::span<const Command> commands, const Truth& truth, Time now);
  void fail(Time at, std::string what);
  bool is_silenced(Silenceable what, Time at) const;

  const RuleSet& rules_;
  bool is_bayes_;
  bool is_seen_true_;                            // what is observed is so
  std::vector<std::vector<std::size_t>> needs_;  // by component: all that it needs
  std::vector<Time>
      left_dead_since_;            // by rule: its component is dead, and nothing is done; kNever
  std::vector<Time> last_resort_;  // by rule: when its last resort was begun, or took effect
  std::vector<Time> last_resort_missing_;  // by rule: since when it should have been begun; kNever
  std::vector<Time> dead_since_;     // by component: that it is known to be dead; kNever: it is not
  std::vector<Time> unknown_since_;  // by rule: its trigger has no value; kNever: it has one
  // By rule: strategies that were executed since it was proven gone, and when it went away last.
  struct Search {
    int attempts = 0;
    std::optional<Time> gone;
  };
  std::vector<Search> searches_;
  Duration healthy_;  // a failure that stays away for so long is proven gone
  Budget overall_;
  std::array<Budget, 3> kinds_;
  std::vector<Budget> components_;
  std::vector<Budget> restarts_;  // by component
  std::vector<Belief> beliefs_;
  std::map<Silenceable, Time> silenced_;   // until then
  std::set<StrategyId> ordered_;           // by a person
  std::set<StrategyId> begun_now_;         // in this step so far
  std::set<StrategyId> started_the_gone_;  // whose latest attempt began so
  bool is_paused_ = false;
  Time last_{};
  int steps_at_last_ = 0;
  std::optional<Violation> violation_;
};

}  // namespace culprit::torture
