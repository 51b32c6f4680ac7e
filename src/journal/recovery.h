// What the last run of culprit left behind: told from its intents, and from what it said since.
//
// A strategy was under way if it was chosen or resumed, at least one change for it was about to be
// asked for, and neither its success nor the end of its undoing is on record.
#pragma once

#include <vector>

#include "journal/reader.h"
#include "journal/session.h"
#include "knowledge/interrupted.h"

namespace culprit::journal {

struct Recovery {
  bool had_run = false;         // there was a run before
  bool was_stopped = false;     // and it was asked to end
  bool was_other_boot = false;  // the machine was started anew since
  bool is_paused = false;       // by a person, who has to resume it
  std::vector<Interrupted> interrupted;
  std::vector<std::string> given_up;  // what was under way and cannot be finished, and why
};

// Errors: the file cannot be read.
Expected<Recovery> recover(const Reader& journal, const RuleSet& rules);

}  // namespace culprit::journal
