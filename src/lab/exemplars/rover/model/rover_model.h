// The rover in virtual time: a Robot on which any managing system runs, with the faults of faults.h.
//
// It models what a manager observes and commands, not pixels and paths:
// - processes that take time to start, exit, are stopped, and hang; their lifecycles, parameters and topics
// - Nav2's lifecycle managers (bond_manager.h) and the navigation with its mission (trip.h)
// - where the rover believes to be: amcl is lost after a kidnapping, by a base that counts anew, and by scans that do not fit.
//
// Physics and topics advance in ticks of 50 ms, as the fastest devices send; processes and requests have exact times. The same
// seed gives the same run.
//
// Durations come from the live rover (docs/rover.md) and its sources; each constant of rover_model.cpp says which.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "exemplars/rover/bond_manager.h"
#include "exemplars/rover/faults.h"
#include "exemplars/rover/model/trip.h"
#include "language/rule_set.h"
#include "robot/robot.h"
#include "simulation/agenda.h"
#include "simulation/body.h"
#include "simulation/random.h"

namespace culprit::rover::model {

class RoverModel : public Robot {
 public:
  struct Options {
    std::uint64_t seed = 1;
    bool has_bonds = true;  // bond_timeout of the lifecycle managers is not 0
    bool withdraws = true;  // a component that runs twice (live/live_robot.h)
  };

  // `rules` are those of rules/rover.rules, and must outlive it. All is up, and the rover drives.
  RoverModel(const RuleSet& rules, Options options);

  Time now() const override { return now_; }
  void observe(Time until, std::vector<Observation>& observations) override;
  void execute(const Command& command) override;

  void at(Time due, simulation::Action action) { agenda_.add(due, std::move(action)); }
  void inject(const Fault& fault);
  // Whether the fault itself is over, whatever became of its effects: as Experiment::is_over.
  bool is_over(const Fault& fault) const;

  Measurements measure() const;

  // Called before a manager ends or deactivates a component that works and has no fault.
  std::function<void(ComponentId)> on_healthy_taken_down;

 private:
  static constexpr Duration kTick = std::chrono::milliseconds(50);
  static constexpr double kLostAt = Measurements::kLostAt;  // the scan does not fit the map

  struct Part : simulation::Body {
    std::string name{};                               // of its node, without the slash
    std::map<std::string, Value> at_start{};          // parameters of a new process
    std::string fault{};                              // that it shows
    std::string next{};                               // Way::kNextStart: a parameter
    Value next_value{};                               // of it
    Time busy_until = kLongAgo;                       // its device
    std::vector<std::string> healed_by_activation{};  // faults
    bool is_server = false;
    Duration phase{};  // of its timers
    Time appeared{};
    int known_pid = 0;       // of the process whose node the others know, or knew last
    Time killed = kLongAgo;  // without a good-bye
    double memory_mib = 30;

    bool is_running() const { return process == ProcessState::kRunning; }
    bool is_gone() const { return process == ProcessState::kGone; }
  };

  // ---- processes
  void make_parts();
  void make_managers(bool has_bonds);
  Part& part(std::string_view component) { return parts_[ids_.find(component)->second.index]; }
  const Part& part(std::string_view component) const {
    return parts_[ids_.find(component)->second.index];
  }
  bool works(const Part& part) const;
  bool works(std::string_view component) const { return works(part(component)); }
  void start_process(ComponentId id);
  void start(ComponentId id);
  void appear(ComponentId id);
  void tell_endpoints(ComponentId id, bool is_there);
  void lose(ComponentId id, const std::string& remark, Cause cause, bool says_goodbye);
  bool change(ComponentId id, Transition transition);
  void probe(ComponentId id, int pid);
  BondManager::Reach reach(const Part& part) const;
  bool is_healthy(ComponentId id) const;

  // ---- commands
  void stop(const Command& command);
  void serve(const Command& command);
  void call(const Command& command, const CallService& call);
  void set_parameter(ComponentId id, const std::string& name, const Value& value);
  void reply(CommandId command, Outcome outcome, decltype(Reply::value) value = {});

  // ---- ticks
  void tick();
  void drive();
  void sense();
  void localize();
  void show_costmaps();
  void diagnose();
  void beat();
  bool is_due(const Part& part, Duration period) const;
  bool is_new(Time stamp, Duration limit) const { return later(stamp, limit) >= now_; }
  using Fields = std::vector<std::pair<const char*, Value>>;
  void publish(std::string_view component, const char* topic, const Fields& fields = {});
  void disturb();
  void tell_signals(const std::string& source, const Value& value);

  template <class What>
  void tell(What what) {
    inbox_.push_back({now_, std::move(what)});
  }
  void after(Duration delay, simulation::Action action) {
    at(later(now_, delay), std::move(action));
  }

  const RuleSet& rules_;
  const bool withdraws_;
  simulation::Random random_;
  simulation::Agenda agenda_{};
  Time now_{};
  std::vector<Observation> inbox_{};
  std::set<CommandId> open_{};
  std::set<std::string> strays_{};  // names of processes
  int last_pid_ = 100;
  std::vector<Part> parts_{};  // by component
  std::map<std::string, ComponentId, std::less<>> ids_{};
  std::map<std::string, std::vector<SignalId>, std::less<>> signals_{};  // by source
  std::map<ComponentId, std::unique_ptr<BondManager>> managers_{};
  Trip trip_;

  // The world.
  double speed_ = 0;
  double wheels_ = 0;  // its speed as the wheels measure it
  double turn_ = 0;
  double place_ = 0;  // where it is on its way
  double charge_ = 1;
  bool is_plugged_ = true;     // the lidar
  Time flaps_since_ = kNever;  // its plug is loose
  double clouds_ = 0;          // since the last status of cloud_maker
  double stood_s_ = 0;
  Time moved_{};

  // When each last did what others wait for.
  Time scanned_{};    // /scan, in the frame that is expected
  Time odometry_{};   // odom -> base_link, by its stamp
  Time corrected_{};  // map -> odom
  Time smoothed_{};   // /cmd_vel_nav reached the smoother
  Time released_{};   // /e_stop allowed to drive
  Trip::Command wanted_{};

  // What amcl believes.
  double pose_error_ = 0.05;  // metres
  double match_ = 0.95;
  bool looks_everywhere_ = false;
  bool has_map_ = true;
  bool has_costs_ = true;  // the planner has a map
  Time misfit_ = kNever;   // since when scans do not fit
  double frozen_range_ = 0.8;
};

}  // namespace culprit::rover::model
