#include "terminal/program.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/core.h>

#include "base/closest.h"
#include "base/name_grammar.h"
#include "terminal/command.h"
#include "terminal/console.h"
#include "terminal/help.h"

namespace culprit {
namespace {

std::vector<std::string_view> commands_of(const CLI::App& app) {
  std::vector<std::string_view> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

std::vector<std::string> options_of(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

// "; did you mean 'check'?", or nothing.
std::string meant(std::string_view word, const std::vector<std::string_view>& known) {
  const std::string near = closest(word, known);
  return near.empty() ? "" : "; did you mean '" + near + "'?";
}

// The first option on the command line that the command has not; empty: there is none.
std::string unknown_option(const std::vector<std::string>& known, int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view word(argv[i]);
    const std::string option(word.substr(0, word.find('=')));
    if (option == "--") return "";
    const bool is_option = option.starts_with("--");
    if (is_option && std::find(known.begin(), known.end(), option) == known.end()) return option;
  }
  return "";
}

// Why the words of the command line are wrong, where the name of a command or of an option is not
// known; nothing where something else is.
std::optional<std::string> unknown_word(const CLI::App& app, int argc, char** argv) {
  const auto chosen = app.get_subcommands();
  if (chosen.empty()) {
    if (argc < 2 || *argv[1] == '-') return std::nullopt;
    return "there is no command '" + printable(argv[1]) + "'" + meant(argv[1], commands_of(app));
  }
  const CLI::App* command = chosen.front();
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  const std::vector<std::string> known = options_of(*command);
  const std::string option = unknown_option(known, argc, argv);
  if (option.empty()) return std::nullopt;
  return command->get_name() + " has no option '" + printable(option) + "'" +
         meant(option, {known.begin(), known.end()});
}

int parse_and_run(CLI::App& app, const std::function<void(int& exit_code)>& add_commands, int argc,
                  char** argv) {
  app.require_subcommand(1);
  app.formatter(help_formatter());
  int exit_code = kOk;
  add_commands(exit_code);
  if (argc < 2) {
    say(stderr, "{}", app.help());
    return kUsage;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) {
      if (const auto why = unknown_word(app, argc, argv))
        return fail(*why + "\nRun with --help for more information.", kUsage);
    }
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
