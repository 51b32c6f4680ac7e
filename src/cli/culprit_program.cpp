#include "cli/culprit_program.h"

#include <cerrno>
#include <cstring>
#include <unistd.h>

#include "base/environment.h"
#include "cli/commands.h"
#include "cli/culprit_manual.h"
#include "terminal/program.h"

namespace culprit::cli {
namespace {

// In place of this program. Comes back only if that is impossible.
int become_laboratory(char** argv) {
  const auto laboratory = find_laboratory();
  if (!laboratory) return fail(laboratory.error());
  execv(laboratory->c_str(), argv);
  return fail("cannot start " + laboratory->string() + ": " + std::strerror(errno));
}

}  // namespace

int run_culprit(const std::string& version, int argc, char** argv) {
  if (argc > 1 && is_of_laboratory(argv[1])) return become_laboratory(argv);
  CLI::App app{
      "culprit keeps ROS 2 robots working: it finds the component that is responsible when many "
      "things fail at once,\n"
      "and applies the fewest, cheapest adaptations that bring the robot back."};
  app.name("culprit");
  app.set_version_flag("--version", "culprit " + version);
  const auto add_commands = [&](int& exit_code) {
    add_all(app, version, exit_code);
    app.footer(examples_of(culprit_manual()));  // commands that come later would have it, too
  };
  return run_program(app, add_commands, argc, argv);
}

}  // namespace culprit::cli
