#include "terminal/listed.h"

namespace culprit {
namespace {

bool is_listed(const CLI::App* command) { return !command->get_group().empty(); }

}  // namespace

std::vector<const CLI::App*> commands_in(const CLI::App& app) {
  return app.get_subcommands(is_listed);
}

const CLI::App* command_named(const CLI::App& app, const std::string& name) {
  const auto all = app.get_subcommands(
      [&](const CLI::App* command) { return !name.empty() && command->check_name(name); });
  return all.empty() ? nullptr : all.front();
}

std::vector<const CLI::Option*> options_in(const CLI::App& command) {
  return command.get_options([&command](const CLI::Option* option) {
    return !option->get_group().empty() && option != command.get_help_ptr();
  });
}

}  // namespace culprit
