// What a person tells the manager: wait, go on, leave this alone, do that.
//
// An order reaches the manager as an observation, so that a recorded run replays together with
// what people did to it. What became of it is an event (OrderAccepted, OrderRefused). A person's
// word goes before the manager's own, but not before the robot's safety: docs/governor.md.
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

// Nothing is begun that adapts the component, or about the rule. It goes on being watched.
using Silenceable = std::variant<ComponentId, RuleId>;
struct Silence {
  Silenceable what;
  std::optional<Duration> lasts{};  // nothing: until it is lifted
};
struct LiftSilence {
  Silenceable what;
};

// Carries out a strategy now, whether its failure is there or not, whatever the limits say.
struct RunStrategy {
  StrategyId strategy;
};

// What was learned of the rule's strategies, and of what goes away with it, is as the rules say
// again. Nothing: of all rules.
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
  std::variant<Pause, Resume, SetDryRun, Approve, Refuse, Silence, LiftSilence, RunStrategy, Forget,
               Revive, EndStarted>
      what;
};

}  // namespace culprit
