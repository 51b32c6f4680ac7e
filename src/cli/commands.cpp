#include "cli/commands.h"

#include <fmt/format.h>

namespace culprit::cli {

int fail(const std::string& why, int exit_code) {
  fmt::print(stderr, "culprit: {}\n", why);
  return exit_code;
}

}  // namespace culprit::cli
