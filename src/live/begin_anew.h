// If culprit stays deaf, it replaces itself by a new process.
#pragma once

#include <string>
#include <vector>

namespace culprit::live {

// With which arguments the next one is started. It starts nothing that it does not see: this one
// could not see anything.
std::vector<std::string> arguments_of_next(std::vector<std::string> own);

// Starts this program anew in this very process (execve): what it has started stays its, and no
// thread that hangs is waited for. Gives a reason only if that is impossible. The journal has to be
// whole.
std::string begin_anew();

}  // namespace culprit::live
