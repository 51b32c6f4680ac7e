#include <cerrno>
#include <cstring>
#include <unistd.h>

#include "base/environment.h"
#include "cli/commands.h"
#include "cli/culprit_manual.h"
#include "terminal/program.h"

namespace {

using namespace culprit;

// In place of this program. Comes back only if that is impossible.
int become_laboratory(char** argv) {
  const auto laboratory = find_laboratory();
  if (!laboratory) return fail(laboratory.error());
  execv(laboratory->c_str(), argv);
  return fail("cannot start " + laboratory->string() + ": " + std::strerror(errno));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && cli::is_of_laboratory(argv[1])) return become_laboratory(argv);
  CLI::App app{
      "culprit keeps ROS 2 robots working: it finds the component that is responsible when many "
      "things fail at once,\n"
      "and applies the fewest, cheapest adaptations that bring the robot back."};
  app.name("culprit");
  app.set_version_flag("--version", "culprit " CULPRIT_VERSION);
  const auto add_commands = [&](int& exit_code) {
    cli::add_all(app, CULPRIT_VERSION, exit_code);
    app.footer(examples_of(cli::culprit_manual()));  // commands that come later would have it, too
  };
  return run_program(app, add_commands, argc, argv);
}
