// Until when a trigger that is false shows that the function of its rule worked.
//
// One part of `a || b` is enough. A part shows nothing if it is false only because of
//   - a topic that never came: it is not older than its limit at first;
//   - the lifecycle of a component that is not active, and so has nothing to do;
//   - a diagnostic of others, such as a mode: in another one the rule would not fire.
// A window shows what was before it, and goals what was when the last one was read: none is aborted while none runs.
#pragma once

#include <vector>

#include "knowledge/knowledge.h"
#include "language/evaluate.h"

namespace culprit {

class SeenWorking {
 public:
  // Must outlive it.
  explicit SeenWorking(const Knowledge& knowledge);

  // kLongAgo: it shows nothing.
  // @pre the trigger is false
  Time until(RuleId rule, Time now);

 private:
  struct Part {
    Program trigger;
    std::vector<InputId> inputs;
    std::vector<InputId> guards;  // those that say nothing of what the rule is about
  };
  std::vector<InputId> guards_of(const Rule& rule, const std::vector<InputId>& inputs) const;
  Time until(const Part& part, const Rule& rule, Time now);
  bool is_false_since(Time since, const Part& part, Time now);
  Time shown_until(InputId input, Time now) const;

  const Knowledge& knowledge_;
  std::vector<std::vector<Part>> parts_;  // by rule
  std::vector<Assumed> unknown_;          // kept for its memory
};

}  // namespace culprit
