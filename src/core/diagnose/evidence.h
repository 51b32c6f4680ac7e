// The evidence for and against a suspect, for people and for the journal.
//
// The probabilities come from a few pieces of evidence, each with a weight: by how much it moves the
// natural logarithm of the odds that the suspect is the cause of the failure. Weights above 0 speak for
// it. Certainty is shown as kSurely.
//
//   suspect                     evidence                             weight
//   the failure's component     its process is gone or stopped       logit kKnownDown
//                               others may explain the failure       logit kCoincidence, -ln X_i
//                               nothing upstream is wrong            kSurely
//                               it is in a feedback loop             logit R_i - logit P(own i)
//                               the system clock was stepped then    0: no node is the likelier for it
//   another cause j             what is wrong there (causes.h)       kSurely + ln kUsual: of j alone
//                               i worked for long beside it          ln g(j -> i)
//                               they cleared together, or did not    ln kappa(j -> i) - ln kUsual
//
// Symbols: diagnosis.h.
#pragma once

#include <optional>
#include <vector>

#include "diagnose/examination.h"
#include "diagnose/otherwise.h"
#include "knowledge/event.h"

namespace culprit::diagnose {

inline constexpr double kSurely = 6.9;  // 1,000 to 1

struct PieceOfEvidence {
  Evidence evidence;
  // The node that would be the likeliest cause without it (otherwise.h); nothing: the same as with it.
  std::optional<std::size_t> otherwise{};
};
// For suspect `j` of failure `i`, both nodes of found.causes(); the heaviest first. @pre j is i or one
// of its causes; `otherwise` is of i
std::vector<PieceOfEvidence> evidence_for(std::size_t j, std::size_t i, const Otherwise& otherwise,
                                          const Examination& found, const Knowledge& knowledge);

// The latest questions, at most kMostQuestions, that culprit put to the failure's components and to those upstream since it
// began, with the answers; newest first. Weight 0: a component that does not answer counts as a trouble (trouble.h).
std::vector<Evidence> answers_about(RuleId failure, const Knowledge& knowledge);

}  // namespace culprit::diagnose
