#include "plan/decision.h"

#include <cstdio>

#include "knowledge/describe.h"
#include "plan/explained_by.h"

namespace culprit::plan {
namespace {

class Describer {
 public:
  Describer(StrategyId loser, const Knowledge& knowledge)
      : loser_(loser), knowledge_(knowledge), rules_(knowledge.rules) {}

  std::string operator()(const SuccessChange& change) const {
    const Probability now = knowledge_.beliefs[change.strategy].mean();
    const std::string whose = change.strategy == loser_ ? "its" : name_of(change.strategy) + "'s";
    return whose + " success probability were " +
           (change.success > now ? "at least " : "at most ") + to_string(change.success) + " (is " +
           to_string(now) + ")";
  }
  std::string operator()(const ImpactChange& change) const {
    const std::int64_t cycles = change.impact.count;
    return "its impact were at most " + std::to_string(cycles) +
           (cycles == 1 ? " cycle" : " cycles") + " (is " +
           std::to_string(rules_[change.strategy].impact.count) + ")";
  }
  std::string operator()(const TriedChange& change) const {
    if (!change.is_tried) return "it had not been tried already";
    return name_of(change.strategy) + " had been tried already";
  }
  std::string operator()(const ResolvedChange& change) const {
    std::vector<std::string> names;
    for (const RuleId rule : change.rules) names.push_back(rules_[rule].name);
    return listed(names) + " were resolved";
  }
  std::string operator()(const ComponentChange& change) const {
    const std::string& component = rules_[change.component].name;
    using enum ComponentChange::Situation;
    switch (change.situation) {
      case kAlive:
        return component + " were alive";
      case kActive:
        return component + " were alive and active";
      case kInactive:
        return component + " were alive and inactive";
      case kAbsent:
        return component + " were not there";
      case kLaunchable:
        return component + " had a LAUNCH command";
    }
    return "";
  }
  std::string operator()(const WhenChange&) const { return "its WHEN condition were true"; }

 private:
  // Strategies of different rules may have the same name.
  std::string name_of(StrategyId id) const {
    const Strategy& strategy = rules_[id];
    const bool is_sibling = strategy.rule == rules_[loser_].rule;
    return (is_sibling ? "" : rules_[strategy.rule].name + ".") + strategy.name;
  }

  StrategyId loser_;
  const Knowledge& knowledge_;
  const RuleSet& rules_;
};

}  // namespace

std::vector<ExplainedDecision> decide(const Planner& planner, std::vector<RuleId> failures,
                                      const Knowledge& knowledge) {
  FlipFinder finder(planner, std::move(failures), knowledge);
  std::vector<ExplainedDecision> decisions;
  for (const Decision& decision : finder.decisions()) {
    ExplainedDecision explained{decision, {}, {}};
    if (decision.chosen) explained.explains = explained_by(*decision.chosen, knowledge);
    for (const Candidate& candidate : decision.candidates) {
      const bool is_sought =
          decision.chosen != candidate.strategy && decisions.size() < kMostFlipped;
      explained.flips.push_back(is_sought ? finder.flips(candidate.strategy)
                                          : std::vector<Change>());
    }
    decisions.push_back(std::move(explained));
  }
  return decisions;
}

std::string describe(const Change& change, StrategyId loser, const Knowledge& knowledge) {
  return std::visit(Describer(loser, knowledge), change);
}

}  // namespace culprit::plan
