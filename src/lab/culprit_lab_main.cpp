#include "demo/demo_command.h"
#ifdef CULPRIT_STUDIES
#include "laboratory/commands.h"
#endif
#include "terminal/manual.h"
#include "terminal/program.h"

namespace {

using namespace culprit;

const Manual kManual{
    .name = "culprit-lab",
    .purpose = "the laboratory of culprit",
    .description = {"Demonstrations on live exemplars, studies on models of them and on random "
                    "robots, and torture. "
                    "`culprit demo`, `culprit study` and `culprit torture` start it."},
    .files = {{"~/.local/state/culprit", "What demonstrations and studies leave behind."}},
    .environment = {},
    .examples = {{"culprit-lab demo", "A robot of real processes is broken and healed."},
                 {"culprit-lab study sunset", "The paper's tables beside ours."},
                 {"culprit-lab torture --seeds 100", "Random robots with everything going wrong."}},
    .see_also = "culprit(1)"};

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "culprit's laboratory: demonstrations on live exemplars, studies on models of them and on "
      "random robots,\n"
      "and torture. `culprit demo`, `culprit study` and `culprit torture` start it."};
  app.name("culprit-lab");
  app.set_version_flag("--version", "culprit-lab " CULPRIT_VERSION);
  return run_program(
      app,
      [&](int& exit_code) {
        lab::add_demo(app, exit_code);
#ifdef CULPRIT_STUDIES
        lab::add_study(app, CULPRIT_VERSION, exit_code);
        lab::add_torture(app, exit_code);
        lab::add_play_again(app, exit_code);
#endif
        for (CLI::App* command : app.get_subcommands({})) {
          // The page of culprit calls that one.
          command->group(command->get_name() == "play-again" ? "" : "Commands");
        }
        add_manual(app, kManual, exit_code);
        app.footer(examples_of(kManual));
      },
      argc, argv);
}
