#include <algorithm>
#include <memory>
#include <unistd.h>

#include <fmt/core.h>

#include "cli/commands.h"
#include "cli/diagnostic_report.h"
#include "language/live_checks.h"
#include "language/live_findings.h"
#include "live/preflight.h"
#include "live/robot_survey.h"
#include "terminal/console.h"
#include "terminal/seconds_option.h"

namespace culprit::cli {
namespace {

struct CheckOptions {
  std::vector<std::string> files;
  std::string format = "text";
  bool strict = false;
  bool robot = false;
  double wait_seconds = 3;
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

void print_findings(const RuleSet& rules, const LiveInventory& robot) {
  for (const std::string& line : findings(rules, robot)) fmt::print("  {}\n", line);
}

// What the robot has, of what the files name.
Expected<LiveInventory> look(const std::vector<Source>& sources, Duration wait) {
  std::vector<Checked> checked;
  for (const Source& source : sources) checked.push_back(check(source));
  std::vector<const RuleSet*> named;
  for (const Checked& each : checked) {
    if (each.rules) named.push_back(&*each.rules);
  }
  auto survey = live::open_survey();
  if (!survey) return Error{survey.error()};
  LiveInventory robot = live::look_for(named, **survey, wait);
  if (!robot.has_robot())
    return Error{live::nobody_on(ros2::options_from_environment()->domain) +
                 " Nothing was checked against them"};
  return robot;
}

int check_sources(std::vector<Source> sources, const CheckOptions& options) {
  const Strictness strictness = options.strict ? Strictness::kStrict : Strictness::kLenient;
  std::optional<LiveInventory> robot;
  if (options.robot) {
    auto seen = look(sources, from_seconds(options.wait_seconds));
    if (!seen) {
      fmt::print(stderr, "culprit: {}\n", seen.error());
      return kFailed;
    }
    robot = std::move(*seen);
  }
  int exit_code = kOk;
  std::vector<CheckedFile> files;
  for (Source& source : sources) {
    Checked checked = robot ? check_against(*robot, source, strictness) : check(source, strictness);
    if (!checked.rules) exit_code = kFailed;
    if (options.format == "text") {
      if (robot && checked.rules) print_findings(*checked.rules, *robot);
      print_text(source, checked);
    } else {
      files.push_back({std::move(source), std::move(checked.diagnostics)});
    }
  }
  if (options.format == "json") fmt::print("{}\n", to_text(json_report(files)));
  if (options.format == "sarif") fmt::print("{}\n", to_text(sarif_report(files)));
  return exit_code;
}

int check_files(const CheckOptions& options) {
  int exit_code = kOk;
  std::vector<Source> sources;
  for (const std::string& path : options.files) {
    auto source = Source::read(path);
    if (source) {
      sources.push_back(std::move(*source));
    } else {
      fmt::print(stderr, "culprit: {}\n", source.error());
      exit_code = kFailed;
    }
  }
  return std::max(exit_code, check_sources(std::move(sources), options));
}

}  // namespace

void add_check(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* command = app.add_subcommand(
      "check", "Check rule files: every mistake with its place, cause and remedy");
  command->add_option("RULES", options->files, "Rule files")->required();
  command->add_flag("--strict", options->strict, "Every component and signal must be declared");
  auto* robot = command->add_flag(
      "--robot", options->robot,
      "Check also against the live robot: nodes, topics, parameters, diagnostics and services "
      "that it has not");
  add_seconds(*command, "--wait", options->wait_seconds, "How long to look at the robot", 0.1, 600)
      ->needs(robot);
  command
      ->add_option("--format", options->format,
                   "text for people; json or sarif (2.1.0) for programs, on stdout")
      ->check(CLI::IsMember({"text", "json", "sarif"}))
      ->capture_default_str();
  command->callback([options, &exit_code] { exit_code = check_files(*options); });
}

}  // namespace culprit::cli
