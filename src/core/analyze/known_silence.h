// Silence that is known before it is heard.
//
// Of a component that is known dead (ComponentState::known_dead) nothing comes any more. What it
// alone publishes is silent from now on, so a trigger that silence makes true need not wait until it
// is heard: it is evaluated as if that had been silent for long. All else that it reads counts as it
// is, so it becomes true only where the dead one alone explains it.
//
//   who sees it   the rules that can bring the dead one back (redeploy or start it). Others may
//                 have been written to wait whether that helps; their own silence decides. Where
//                 no rule can bring it back, all see it
//   how long      until the component is back; then its own silence decides again. While a strategy
//                 of the rule is under way, until what it publishes was heard anew: that it could
//                 begin is no proof that it speaks
//   FOR, HOLD     keep their time, from its end on
#pragma once

#include <optional>
#include <vector>

#include "knowledge/knowledge.h"
#include "language/evaluate.h"

namespace culprit {

class KnownSilence {
 public:
  // `knowledge` must outlive it.
  explicit KnownSilence(const Knowledge& knowledge);

  // The component whose known death makes the trigger of `rule` true. Nothing: none does.
  // @pre what the trigger reads does not make it true by itself
  std::optional<ComponentId> behind(RuleId rule) const;

  // The event, with that component.
  FailureDetected detected(RuleId rule) const;

 private:
  std::optional<ComponentId> silent_through(TopicId topic, RuleId rule) const;
  bool sees(RuleId rule, ComponentId component) const;

  const Knowledge& knowledge_;
  std::vector<bool> is_brought_back_;             // by component: some rule can do it
  std::vector<std::vector<InputId>> of_silence_;  // by rule: what it reads that silence decides
};

}  // namespace culprit
