// Does a debugger, or strace, hold a process?
#pragma once

namespace culprit {

// A debugger can halt a process that it traces: the process is neither hung nor stopped. False
// where this cannot be determined.
bool is_traced(int pid);

}  // namespace culprit
