// The likeliest cause of each failure, and the failures for which nothing can begin without a person.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "diagnose/examination.h"
#include "knowledge/event.h"
#include "plan/bayes/strategy_chances.h"

namespace culprit::plan {

// Does it do nothing but replace processes that are known to be down? It may pause what depends on them.
bool only_revives(const Strategy& strategy, const Knowledge& knowledge);

// Failures and causes are named by their nodes (diagnose::Causes).
class LikelyCauses {
 public:
  // `failures`: those to be decided about. All must outlive it.
  LikelyCauses(const Knowledge& knowledge, const diagnose::Examination& found,
               std::span<const RuleId> failures);

  // The likeliest cause outside its loop, if the failure more likely has one than not (an exhausted
  // cause: twice as likely); or else the member of its loop that is known to be dead. A failure about components
  // that evidently work is no cause.
  std::optional<std::size_t> of(std::size_t failure) const;
  // The component on an unreachable computer that the failure is about, or can have spread from. It
  // explains the failure for sure; a learned coupling does not.
  std::optional<ComponentId> unheard(std::size_t failure) const { return unheard_[failure]; }
  // The causes to be shown, the likeliest first.
  std::vector<Suspect> suspects(std::size_t failure) const;

  // The strategies of a failure that is to be decided about, in the order of the file.
  const std::vector<StrategyChance>& chances(std::size_t failure) const {
    return chances_[failure];
  }
  // No strategy may begin for the failure without a person, now or later.
  bool waits_for_person(std::size_t failure) const;
  // It is exhausted, or nothing may be begun for it without a person: no rule that can see touches a
  // component in trouble, or no node supplies an input.
  bool is_left_to_person(std::size_t node) const;

  // The component of those that the rule is about (touched_by()) at which its strategies are most likely to help.
  ComponentId likeliest_component(RuleId rule) const;
  // The component that the effects of the node depend on.
  ComponentId component_of(std::size_t node) const;

 private:
  bool is_exhausted(std::size_t node) const;
  bool is_contradicted(std::size_t node) const;
  std::vector<std::size_t> all_contradicted() const;
  std::vector<std::optional<ComponentId>> all_unheard() const;
  std::optional<ComponentId> unheard_behind(std::size_t failure) const;
  // The first member that is not up, of a group that a strategy of the rule brings up; its manager
  // if all are.
  std::optional<ComponentId> missing_member(RuleId rule) const;

  const Knowledge& knowledge_;
  const diagnose::Examination& found_;
  const diagnose::Causes& causes_;                   // of found_
  const diagnose::Diagnosis& diagnosis_;             // likewise
  std::vector<std::optional<ComponentId>> unheard_;  // by node
  const Time last_question_;  // to any component; most plans are made where nothing was asked
  std::vector<std::vector<StrategyChance>> chances_;  // by node
  std::vector<std::size_t> contradicted_;             // no other failure waits for these
};

}  // namespace culprit::plan
