// The state that outlives a manager's crash, as the journal keeps it (journal/recovery.h), without
// a file: the events, and the strategies that were under way.
//
// The events and requests of a step are noted before its requests go out.
#pragma once

#include <span>
#include <vector>

#include "knowledge/history.h"
#include "knowledge/interrupted.h"
#include "language/rule_set.h"

namespace culprit::torture {

class Memory {
 public:
  // `rules` must outlive the memory.
  explicit Memory(const RuleSet& rules) : rules_(rules) {}

  // A step: its observations, its events, and the requests that are about to go out.
  void note(std::span<const Observation> observations, std::span<const Event> events,
            std::span<const Command> commands);

  const History& past() const { return past_; }
  // Those that had begun to change anything.
  std::vector<Interrupted> interrupted() const;

 private:
  void note(const Reply& reply);
  void note(const Event& event);
  void note(const Command& command);
  Interrupted* open(StrategyId strategy);
  void close(RuleId rule);

  const RuleSet& rules_;
  History past_;
  std::vector<Interrupted> open_;
};

}  // namespace culprit::torture
