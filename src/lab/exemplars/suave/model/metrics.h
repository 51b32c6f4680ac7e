// The exemplar's metrics of a mission (mission_metrics), by name, and what it leaves out.
//
// - Visibility: a mismatch opens with a reading of the visibility for which the search does not
//   have the expected altitude. It closes when the search's altitude becomes the one expected by
//   then. It counts also while no search is under way. A low battery closes an open mismatch
//   without counting it, and no new one opens until the battery is charged; in the standard
//   mission, never.
// - Thruster: from the failure's diagnostic to the activation of the recovery.
// - Battery: from the first reading below a quarter to the activation of the recharging; each
//   activation counts.
#pragma once

#include <vector>

#include "exemplars/suave/model/mission.h"

namespace culprit::suave::model {

struct Reactions {
  std::vector<double> answered_s;
  // Ages of mismatches without an answer, when they were over, or when the mission was. Lower
  // bounds. A mismatch is over when the search is.
  std::vector<double> unanswered_s;

  bool operator==(const Reactions&) const = default;
};

class Metrics : private simulation::Watcher {
 public:
  // Both must outlive the metrics.
  Metrics(simulation::World& world, Topics& topics);
  ~Metrics() override;

  // Mismatches that are still open count as unanswered.
  void finish();

  std::optional<Time> found() const { return found_; }
  // The last reported value: since the following of the pipeline began the last time.
  double distance() const { return distance_; }
  // Of all stretches.
  double whole_distance() const { return earlier_distance_ + distance_; }

  const Reactions& visibility() const { return visibility_; }
  const Reactions& thruster() const { return thruster_; }
  const Reactions& battery() const { return battery_; }

 private:
  void on_field(const simulation::TopicBase& topic, const std::string& field,
                const Value& value) override;
  void on_diagnostic(std::string_view status, std::string_view key, const Value& value) override;
  void on_parameter(const simulation::Node& node, const std::string& name,
                    const Value& value) override;
  void on_lifecycle(const simulation::Node& node) override;

  void on_visibility(double metres);
  void on_battery(double level);
  void answer(std::optional<Time>& open, Reactions& reactions);
  void give_up(const std::optional<Time>& open, Reactions& reactions);
  void give_up_mismatch();

  simulation::World& world_;
  Topics& topics_;
  std::optional<Time> found_;
  double distance_ = 0;
  double earlier_distance_ = 0;
  double expected_altitude_ = 0;
  std::optional<Time> mismatch_;   // since
  bool is_mismatch_over_ = false;  // it was counted as unanswered
  std::optional<Time> failed_thruster_;
  std::optional<Time> low_battery_;
  bool is_battery_answered_ = false;
  Reactions visibility_;
  Reactions thruster_;
  Reactions battery_;
};

}  // namespace culprit::suave::model
