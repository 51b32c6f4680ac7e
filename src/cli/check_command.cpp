#include <memory>

#include <fmt/core.h>

#include "cli/commands.h"
#include "cli/rule_file.h"

namespace culprit::cli {
namespace {

struct CheckOptions {
  std::vector<std::string> files;
  bool strict = false;
};

int check_files(const CheckOptions& options) {
  int exit_code = kOk;
  for (const std::string& file : options.files) {
    const auto rules =
        load_rules(file, options.strict ? Strictness::kStrict : Strictness::kLenient);
    if (rules == nullptr) {
      exit_code = kFailed;
      continue;
    }
    fmt::print("{}: {} rules, {} strategies, {} components: ok\n", file, rules->rules.size(),
               rules->strategies.size(), rules->components.size());
  }
  return exit_code;
}

}  // namespace

void add_check(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* command = app.add_subcommand(
      "check", "Check rule files: every mistake with its place, cause and remedy");
  command->add_option("RULES", options->files, "Rule files")->required();
  command->add_flag("--strict", options->strict, "Every component and signal must be declared");
  command->callback([options, &exit_code] { exit_code = check_files(*options); });
}

}  // namespace culprit::cli
