#include "terminal/program.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>
#include <system_error>

#include <fmt/core.h>

#include "base/name_grammar.h"
#include "terminal/command.h"
#include "terminal/console.h"
#include "terminal/help.h"
#include "terminal/listed.h"
#include "terminal/manual.h"
#include "terminal/wrong_call.h"

namespace culprit {
namespace {

// A flag would take any number for the count of its uses: --web=80.
void refuse_values_of_flags(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    const bool is_flag = option->get_items_expected_max() == 0 && option->nonpositional();
    if (!is_flag || option == app.get_help_ptr() || option == app.get_version_ptr()) continue;
    option->check([](const std::string& value) {
      return value == "true" || value == "false" ? "" : "takes no value; remove '=" + value + "'";
    });
  }
  for (CLI::App* part : app.get_subcommands([](CLI::App*) { return true; }))
    refuse_values_of_flags(*part);
}

// How the command is called, and where its options are listed.
void say_usage(const CLI::App& app, const Chosen& line) {
  const std::string of_command = line.path.substr(app.get_name().size());
  const bool has_help = command_named(app, "help") != nullptr;
  const std::string more = has_help ? app.get_name() + " help" + of_command : line.path + " --help";
  say(stderr, "Usage: {}\nRun '{}' for more information.\n", usage_of(*line.command, line.path),
      more);
}

int usage_error(const std::string& cause, const CLI::App& app, const Chosen& line) {
  const int code = fail(escape_controls(cause), kUsage);
  say_usage(app, line);
  return code;
}

int parse_and_run(CLI::App& app, const std::function<void(int& exit_code)>& add_commands, int argc,
                  char** argv) {
  app.require_subcommand(1);
  app.formatter(help_formatter());
  int exit_code = kOk;
  add_commands(exit_code);
  refuse_values_of_flags(app);
  if (argc < 2) {
    say(stderr, "{}", app.help());
    return kUsage;
  }
  // "culprit --help run" is about `run`.
  const bool is_help_first =
      argc > 2 && (argv[1] == std::string_view("--help") || argv[1] == std::string_view("-h")) &&
      *argv[2] != '-';
  if (is_help_first) std::rotate(argv + 1, argv + 2, argv + argc);
  // "--wait 3 s": the unit may be taken for one more file.
  if (const Chosen line = named_in(app, argc, argv); line.depth > 0) {
    if (const auto slip = slip_of_values(*line.command, argc, argv))
      return usage_error(*slip, app, line);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error) == 0 ? kOk : kUsage;
    const Chosen line = chosen(app);
    return usage_error(cause_of_wrong_call(error, app, line, argc, argv), app, line);
  }
  // The command itself found the mistake.
  if (exit_code == kUsage) say_usage(app, chosen(app));
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
    if (!std::string_view(error.what()).starts_with("cannot write to file"))
      return fail(fmt::format(
          "cannot go on: {}; is a limit of threads, processes or memory reached?", error.what()));
    reason = error.code().value();
  }
  return is_output_written(reason) ? exit_code : kFailed;
}

void end_program(int exit_code) {
  constexpr int kNoReason = 0;
  std::_Exit(is_output_written(kNoReason) ? exit_code : kFailed);
}

}  // namespace culprit
