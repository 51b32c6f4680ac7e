#include "demo/demo_command.h"
#include "demo/lab_program.h"
#ifdef CULPRIT_STUDIES
#include "laboratory/commands.h"
#endif

int main(int argc, char** argv) {
  using namespace culprit;
  const auto add_commands = [](CLI::App& app, int& exit_code) {
    lab::add_demo(app, exit_code);
#ifdef CULPRIT_STUDIES
    lab::add_study(app, CULPRIT_VERSION, exit_code);
    lab::add_torture(app, exit_code);
    lab::add_play_again(app, exit_code);
#endif
  };
  return lab::run_culprit_lab(CULPRIT_VERSION, add_commands, argc, argv);
}
