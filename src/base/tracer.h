// Does a debugger, or strace, hold a process?
#pragma once

namespace culprit {

// A process that another one traces stands still when that one wants it to: it is neither hung nor
// stopped. False where it cannot be told.
bool is_traced(int pid);

}  // namespace culprit
