// The hidden truth of a scenario while it is played: the ill components, and since when.
//
// Illness travels: a component is ill one delay after the component that a subscription connects it
// to, and well again as long after its last cause is gone. If there are several paths, the quickest
// counts. The ill components at rest are the least set that follows from faults and adaptations. So
// a feedback loop never keeps itself ill, and a component that recovers before an illness arrives
// is never ill.
#pragma once

#include <functional>
#include <optional>

#include "rca_study/rca_scenario.h"
#include "simulation/agenda.h"
#include "simulation/random.h"

namespace culprit::study::rca {

class Plant {
 public:
  // `scenario` must outlive it. Its faults come at their times.
  explicit Plant(const RcaScenario& scenario);
  Plant(const Plant&) = delete;

  Time now() const { return now_; }
  void at(Time due, simulation::Action action) {
    agenda_.add(std::max(due, now_), std::move(action));
  }
  void after(Duration delay, simulation::Action action) {
    at(later(now_, delay), std::move(action));
  }
  // Does the next thing if it is due not after `until`, and gives whether there was one.
  bool step(Time until);

  bool is_ill(std::size_t component) const { return states_[component].is_ill; }
  // The reading of a detector without errors.
  bool looks_ill(std::size_t component) const { return states_[component].looks_ill; }
  std::optional<FaultKind> fault(std::size_t component) const { return states_[component].fault; }
  // Does a common cause hit it now?
  bool is_hit(std::size_t component) const { return states_[component].hits > 0; }
  bool is_well() const { return ill_ == 0 && faults_ == 0 && !has_faults_to_come(); }
  // Does illness pass from one to the other in this episode, directly or through others?
  bool passes(std::size_t from, std::size_t to) const;

  // It is taken down, or is back.
  void set_down(std::size_t component, bool is_down);
  // Its fault is gone, if there was one.
  void repair(std::size_t component);

  // Called after a fault came.
  std::function<void(std::size_t component)> on_fault;
  // Called before a component becomes ill or well.
  std::function<void(std::size_t component)> on_change;

 private:
  struct Way {
    std::size_t to = 0;
    Duration delay{};
    bool is_redundant = false;
  };
  struct State {
    std::vector<Way> ways;      // that illness takes from here in this episode
    std::size_t redundant = 0;  // inputs that have to be ill together
    std::optional<FaultKind> fault;
    bool shows = false;  // the fault, now
    int hits = 0;        // common causes at work
    bool is_down = false;
    bool is_ill = false;
    bool looks_ill = false;
    Duration lag{};              // from its cause to it
    std::optional<bool> coming;  // what it becomes next
    std::uint64_t change = 0;    // number of what is coming
  };

  bool has_faults_to_come() const { return to_come_ > 0; }
  void inject(const InjectedFault& fault);
  void flap(std::size_t component);
  // A common cause begins (1) or ends (-1).
  void hit(const CommonCause& cause, int change);
  void update();
  std::vector<std::optional<Duration>> onsets() const;
  void become(std::size_t component, bool is_ill, Duration delay);

  const RcaScenario& scenario_;
  simulation::Agenda agenda_;
  Time now_{};
  std::vector<State> states_;
  std::size_t ill_ = 0;
  std::size_t faults_ = 0;
  std::size_t to_come_ = 0;
};

}  // namespace culprit::study::rca
