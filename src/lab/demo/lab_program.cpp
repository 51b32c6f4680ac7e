#include "demo/lab_program.h"

#include <CLI/CLI.hpp>

#include "terminal/help.h"
#include "terminal/manual.h"
#include "terminal/program.h"

namespace culprit::lab {
namespace {

const Manual kManual{
    .name = "culprit-lab",
    .purpose = "the laboratory of culprit",
    .description = {"Demonstrations on live exemplars, studies on models of them and on random "
                    "robots, and torture. "
                    "`culprit demo`, `culprit study` and `culprit torture` start it."},
    .files = {{"~/.local/state/culprit", "The data of demonstrations and studies."}},
    .environment = {},
    .examples = {{"culprit-lab demo", "A robot of real processes is broken and healed."},
                 {"culprit-lab study sunset", "The paper's tables beside ours."},
                 {"culprit-lab torture --seeds 100", "Random robots with all kinds of faults."}},
    .see_also = "culprit(1)"};

}  // namespace

int run_culprit_lab(const std::string& version,
                    const std::function<void(CLI::App& app, int& exit_code)>& add_commands,
                    int argc, char** argv) {
  CLI::App app{
      "culprit's laboratory: demonstrations on live exemplars, studies on models of them and on "
      "random robots,\n"
      "and torture. `culprit demo`, `culprit study` and `culprit torture` start it."};
  app.name("culprit-lab");
  app.set_version_flag("--version", "culprit-lab " + version);
  const auto add = [&](int& exit_code) {
    add_commands(app, exit_code);
    add_help(app, exit_code);
    for (CLI::App* command : app.get_subcommands({})) {
      // The page of culprit calls that one.
      command->group(command->get_name() == "play-again" ? "" : "Commands");
    }
    add_manual(app, kManual, exit_code);
    app.footer(examples_of(kManual));
  };
  return run_program(app, add, argc, argv);
}

}  // namespace culprit::lab
