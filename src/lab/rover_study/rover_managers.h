// Managers of the rover beside culprit's own. Nav2's lifecycle managers and behaviour tree work under all of them, as part of the robot.
//
//   respawn   a launch file with respawn=True, respawn_delay=2.0: starts again what exits
//   watchdog  systemd: Restart=always (RestartSec=100ms), and WatchdogSec=3s by a node's heartbeat and by its periodic topics
//   oracle    knows the causes, and begins the best remedy of each at the moment of the fault
#pragma once

#include <map>
#include <optional>
#include <span>
#include <vector>

#include "exemplars/rover/faults.h"
#include "managers/scripted_manager.h"

namespace culprit::study {

class ProcessKeeper : public ManagingSystem {
 public:
  struct Settings {
    Duration restart_after{};
    std::optional<Duration> watchdog{};  // nothing: a silent process is left alone
  };
  static Settings respawn();
  static Settings watchdog();

  // `rules` names components and topics, and must outlive it.
  ProcessKeeper(const RuleSet& rules, Settings settings);

  std::vector<Command> step(Time now, std::span<const Observation> observations) override;
  Time next_deadline() const override;
  std::span<const Event> events() const override { return {}; }

 private:
  struct Kept {
    std::optional<Time> start{};  // when it is started again
    bool is_gone = false;
    Time beat = kNever;                // kNever: it answers
    std::map<TopicId, Time> topics{};  // that it publishes, with their last sample
  };

  void observe(const Observation& observation);
  std::optional<Time> watchdog_of(const Kept& kept) const;

  const RuleSet& rules_;
  const Settings settings_;
  std::vector<Kept> kept_;         // by component
  std::vector<bool> is_periodic_;  // by topic
  std::uint64_t last_command_ = 0;
};

class RoverOracle : public ScriptedManager {
 public:
  // The faults come at `at`.
  RoverOracle(const RuleSet& rules, std::vector<const rover::Fault*> faults, Time at);

 private:
  Routine mend(const rover::Fault& fault, Time at);
  Routine redeploy(std::string component);
  Routine stand(std::string component);

  const RuleSet& rules_;
};

}  // namespace culprit::study
