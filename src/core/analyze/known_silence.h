// Silence that is known before it is heard.
//
// A component that is known to be down (ComponentState::known_dead) publishes no more. Topics that it
// alone publishes are silent from now on, so a trigger that silence makes true need not wait for the
// timeout: it is evaluated as if those topics had been silent for long. All other inputs count as
// they are, so the trigger becomes true only where the dead component alone explains it.
//
//   which rules   those that can bring the dead component back (redeploy or start it). Others may
//                 have been written to wait whether that helps; their own timeout decides. Where
//                 no rule can bring it back, all evaluate it so
//   how long      until the component is back; then the topics' own silence decides again. While a
//                 strategy of the rule is under way, until the topics are received again: a
//                 component that could begin need not publish yet
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

  // The component whose known death makes the trigger of `rule` true, or would make it true. Empty:
  // none does.
  std::optional<ComponentId> behind(RuleId rule) const;

  // The event, with that component unless the inputs show the failure by themselves.
  FailureDetected detected(RuleId rule) const;

 private:
  std::optional<ComponentId> silent_through(TopicId topic, RuleId rule) const;
  bool reads_whether_alive(RuleId rule, ComponentId component) const;
  bool sees(RuleId rule, ComponentId component) const;

  const Knowledge& knowledge_;
  std::vector<bool> is_brought_back_;             // by component: some rule can do it
  std::vector<std::vector<InputId>> of_silence_;  // by rule: what it reads that silence decides
};

}  // namespace culprit
