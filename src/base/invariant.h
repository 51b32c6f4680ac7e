// Invariants whose violation would harm a robot: a process of another component would be ended, a
// command would reach the wrong node, or a wrong row would be written.
//
//     CULPRIT_ASSERT(!is_reaped_);  // the process number may be reused by now
//
// They are checked in release builds, too. A violation is a bug of culprit: it prints the condition
// with its place and aborts. The robot runs on as it is, the service manager starts culprit again, and
// the new process continues from the journal.
//
// Bad input is no violation: for it there is Expected.
#pragma once

namespace culprit {

[[noreturn]] void invariant_violated(const char* condition, const char* file, int line);

}  // namespace culprit

#define CULPRIT_ASSERT(condition) \
  ((condition) ? void() : ::culprit::invariant_violated(#condition, __FILE__, __LINE__))
