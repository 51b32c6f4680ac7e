#include "exemplars/node_command_line.h"

#include <CLI/CLI.hpp>

namespace culprit {

std::optional<NodeArguments> parse(const NodeCommandLine& line, int argc, char** argv,
                                   int& exit_code) {
  NodeArguments given;
  CLI::App app(line.about);
  app.add_option("name", given.name, "Which one")->required()->check(CLI::IsMember(line.names));
  app.add_option("--speed", given.speed, "Robot seconds in a second, 1 unless given")
      ->envname(line.environment + "_SPEED")
      ->check(CLI::Range(0.01, 100.0));
  app.add_option("--seed", given.seed, "Of the " + line.seed_of + ", 1 unless given")
      ->envname(line.environment + "_SEED");
  if (!line.choices.empty()) given.option = line.choices.front();
  CLI::Option* own = app.add_option("--" + line.option, given.option, line.option_help);
  own->envname(line.option_environment);
  if (!line.choices.empty()) own->check(CLI::IsMember(line.choices))->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    exit_code = app.exit(error);
    return std::nullopt;
  }
  return given;
}

}  // namespace culprit
