// How managers plan that the paper names beside those of the SUAVE study, each after its own
// description. None asks which failure is another one's effect.
//
//   rebet       Alberts et al., ReBeT, its reactive adaptation logic: decorators of a behaviour
//               tree, one around each action. Each adapts by itself when its own condition holds,
//               and goes through its options in their order. Its bandits: bandit_manager.h.
//   ac-ros      Cheng et al., AC-ROS: the goal model is evaluated, and for each violated goal its
//               one predefined plan is executed, over and over; no goal comes before another.
//   vogel       Vogel and Giese, executable runtime megamodels: one feedback loop repairs
//               (ERROR), the next one optimises (the other levels) once nothing is left to repair.
//   ghahremani  Ghahremani et al., utility-driven and rule-based: of the rules that match an issue
//               the one that gains most utility for its cost, the worthiest issue first. The worth
//               of a repaired component is its level, 1 to 3, times itself and all that depend
//               on it.
//
// Where they leave open which strategy is meant (vogel, ac-ros) it is the likeliest.
#pragma once

#include <functional>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "plan/planner.h"

namespace culprit::study {

enum class Style : std::uint8_t { kRebet, kAcRos, kVogel, kGhahremani };

// Empty for another name.
std::optional<Style> find_style(std::string_view name);

class StylePlanner : public Planner {
 public:
  // A rule's strategies, best first.
  using Ranking = std::function<std::vector<StrategyId>(const Rule& rule)>;

  // With a ranking, strategies come in its order among those that are worth the same.
  explicit StylePlanner(Style style, Ranking ranking = nullptr)
      : style_(style), ranking_(std::move(ranking)) {}
  std::vector<Decision> plan(std::span<const RuleId> failures,
                             const Knowledge& knowledge) const override;

 private:
  // The failure that one of `rule` waits for.
  std::optional<RuleId> comes_first(RuleId rule, const Knowledge& knowledge) const;
  // The value of a strategy, or of all strategies of a failure: the higher, the earlier.
  double worth(StrategyId id, const Knowledge& knowledge) const;

  Style style_;
  Ranking ranking_;
};

}  // namespace culprit::study
