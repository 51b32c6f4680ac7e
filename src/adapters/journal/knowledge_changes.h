// The changes of the manager's knowledge since they were written last: learned values, and the known robot.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "journal/known_robot.h"
#include "journal/learned.h"
#include "knowledge/knowledge.h"

namespace culprit::journal {

class KnowledgeChanges {
 public:
  // The known robot is written once it has changed, and at the latest after kRobotAtLatest: old rows are dropped.
  static constexpr Duration kRobotPeriod = std::chrono::seconds(1);
  static constexpr Duration kRobotAtLatest = std::chrono::hours(1);

  // All that `knowledge` holds now counts as written. It must outlive this.
  explicit KnowledgeChanges(const Knowledge& knowledge);

  // Since the last call.
  Learned learned();
  // Nothing: it was written already.
  std::optional<KnownRobot> robot(Time now);

 private:
  // Takes time by the partners of the rule: no step looks at all pairs of failures.
  void note_coincidences_of(RuleId rule, std::vector<LearnedCoincidence>& changed);

  const Knowledge& knowledge_;

  // As written last.
  std::vector<Belief> beliefs_;
  std::vector<std::vector<Couplings::Learned>> couplings_;
  std::vector<Latencies::Learned> latencies_;
  std::vector<Transients::Seen> transients_;
  Coincidences coincidences_;
  std::vector<std::uint64_t> coincidences_seen_;  // Coincidences::changes(), by rule

  KnownRobot robot_;
  std::uint64_t robot_changes_ = 0;
  std::uint64_t robot_discovered_ = 0;
  Time robot_looked_at_ = kLongAgo;
  Time robot_written_ = kLongAgo;
};

}  // namespace culprit::journal
