// A copy of the manager's knowledge that can be changed, to ask for the decision in another
// situation.
#pragma once

#include <functional>
#include <variant>
#include <vector>

#include "knowledge/knowledge.h"

namespace culprit::plan {

// Single changes of what a planner looks at.

struct SuccessChange {
  StrategyId strategy;
  Probability success;  // the belief's mean; its weight stays
};
struct ImpactChange {
  StrategyId strategy;
  Cycles impact;
};
struct TriedChange {
  StrategyId strategy;
  bool is_tried = true;
};
struct ResolvedChange {
  std::vector<RuleId> rules;  // failures that are no more
};
struct ComponentChange {
  enum class Situation : std::uint8_t {
    kAlive,  // its lifecycle as it is
    kActive,
    kInactive,
    kAbsent,
    kLaunchable  // culprit knows how to start it
  };
  ComponentId component;
  Situation situation = Situation::kAlive;
};
struct WhenChange {
  StrategyId strategy;  // whose WHEN condition is true
};

using Change = std::variant<SuccessChange, ImpactChange, TriedChange, ResolvedChange,
                            ComponentChange, WhenChange>;

// Never moves: the knowledge refers to the copied rules.
class WhatIf {
 public:
  explicit WhatIf(const Knowledge& knowledge);
  WhatIf(const WhatIf&) = delete;

  void assume(const Change& change);
  // Takes back all that was assumed.
  void undo();

  const Knowledge& knowledge() const { return knowledge_; }

 private:
  void change(const SuccessChange& change);
  void change(const ImpactChange& change);
  void change(const TriedChange& change);
  void change(const ResolvedChange& change);
  void change(const ComponentChange& change);
  void change(const WhenChange& change);
  void set_signals(ComponentId component);
  void hear(const Input& input);
  void set_signal(InputId id, const Slot& value);
  template <class T>
  void set(T& place, T value);

  RuleSet rules_;
  Knowledge knowledge_;
  std::vector<std::function<void()>> undo_;
};

}  // namespace culprit::plan
