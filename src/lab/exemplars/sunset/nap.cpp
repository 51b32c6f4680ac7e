#include "exemplars/sunset/nap.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <thread>

namespace culprit::sunset {
namespace {

bool is_told_to_end() {
  sigset_t pending;
  sigemptyset(&pending);
  sigpending(&pending);
  return sigismember(&pending, SIGINT) == 1 || sigismember(&pending, SIGTERM) == 1;
}

}  // namespace

void nap(Duration duration) {
  constexpr Duration kSlice = std::chrono::milliseconds(10);
  const auto end = std::chrono::steady_clock::now() + duration;
  for (auto now = std::chrono::steady_clock::now(); now < end && !is_told_to_end();
       now = std::chrono::steady_clock::now()) {
    std::this_thread::sleep_for(std::min<Duration>(end - now, kSlice));
  }
}

}  // namespace culprit::sunset
