#include "terminal/command.h"

#include <filesystem>

#include <fmt/core.h>

#include "base/name_grammar.h"
#include "terminal/console.h"

namespace culprit {

int fail(const std::string& why, int exit_code) {
  const bool has_line_end = why.ends_with('\n');  // as a report of several lines
  say(stderr, "culprit: {}{}", escape_lines(why), has_line_end ? "" : "\n");
  return exit_code;
}

std::string trouble_of_folder(const std::string& path) {
  std::error_code error;
  const bool is_file =
      std::filesystem::exists(path, error) && !std::filesystem::is_directory(path, error);
  return is_file ? fmt::format("'{}' is a file; name a folder", printable(path)) : "";
}

}  // namespace culprit
