// Which requests may go out before they are on the disk: the one place where that is decided.
//
// An intent must outlive us: the next culprit finishes what this one left in the middle. For that
// it need not be on the disk, only with the kernel (intent_file.h). The disk matters only for a
// power cut. After one no strategy is continued (recovery.h: the machine was booted again), and
// every process of this machine starts again; its state is read back before any request. So for
// such requests the disk may follow.
//
// A request must be on the disk first if its effect cannot be read back, or outlives a power cut of
// this machine:
//
//   - `call`: nobody can read back whether a routine ran
//   - `increase_parameter`, `decrease_parameter`: the intended value is known from the intent alone
//   - any request to a process that runs elsewhere, or whose machine is not known
#pragma once

#include "knowledge/knowledge.h"
#include "robot/command.h"

namespace culprit::journal {

// @pre it changes something (not is_read())
bool is_settled_here(const Command& command, const Knowledge& knowledge);

}  // namespace culprit::journal
