#include <memory>
#include <unistd.h>

#include <fmt/core.h>

#include "cli/commands.h"
#include "cli/console.h"
#include "cli/diagnostic_report.h"
#include "language/checker.h"

namespace culprit::cli {
namespace {

struct CheckOptions {
  std::vector<std::string> files;
  std::string format = "text";
  bool strict = false;
};

// For people: what is wrong goes to stderr, a line for each good file to stdout.
void print_text(const Source& source, const Checked& checked) {
  for (const Diagnostic& d : checked.diagnostics)
    fmt::print(stderr, "{}", render(d, source, colour_of(STDERR_FILENO)));
  if (!checked.rules) {
    fmt::print(stderr, "culprit: {} has errors\n", source.name());
    return;
  }
  const RuleSet& rules = *checked.rules;
  fmt::print("{}: {} rules, {} strategies, {} components: ok\n", source.name(), rules.rules.size(),
             rules.strategies.size(), rules.components.size());
}

int check_files(const CheckOptions& options) {
  const Strictness strictness = options.strict ? Strictness::kStrict : Strictness::kLenient;
  int exit_code = kOk;
  std::vector<CheckedFile> files;
  for (const std::string& path : options.files) {
    auto source = Source::read(path);
    if (!source) {
      fmt::print(stderr, "culprit: {}\n", source.error());
      exit_code = kFailed;
      continue;
    }
    Checked checked = check(*source, strictness);
    if (!checked.rules) exit_code = kFailed;
    if (options.format == "text") {
      print_text(*source, checked);
    } else {
      files.push_back({std::move(*source), std::move(checked.diagnostics)});
    }
  }
  if (options.format == "json") fmt::print("{}\n", to_text(json_report(files)));
  if (options.format == "sarif") fmt::print("{}\n", to_text(sarif_report(files)));
  return exit_code;
}

}  // namespace

void add_check(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* command = app.add_subcommand(
      "check", "Check rule files: every mistake with its place, cause and remedy");
  command->add_option("RULES", options->files, "Rule files")->required();
  command->add_flag("--strict", options->strict, "Every component and signal must be declared");
  command
      ->add_option("--format", options->format,
                   "text for people; json or sarif (2.1.0) for programs, on stdout")
      ->check(CLI::IsMember({"text", "json", "sarif"}))
      ->capture_default_str();
  command->callback([options, &exit_code] { exit_code = check_files(*options); });
}

}  // namespace culprit::cli
