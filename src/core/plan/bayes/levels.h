// How bad is it? The level at which each failure is treated.
//
// The failure that is held responsible for another one inherits its criticality if that is higher,
// as the holder of a lock inherits the priority of the thread that waits for it (Sha, Rajkumar,
// Lehoczky, "Priority inheritance protocols", IEEE Transactions on Computers 39, 1990):
//
//     L_i = max(own level of i, max_k L_k)
//
// over the failures k that wait for i: those that have a cause upstream and none of their own, i
// being enough to explain them (Diagnosis::is_explained_by); and those in the same feedback
// loop as i, for each of them may be the cause of the others. Without that, a WARNING whose effect is an
// ERROR would wait for the repair of components that are not broken.
#pragma once

#include <vector>

#include "diagnose/diagnosis.h"

namespace culprit::plan {

class Levels {
 public:
  // `knowledge` must outlive it.
  Levels(const Knowledge& knowledge, const diagnose::Causes& causes,
         const diagnose::Diagnosis& diagnosis);

  // The level of a rule without a failure is its own.
  Criticality of(RuleId rule) const;

 private:
  const Knowledge& knowledge_;
  const diagnose::Causes& causes_;
  std::vector<Criticality> levels_;  // by node
};

}  // namespace culprit::plan
