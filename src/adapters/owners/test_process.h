// Processes of tests.
#pragma once

#include <chrono>
#include <csignal>
#include <thread>

#include "owners/proc.h"

namespace culprit::owners {

// Not a zombie either.
inline bool is_alive(int pid) { return pid != 0 && state_letter(pid).value_or('Z') != 'Z'; }

// Kills it. A signal is sent before it is obeyed, so this waits until it was.
inline void end(int pid) {
  kill(pid, SIGKILL);
  while (is_alive(pid)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

}  // namespace culprit::owners
