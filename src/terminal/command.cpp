#include "terminal/command.h"

#include "terminal/console.h"

namespace culprit {

int fail(const std::string& why, int exit_code) {
  say(stderr, "culprit: {}\n", why);
  return exit_code;
}

}  // namespace culprit
