// Base of the managers that SUAVE is compared with: their names for its functions and signals, and
// their way to change modes.
#pragma once

#include <memory>
#include <string_view>

#include "exemplars/suave/model/mission.h"
#include "managers/scripted_manager.h"

namespace culprit::study {

// Components "search", "follow", "motion" and "recharge" are the systems, "search_node" and so on
// their nodes. Signals: "visibility", "battery", "thruster_1" to "thruster_6", "guided", "task",
// "detected", "recharged".
const RuleSet& suave_names();

class SuaveManager : public ScriptedManager {
 public:
  struct Setting {
    const suave::model::Generation& generation;
    bool has_battery = false;  // it is to see to the battery
    std::uint64_t seed = 0;
  };

 protected:
  static constexpr Duration kServiceTimeout = std::chrono::seconds(1);
  static constexpr double kLowBattery = 0.25;

  explicit SuaveManager(const Setting& setting)
      : ScriptedManager(suave_names(), setting.seed), has_battery_(setting.has_battery) {}

  bool has_battery() const { return has_battery_; }
  bool is_thruster_failed() const { return failed_thrusters_ > 0; }
  // The mission's task as it reports it; empty before the first report.
  std::string task() const;

  // Asks for a mode. `is_done` (null: not needed) is whether that was accepted.
  Routine change_mode(std::string system, std::string mode, bool* is_done = nullptr);

  void on_signal(const std::string& name, const Value& value) override;

 private:
  bool has_battery_;
  std::map<std::string, bool> thrusters_;  // whether failed
  std::ptrdiff_t failed_thrusters_ = 0;
};

// A baseline for SUAVE. Each comes with the sources of its delays.
struct SuaveBaseline {
  std::string_view name;
  std::string_view summary;
  suave::model::Leader leader;
  std::unique_ptr<ManagingSystem> (*make)(const SuaveManager::Setting& setting);
};

// "none", "random", "bt", "metacontrol", "rosa"; "rebet", "rebet-ucb", "rebet-greedy",
// "rebet-random" and "bandit" (rebet_manager.h).
std::span<const SuaveBaseline> suave_baselines();

}  // namespace culprit::study
