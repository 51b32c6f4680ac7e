// Everything that a diagnosis of some failures looks at, found once, in order:
//
//     imminent rules, troubles -> awaited evidence -> paths -> causes -> P(own cause)
//
//     const diagnose::Examination found(knowledge, failures);
//     const std::size_t i = found.causes().index_of(failure);
//     if (found.diagnosis().of(i) > 0.5 && !found.awaited().of(failure)) repair(failure);
//
// Deterministic; changes nothing.
#pragma once

#include "diagnose/diagnosis.h"

namespace culprit::diagnose {

class Examination {
 public:
  // `failures`: those to be decided about. `knowledge` must outlive it.
  Examination(const Knowledge& knowledge, std::span<const RuleId> failures);
  Examination(const Examination&) = delete;

  // The components that matter: those that failures and imminent rules touch, or that end with these;
  // those in trouble; and those on an unreachable host.
  const Reach& reach() const { return reach_; }
  std::span<const RuleId> imminent() const { return imminent_; }
  std::span<const std::optional<TroubleSeen>> troubles() const { return troubles_; }
  const Awaited& awaited() const { return awaited_; }
  const Paths& paths() const { return paths_; }
  const Causes& causes() const { return causes_; }
  const Diagnosis& diagnosis() const { return diagnosis_; }

 private:
  std::vector<RuleId> imminent_;
  std::vector<std::optional<TroubleSeen>> troubles_;  // by component
  Awaited awaited_;
  Reach reach_;
  Paths paths_;
  Causes causes_;
  Diagnosis diagnosis_;
};

}  // namespace culprit::diagnose
