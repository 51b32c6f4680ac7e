// The port of planners: failures -> strategies.
//
//     class First : public Planner {    // tries each rule's strategies in the order of the file
//       std::vector<Decision> plan(std::span<const RuleId> failures,
//                                  const Knowledge& knowledge) const override {
//         std::vector<Decision> decisions;
//         for (const RuleId rule : failures) {
//           Decision& decision = decisions.emplace_back(Decision{.rule = rule});
//           for (const StrategyId strategy : knowledge.rules[rule].strategies)
//             if (!decision.chosen && !knowledge.states.is_tried(strategy))
//               decision.chosen = strategy;
//           decision.is_spent = !decision.chosen;
//         }
//         return decisions;
//       }
//     };
//
// examples/t03 also lists the candidates, with what excluded them.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "knowledge/knowledge.h"

namespace culprit {

// The decision about one failure.
struct Decision {
  RuleId rule;
  std::optional<StrategyId> chosen;  // empty: the failure has to wait, or nothing is left
  bool is_spent = false;             // no untried strategy is valid now: the round is over
  std::vector<Candidate>
      candidates;                   // every strategy of the rule, best first, with what excluded it
  std::vector<Suspect> suspects{};  // likeliest first; of a planner that weighs them
  // The components whose answers to probes are to be known first.
  std::vector<ComponentId> asks{};
};

class Planner {
 public:
  virtual ~Planner() = default;

  // Decides about `failures`: failing rules without a strategy under way, ascending. One decision
  // for each, in the order of the decisions. The strategies chosen together do not interfere with
  // each other or with those under way.
  virtual std::vector<Decision> plan(std::span<const RuleId> failures,
                                     const Knowledge& knowledge) const = 0;
};

// For callers that need several planners of a kind.
using PlannerFactory = std::function<std::unique_ptr<const Planner>()>;

}  // namespace culprit
