#include <csignal>

#include "base/joined.h"
#include "base/text_file.h"
#include "cli/commands.h"
#include "mode_manager/mode_manager.h"
#include "modes/read_model.h"
#include "terminal/console.h"

namespace culprit::cli {
namespace {

struct ModesOptions {
  std::string model;
  bool only_checks = false;
};

void print(const modes::Model& model) {
  for (const modes::Entity& entity : model.entities) {
    say(stdout, "{:<6}  {}: {}\n", entity.is_system ? "system" : "node", entity.name,
        joined(entity.modes, ", ", &modes::Mode::name));
  }
}

std::string described(const modes::Actual& actual) {
  const std::string state(ros2::label_of(actual.state));
  return actual.mode.empty() ? state : state + "." + actual.mode;
}

int serve(const modes::Model& model, const std::string& file) {
  ros2::Executor executor;
  if (auto stops = executor.stop_on({SIGINT, SIGTERM}); !stops) return fail(stops.error());
  const auto participant = ros2::options_from_environment();
  if (!participant) return fail(participant.error(), kUsage);
  mode_manager::ModeManager::Options options;
  options.participant = *participant;
  options.model_file = file;
  options.on_change = [](const modes::Inference::Change& change) {
    say(stdout, "{}  {} -> {}\n", change.entity->name, described(change.before),
        described(change.now));
  };
  options.on_trouble = [](const std::string& text) { say(stdout, "{}\n", text); };
  const auto manager = mode_manager::ModeManager::create(executor, model, std::move(options));
  if (!manager) return fail(manager.error());
  ::signal(SIGPIPE, SIG_IGN);  // as in StopSignals
  say(stdout, "culprit: /__mode_manager serves {} systems and nodes; Ctrl-C ends it\n",
      model.entities.size());
  executor.run();
  return kOk;
}

int manage(const ModesOptions& options) {
  const auto text = read_text(options.model);
  if (!text) return fail(text.error());
  const auto model = modes::read_model(options.model, *text);
  if (!model) return fail(model.error());
  if (!options.only_checks) return serve(*model, options.model);
  print(*model);
  return kOk;
}

}  // namespace

void add_modes(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<ModesOptions>();
  CLI::App* command = app.add_subcommand(
      "modes",
      "Manage the modes of a robot's systems and nodes, in place of system_modes' mode_manager.\n"
      "Offers change_mode, get_mode and get_available_modes for each, until Ctrl-C.");
  command->add_option("MODEL", options->model, "The model file, as system_modes reads it (YAML)")
      ->type_name("FILE")
      ->required();
  command->add_flag("--check", options->only_checks, "Read the model, list its modes, and end");
  command->callback([options, &exit_code] { exit_code = manage(*options); });
}

}  // namespace culprit::cli
