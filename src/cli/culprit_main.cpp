#include <cerrno>
#include <cstring>
#include <unistd.h>

#include "base/environment.h"
#include "cli/commands.h"
#include "terminal/program.h"

namespace {

using namespace culprit;

// What culprit-lab does in culprit's name.
struct OfLaboratory {
  const char* name;
  const char* description;
};
constexpr OfLaboratory kOfLaboratory[] = {
    {"demo", "Let culprit heal a live robot (by culprit-lab)"},
    {"study", "Campaigns over the exemplars and over random robots (by culprit-lab)"},
    {"torture", "Run culprit on random robots with everything going wrong (by culprit-lab)"},
};

// In place of this program. Comes back only if that is impossible.
int become_laboratory(char** argv) {
  const auto laboratory = find_laboratory();
  if (!laboratory) return fail(laboratory.error());
  execv(laboratory->c_str(), argv);
  return fail("cannot start " + laboratory->string() + ": " + std::strerror(errno));
}

void add_commands(CLI::App& app, int& exit_code) {
  cli::add_run(app, CULPRIT_VERSION, exit_code);
  cli::add_check(app, exit_code);
  cli::add_doctor(app, exit_code);
  cli::add_init(app, exit_code);
  cli::add_explain(app, exit_code);
  cli::add_fmt(app, exit_code);
  cli::add_test(app, exit_code);
  cli::add_plan(app, exit_code);
  cli::add_graph(app, exit_code);
  for (const OfLaboratory& each : kOfLaboratory) app.add_subcommand(each.name, each.description);
  cli::add_web(app, exit_code);
  cli::add_lsp(app, CULPRIT_VERSION, exit_code);
  cli::add_import(app, exit_code);
  cli::add_modes(app, exit_code);
  cli::add_export(app, exit_code);
  cli::add_policy(app, exit_code);
  cli::add_log(app, exit_code);
  cli::add_audit(app, exit_code);
  cli::add_beliefs(app, exit_code);
  cli::add_replay(app, exit_code);
}

}  // namespace

int main(int argc, char** argv) {
  for (const OfLaboratory& each : kOfLaboratory) {
    if (argc > 1 && std::strcmp(argv[1], each.name) == 0) return become_laboratory(argv);
  }
  CLI::App app{
      "culprit keeps ROS 2 robots working: it finds the component that is responsible when many "
      "things fail at once,\n"
      "and applies the fewest, cheapest adaptations that bring the robot back."};
  app.name("culprit");
  app.set_version_flag("--version", "culprit " CULPRIT_VERSION);
  app.footer(
      "A first look:  culprit demo\nYour robot:    culprit graph; culprit check my.rules; culprit "
      "run --dry-run my.rules");
  return run_program(
      app, [&](int& exit_code) { add_commands(app, exit_code); }, argc, argv);
}
