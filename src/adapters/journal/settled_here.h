// Which requests may go out before they are on the disk: the one place where that is decided.
//
// An intent must outlive us: the next culprit finishes what this one left in the middle. For that
// it need not be on the disk, only with the kernel (intent_file.h). What the disk adds is a power
// cut. After one nothing is gone on with (recovery.h: the machine was started anew), and whatever
// ran on this machine begins anew itself; what state it is in is read back before anything is
// asked for. So for such requests the disk may follow.
//
// On the disk first is what cannot be looked up afterwards, or what lives on through our power cut:
//
//   - `call`: nobody can read back whether a routine ran
//   - `increase_parameter`, `decrease_parameter`: what was meant is known from the intent alone
//   - whatever does not run on this machine, or of which that is not known
#pragma once

#include "knowledge/knowledge.h"
#include "robot/command.h"

namespace culprit::journal {

// @pre it changes something (not is_read())
bool is_settled_here(const Command& command, const Knowledge& knowledge);

}  // namespace culprit::journal
