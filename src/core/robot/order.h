// Orders of a person to the manager: wait, go on, leave this alone, do that.
//
// An order reaches the manager as an observation, so that a recorded run replays together with its
// orders. An event reports whether the order was accepted (OrderAccepted, OrderRefused). A person's
// order goes before the manager's own decision, but not before the robot's safety:
// docs/governor.md.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "base/ids.h"
#include "base/units.h"

namespace culprit {

// The kill switch. From now on no request goes out that changes anything: strategies under way are
// abandoned where they are and nothing is undone, until Resume.
struct Pause {};
struct Resume {};

// Strategies are chosen and said, and nothing is begun. Those under way go on to their verdict.
struct SetDryRun {
  bool is_on = true;
};

// About the strategy that waits for approval (ApprovalAsked). One that is refused is not proposed
// again for the same failure.
struct Approve {
  StrategyId strategy;
};
struct Refuse {
  StrategyId strategy;
};

// A program proposes a strategy for a failure that is present (culprit propose, culprit mcp). It waits for
// a person's approval like one that culprit chose, and begins only with that.
struct Propose {
  StrategyId strategy;
};

// No strategy begins that adapts the component, or that belongs to the rule. culprit goes on
// watching it.
using Silenceable = std::variant<ComponentId, RuleId>;
struct Silence {
  Silenceable what;
  std::optional<Duration> lasts{};  // empty: until it is lifted
};
struct LiftSilence {
  Silenceable what;
};

// Carries out a strategy now, whether its failure is there or not, whatever the limits say.
struct RunStrategy {
  StrategyId strategy;
};

// Resets the rule's beliefs in its strategies, and its couplings, to the rule file's priors.
// Without a rule: those of all rules.
struct Forget {
  std::optional<RuleId> rule{};
};

// Components that stay down, because a person ended them or may have (StaysDown), may be started again.
struct Revive {};

// The processes that culprit started are ended, and their components stay down.
struct EndStarted {};

struct Order {
  std::uint64_t number = 0;  // of the sender's choosing, for it to know the answer by
  std::string author;        // who says so, for the record
  std::string reason;        // may be empty
  std::variant<Pause, Resume, SetDryRun, Approve, Refuse, Propose, Silence, LiftSilence,
               RunStrategy, Forget, Revive, EndStarted>
      what;
};

}  // namespace culprit
