// For tests of one command: called as CLI11 calls it, and with what it printed.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <gtest/gtest.h>

namespace culprit::cli {

struct CommandEnd {
  int exit_code = -1;
  std::string out;
  std::string err;
};

// `add` adds the command to a program, as the functions of commands.h do; `words` begin with its name.
template <class Add>
CommandEnd end_of_command(Add add, std::vector<std::string> words) {
  CommandEnd end;
  CLI::App app;
  add(app, end.exit_code);
  std::reverse(words.begin(), words.end());  // as CLI11 takes them
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  app.parse(std::move(words));
  end.out = testing::internal::GetCapturedStdout();
  end.err = testing::internal::GetCapturedStderr();
  return end;
}

}  // namespace culprit::cli
