#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string_view>
#include <system_error>

#include "cli/commands.h"

namespace {

int run(int argc, char** argv) {
  CLI::App app{
      "culprit keeps ROS 2 robots working: it finds the component that is responsible when many "
      "things fail at once,\n"
      "and applies the fewest, cheapest adaptations that bring the robot back."};
  app.name("culprit");
  app.set_version_flag("--version", "culprit " CULPRIT_VERSION);
  app.require_subcommand(1);
  app.footer(
      "A first look:  culprit demo\nYour robot:    culprit graph; culprit check my.rules; culprit "
      "run --dry-run my.rules");
  int exit_code = culprit::cli::kOk;
  culprit::cli::add_run(app, CULPRIT_VERSION, exit_code);
  culprit::cli::add_check(app, exit_code);
  culprit::cli::add_explain(app, exit_code);
  culprit::cli::add_fmt(app, exit_code);
  culprit::cli::add_test(app, exit_code);
  culprit::cli::add_plan(app, exit_code);
  culprit::cli::add_graph(app, exit_code);
  culprit::cli::add_demo(app, exit_code);
  culprit::cli::add_web(app, exit_code);
  culprit::cli::add_lsp(app, CULPRIT_VERSION, exit_code);
  culprit::cli::add_import(app, exit_code);
  culprit::cli::add_study(app, CULPRIT_VERSION, exit_code);
  culprit::cli::add_modes(app, exit_code);
  culprit::cli::add_export(app, exit_code);
  culprit::cli::add_policy(app, exit_code);
  culprit::cli::add_torture(app, exit_code);
  culprit::cli::add_log(app, exit_code);
  culprit::cli::add_audit(app, exit_code);
  culprit::cli::add_beliefs(app, exit_code);
  culprit::cli::add_replay(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? culprit::cli::kOk : culprit::cli::kUsage;
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

int main(int argc, char** argv) {
  int exit_code = culprit::cli::kFailed;
  int reason = 0;
  try {
    exit_code = run(argc, argv);
  } catch (const std::system_error& error) {
    // That is how {fmt} says that it cannot print.
    if (!std::string_view(error.what()).starts_with("cannot write to file")) throw;
    reason = error.code().value();
  }
  return is_output_written(reason) ? exit_code : culprit::cli::kFailed;
}
