// Long calculations for web clients: by a process of its own, so that their time, memory and errors do not affect the manager; or,
// where they seldom take long, in this one with a lower priority.
#pragma once

#include <cstddef>
#include <functional>
#include <semaphore>
#include <string>
#include <vector>

#include "base/expected.h"
#include "base/temporary_folder.h"
#include "http/routes.h"

namespace culprit::web {

struct Printed {
  int status = 0;  // that it exited with
  std::string text;
};

// Runs a program of `arguments` with the lowest priority to its end, for so many seconds of the processor at most. It ends
// with the thread that calls this. Errors: it cannot be run, was killed, or took longer.
Expected<Printed> run_aside(std::vector<std::string> arguments, const TemporaryFolder& folder,
                            int most_seconds);

// Answers that take the processor for seconds: so many at once, each on a thread of a lower priority. Clients without a
// token never keep those with one waiting. Any thread.
class FewAtOnce {
 public:
  static constexpr std::ptrdiff_t kMost = 4;
  static constexpr int kLowered = 10;  // nice

  // 409: enough are being made. Throws what `answer` throws.
  http::Answer make(const std::function<http::Answer()>& answer);

 private:
  std::counting_semaphore<kMost> with_token_{kMost};
  std::counting_semaphore<kMost> without_token_{kMost};
};

}  // namespace culprit::web
