// One execution of one strategy, from the choice to the verdict.
#pragma once

#include <cstdint>
#include <string>

#include "base/ids.h"
#include "base/time.h"

namespace culprit {

struct Attempt {
  enum class Stage : std::uint8_t {
    kAdapting,   // its adaptations are being carried out and read back
    kWaiting,    // all took effect; does the symptom clear?
    kSuspended,  // all took effect, and a more critical failure has the component: judged later
    kUndoing,    // it failed; what can be undone is being undone
    kOver        // nothing of it is left to do
  };
  StrategyId strategy;
  Stage stage = Stage::kAdapting;
  Time chosen = kNever;
  Time first_change = kNever;  // when the first request went out that changes anything
  Time effective = kNever;     // when the last adaptation had taken effect
  Time spoke = kNever;         // when all that it started had sent the first of what the rule reads
  Time deadline = kNever;      // of the verdict
  std::string obstacle;        // why an adaptation could not be carried out; empty: none failed
  // Another strategy that can have had the same effect overlapped with it: its outcome proves
  // nothing.
  bool is_ambiguous = false;
  // A person ordered it while the failure was not there: there is nothing to judge.
  bool has_no_failure = false;
};

}  // namespace culprit
