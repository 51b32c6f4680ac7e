// How managers plan that the paper names beside those of the SUAVE study. None asks which failure is
// another one's effect. We could not read the articles on AC-ROS (MODELS 2020), by Vogel (SEAMS 2012)
// and by Ghahremani, only abstracts (arXiv 1805.03549 and 2005.11180, Ghahremani; 1805.08678, Vogel)
// and the section named below, so each is in the style of its authors. Each comes with the source that
// it was taken from, and with what of it can be checked (style_planner_test.cpp).
//
//   rebet       Alberts et al., ReBeT, its reactive adaptation logic, from its public code
//               (EGAlberts/ReBeT, rebet/include/rebet/adapt_node.h) and section III-C2 of their article
//               (ACSOS 2024): decorators of a behaviour tree, one around each action. Each adapts by itself when its own condition holds, and goes
//               through its options in their order. Its bandits: bandit_manager.h.
//   ac-ros      Cheng et al., AC-ROS, from the paper's related work, and from another's public robot
//               after AC-ROS (solzilberman/adaptobot, SAS.py): the utility functions of all goals are
//               evaluated, and the one tactic of each violated goal is executed in the same loop, over
//               and over; no goal comes before another. Check: both tactics, if two goals are
//               violated ("00" in SAS.py). That is a check against adaptobot, not against AC-ROS.
//   vogel       Vogel and Giese, executable runtime megamodels. From Vogel's public exemplar
//               (thomas-vogel/mRUBiS, statemape/Analyze.java and Plan.java): a loop finds all issues,
//               and a static mapping has one strategy for each type. From the beginning of section
//               4.2.1 of their report (Hasso-Plattner-Institut, 66, 2013): whole loops are executed
//               one after the other, self-repair and self-optimization. Here one repairs (ERROR), the
//               next one optimises (the other levels) once nothing is left to repair; levels and
//               condition are ours. Check: a round of Plan.java plans a strategy for each issue.
//   ghahremani  Ghahremani, Giese and Vogel, utility-driven and rule-based. From the abstracts of
//               ICAC 2017 and TAAS 2020: of the rules that match an issue the one that gains most
//               utility for its cost, the worthiest issue first. From mRUBiS, their exemplar
//               (utility/MRubisSelfHealingUtilityFunction.java): the utility of a component is its
//               reliability times its criticality times its number of connectors. Criticality is the
//               level here, 1 to 3; reliability, which rules do not have, is 1. The cost is the impact,
//               and the gain is weighed by the strategy's success, which are ours. Check: one after the
//               other, this order yields the most utility over time of all, as the abstracts claim.
//
// Where they leave open which strategy is meant (vogel, ac-ros) it is the likeliest.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>
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
  // By strategy of `failures`, the value of choosing it: the higher, the earlier.
  std::map<StrategyId, double> worths(std::span<const RuleId> failures,
                                      const Knowledge& knowledge) const;
  // Whether a failure has only one strategy.
  bool has_one_strategy() const { return style_ == Style::kAcRos || style_ == Style::kVogel; }
  void choose(Decision& decision, std::vector<ComponentId>& affected,
              const Knowledge& knowledge) const;

  Style style_;
  Ranking ranking_;
};

}  // namespace culprit::study
