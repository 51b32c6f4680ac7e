// The robot of a scenario, simulated, behind noise.
//
// Its parts publish periodically while they work: the process runs, the node is active, nothing of
// it is broken, and what it needs is fresh. The noise lies between it and the manager: what comes
// may be lost, late or twice, and requests may be answered wrongly or not at all.
#pragma once

#include <array>
#include <deque>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "knowledge/history.h"
#include "language/rule_set.h"
#include "simulation/simulated_robot.h"
#include "simulation/topic.h"
#include "simulation/world.h"
#include "torture/torture_scenario.h"

namespace culprit::torture {

class Machine;

class TorturedRobot : public Robot {
 public:
  // `rules` must outlive the robot.
  TorturedRobot(const Scenario& scenario, const RuleSet& rules);
  ~TorturedRobot() override;

  Time now() const override { return world_.now() + ahead_; }
  void observe(Time until, std::vector<Observation>& observations) override;
  void execute(const Command& command) override;

  // Applies a mishap to the robot, not to the manager. Mishaps of people have no effect here.
  void befall(const Mishap& mishap);
  // A manager that begins anew receives the current state as by discovery, and which processes
  // known in the `past` have exited (process/supervisor.h, adopt_again()).
  void rediscover(const History& past);
  // culprit ends this process, which it had started in the place of one of a launch that has ended.
  void end_stand_in(std::size_t part, int pid);
  // From now on nothing is lost, late or wrong.
  void end_noise() { noise_ = {}; }

  bool works(std::size_t part) const;
  ProcessState process(std::size_t part) const;
  // Its fault is its own: it would not work even if it heard all that it needs.
  bool is_faulty(std::size_t part) const;
  // Its process began in the last `time`, and the manager had nothing to do with that.
  bool was_launched_within(std::size_t part, Duration time) const {
    const auto at = launched_.find(part);
    return at != launched_.end() && world_.now() - at->second <= time;
  }
  // It left that long ago because its launch is being ended, which is not over.
  bool has_left_for(std::size_t part, Duration time) const;
  bool has_moved_for(Duration time) const {
    return moving_since_ != kNever && world_.now() - moving_since_ >= time;
  }

 private:
  struct Late {
    Time due;  // in the world's time
    Observation observation;
  };
  enum class Source : std::uint8_t { kTopics, kGraph, kSystem };

  static Source source_of(const Observation& observation);
  void receive(Observation observation);
  bool is_of_a_stranger(const Observation& observation);
  bool is_of_the_mute(const Observation& observation) const;
  void reply(const Command& command, Outcome outcome);
  void tell_base();
  bool is_deaf() const { return world_.now() < deaf_until_; }
  void go_deaf(Duration time);
  void launch(std::size_t part);
  void relaunch(std::size_t part, Time until);
  void tell_namesakes(std::size_t part, int others);
  void end_launch(Duration pause);

  const RuleSet& rules_;
  Noise noise_;
  simulation::World world_;
  simulation::Random random_;
  std::unique_ptr<simulation::Topic<int>> infrastructure_;  // null: there is none
  std::vector<std::unique_ptr<simulation::Topic<int>>> topics_;
  std::vector<std::unique_ptr<Machine>> machines_;
  // One for each manager so far, the last for the present one. Actions that are due in the world
  // still refer to the earlier ones.
  std::vector<std::unique_ptr<simulation::SimulatedRobot>> robots_;
  std::array<std::deque<Late>, 3> on_the_way_;  // by source
  std::vector<CommandId> unanswered_;           // replies that get lost
  std::vector<CommandId> denied_;               // replies that become refusals
  Duration ahead_{};                            // the manager's clock, of the world's
  Time stale_until_ = kLongAgo;
  Time moving_since_ = kNever;
  Time deaf_until_ = kLongAgo;
  std::set<std::string> announced_;       // nodes, to the present manager
  std::map<std::size_t, int> namesakes_;  // by part
  std::map<std::size_t, Time> launched_;  // by part: when others started it last
  // By part: the process that started it, 0 for culprit's; and since when it is gone because its
  // launch is being ended, until that is over.
  static constexpr int kFirstLauncher = 7000;
  std::vector<int> launcher_of_;
  // By part: the process that culprit started last, and the launch that it stands in for; 0: none.
  struct StandIn {
    int pid = 0;
    int launcher = 0;
    bool is_ending = false;
  };
  std::vector<StandIn> started_here_;
  std::vector<Time> left_;
};

}  // namespace culprit::torture
