// A scenario as a robot that culprit's manager runs on, in virtual time.
//
// Leaner than src/adapters/simulation, which plays each message of each topic. For ten thousand
// components, a manager of this benchmark only needs the edges of the graph, the detectors'
// readings, and the effects of adaptations. Requests, lifecycles, processes and their observations
// are as there.
#pragma once

#include <atomic>
#include <functional>
#include <set>

#include "rca_study/plant.h"
#include "robot/robot.h"
#include "simulation/body.h"

namespace culprit::study::rca {

class RcaRobot : public Robot {
 public:
  // A robot that is well for this long is left.
  static constexpr Duration kQuiet = std::chrono::seconds(5);

  // `scenario` must outlive it; `rules` are those of the scenario.
  RcaRobot(const RcaScenario& scenario, const RuleSet& rules, Duration quiet = kQuiet);

  Time now() const override { return plant_.now(); }
  void observe(Time until, std::vector<Observation>& observations) override;
  void execute(const Command& command) override;

  const Plant& plant() const { return plant_; }
  Plant& plant() { return plant_; }
  // Called when what was done to a component took effect, and whether that ended its fault.
  std::function<void(std::size_t component, Repair repair, bool has_helped)> on_effect;
  // Set when all was well for a while, or the time of the scenario is over.
  const std::atomic<bool>& is_over() const { return is_over_; }

 private:
  void appear(std::size_t component);
  void read_detectors();
  bool is_false_alarm(std::size_t component);
  void on_fault(std::size_t component);
  void lose(std::size_t component, const std::string& remark);
  void serve(const Command& command);
  void change(const Command& command, Transition transition);
  void take_effect(std::size_t component, Repair repair);
  void start(const Command& command);
  Duration duration(std::size_t component, Repair repair) const;
  void reply(CommandId command, Outcome outcome, decltype(Reply::value) value = {});

  template <class What>
  void tell(What what) {
    inbox_.push_back({now(), std::move(what)});
  }

  const RcaScenario& scenario_;
  Duration quiet_;
  Plant plant_;
  simulation::Random noise_;
  simulation::Random luck_;
  std::vector<simulation::Body> bodies_;
  std::vector<std::optional<ParameterId>> parameters_;  // "tuning", by component
  std::vector<std::optional<SignalId>> signals_;        // what its detector says; by component
  struct FalseAlarm {
    simulation::Random luck;
    double begins_s = 0;
    double ends_s = 0;
  };
  std::vector<FalseAlarm> false_alarms_;  // the next or present one, by component
  std::set<CommandId> open_;
  std::vector<Observation> inbox_;
  int last_pid_ = 100;
  std::optional<Time> well_since_;
  std::atomic<bool> is_over_ = false;
};

}  // namespace culprit::study::rca
