#include "demo/demo_command.h"
#ifdef CULPRIT_STUDIES
#include "laboratory/commands.h"
#endif
#include "terminal/program.h"

int main(int argc, char** argv) {
  using namespace culprit;
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
      },
      argc, argv);
}
