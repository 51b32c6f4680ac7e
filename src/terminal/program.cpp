#include "terminal/program.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string_view>
#include <system_error>

#include "terminal/command.h"

namespace culprit {
namespace {

int parse_and_run(CLI::App& app, const std::function<void(int& exit_code)>& add_commands, int argc,
                  char** argv) {
  app.require_subcommand(1);
  int exit_code = kOk;
  add_commands(exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kOk : kUsage;
  }
  return exit_code;
}

// A report that a full disk cut short must not look whole. A reader that has seen enough may leave.
bool is_output_written(int reason) {
  errno = reason;
  if (reason == 0 && std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return true;
  if (errno == EPIPE) return true;
  std::fprintf(stderr, "culprit: not all of the output could be written%s%s\n",
               errno != 0 ? ": " : "", errno != 0 ? std::strerror(errno) : "");
  return false;
}

}  // namespace

int run_program(CLI::App& app, const std::function<void(int& exit_code)>& add_commands, int argc,
                char** argv) {
  int exit_code = kFailed;
  int reason = 0;
  try {
    exit_code = parse_and_run(app, add_commands, argc, argv);
  } catch (const std::system_error& error) {
    // That is how {fmt} says that it cannot print.
    if (!std::string_view(error.what()).starts_with("cannot write to file")) throw;
    reason = error.code().value();
  }
  return is_output_written(reason) ? exit_code : kFailed;
}

}  // namespace culprit
