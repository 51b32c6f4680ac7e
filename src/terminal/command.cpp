#include "terminal/command.h"

#include "terminal/console.h"

namespace culprit {

int fail(const std::string& why, int exit_code) {
  const bool has_line_end = why.ends_with('\n');  // as a report of several lines
  say(stderr, "culprit: {}{}", why, has_line_end ? "" : "\n");
  return exit_code;
}

}  // namespace culprit
