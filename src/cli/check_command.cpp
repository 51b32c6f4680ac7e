#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>
#include <string_view>
#include <system_error>
#include <unistd.h>

#include <fmt/core.h>

#include "base/amount.h"
#include "base/text_file.h"
#include "cli/check_bag.h"
#include "cli/commands.h"
#include "cli/diagnostic_report.h"
#include "cli/heap_room.h"
#include "live/preflight.h"
#include "live/robot_survey.h"
#include "live/setups.h"
#include "live_checks/live_checks.h"
#include "live_checks/live_findings.h"
#include "ros2/options.h"
#include "rule_files/rule_files.h"
#include "terminal/console.h"
#include "terminal/program.h"
#include "terminal/seconds_option.h"

namespace culprit::cli {
namespace {

// Files of so many bytes, thousands of rules, are worth some care for memory.
constexpr std::size_t kLarge = std::size_t{1} << 20;

struct CheckOptions {
  std::vector<std::string> files;
  std::string format = "text";
  bool strict = false;
  bool robot = false;
  BagCheck recorded;
  bool fixes = false;
  std::string fail_on = "error";
  double wait_seconds = 3;
};

std::ptrdiff_t own_templates(const Expansion& file) {
  return std::ranges::count_if(file.templates,
                               [](const auto& each) { return each.second.name.file == 0; });
}

// For people: mistakes go to stderr, a line for each good file to stdout.
void print_text(const Expansion& file, const Checked& checked) {
  fmt::print(stderr, "{}", render(checked.diagnostics, file.source, colour_of(STDERR_FILENO)));
  if (!checked.rules) {
    fmt::print(stderr, "culprit: {} has errors\n", file.source.name());
    return;
  }
  const RuleSet& rules = *checked.rules;
  const auto own = own_templates(file);
  const std::string templates =
      own > 0 ? ", " + amount_of(static_cast<std::size_t>(own), "template") : "";
  const auto warnings = static_cast<std::size_t>(
      std::ranges::count(checked.diagnostics, Severity::kWarning, &Diagnostic::severity));
  fmt::print("{}: {}, {}, {}{}: {}\n", file.source.name(), amount_of(rules.rules.size(), "rule"),
             amount_of(rules.strategies.size(), "strategy", "strategies"),
             amount_of(rules.components.size(), "component"), templates,
             warnings > 0 ? amount_of(warnings, "warning") : "ok");
}

void print_findings(const RuleSet& rules, const LiveInventory& robot) {
  for (const std::string& line : live_checks::findings(rules, robot)) fmt::print("  {}\n", line);
}

// Looks up the robot's names that the files refer to. An error says why they are not compared.
Expected<LiveInventory> look(const std::vector<Expansion>& files, Duration wait) {
  std::vector<Checked> checked;
  for (const Expansion& file : files) checked.push_back(check(file));
  std::vector<const RuleSet*> named;
  for (const Checked& each : checked) {
    if (each.rules) named.push_back(&*each.rules);
  }
  if (named.empty()) return Error{"no file without errors is left to be compared with the robot"};
  auto survey = live::open_survey();
  if (!survey) return Error{survey.error()};
  LiveInventory robot = live::look_for(named, **survey, wait);
  if (!robot.has_robot())
    return Error{live::no_nodes_on(ros2::options_from_environment()->domain) +
                 " The rules were not compared with a robot"};
  return robot;
}

// Launch commands that could not run on this computer. If it has none of their programs, it is most
// likely not the robot's: then only one of them is reported.
void check_launches(const Expansion& file, Checked& checked) {
  const RuleSet& rules = *checked.rules;
  auto troubles = live::launch_troubles(rules);
  const auto launches = std::ranges::count_if(
      rules.components, [](const Component& each) { return !each.launch.empty(); });
  const bool is_elsewhere = std::ssize(troubles) == launches;
  // A word that only a shell understands was reported.
  std::set<std::uint32_t> places;
  for (const Diagnostic& d : checked.diagnostics) {
    if (d.code == Code::kNoShell) places.insert(d.span.begin);
  }
  std::set<std::string_view> reported;  // components
  for (const syntax::Component& each : checked.file.components) {
    if (each.launch && places.contains(each.launch->span.begin)) reported.insert(each.name.text);
  }
  std::erase_if(troubles, [&](const LiveInventory::LaunchTrouble& trouble) {
    return reported.contains(trouble.component);
  });
  if (troubles.empty()) return;
  if (is_elsewhere) {
    fmt::print(stderr,
               "culprit: {}: {} could be started on this computer: {}; check it on the robot's\n",
               file.source.name(),
               launches == 1 ? "no component with a LAUNCH"
                             : fmt::format("none of its {} components with a LAUNCH", launches),
               troubles.front().why);
    return;
  }
  for (Diagnostic& d : live_checks::cannot_launch(checked.file, rules, troubles))
    checked.diagnostics.push_back(std::move(d));
  std::stable_sort(
      checked.diagnostics.begin(), checked.diagnostics.end(),
      [](const Diagnostic& a, const Diagnostic& b) { return a.span.begin < b.span.begin; });
}

// An empty file is most likely the wrong one. One that others include may have declarations only.
void check_emptiness(const Expansion& file, Checked& checked) {
  const bool has_something = !checked.rules->rules.empty() || !checked.rules->components.empty() ||
                             !checked.file.constants.empty() || !checked.file.signals.empty() ||
                             own_templates(file) > 0;
  if (has_something) return;
  checked.diagnostics.push_back({Code::kIncomplete, Severity::kWarning, Span{},
                                 "this file has no rule",
                                 "culprit init -o my.rules drafts rules from the robot"});
}

int check_all(std::vector<Expansion> all, int exit_code, const CheckOptions& options) {
  const Strictness strictness = options.strict ? Strictness::kStrict : Strictness::kLenient;
  std::optional<LiveInventory> robot;
  std::string uncompared;  // why
  if (options.robot) {
    auto seen = look(all, from_seconds(options.wait_seconds));
    if (seen) {
      robot = std::move(*seen);
    } else {
      uncompared = seen.error();
    }
  }
  const bool is_any_large = std::ranges::any_of(
      all, [](const Expansion& file) { return file.source.text().size() >= kLarge; });
  std::vector<CheckedFile> files;
  Checked checked;
  for (Expansion& file : all) {
    checked = {};  // so that there are never two
    checked =
        robot ? live_checks::check_against(*robot, file, strictness) : check(file, strictness);
    if (!checked.rules) exit_code = kFailed;
    if (!robot && checked.rules) check_launches(file, checked);
    if (checked.rules) check_emptiness(file, checked);
    if (options.fail_on == "warning" && !checked.diagnostics.empty()) exit_code = kFailed;
    if (options.format == "text") {
      if (robot && checked.rules) print_findings(*checked.rules, *robot);
      print_text(file, checked);
      if (!options.recorded.bags.empty() && checked.rules) {
        const int judged = check_against_bags(file.source.name(), *checked.rules, options.recorded);
        if (exit_code == kOk || judged == kFailed) exit_code = judged;
      }
    } else {
      files.push_back({std::move(file.source), std::move(checked.diagnostics)});
    }
  }
  if (options.format == "json") fmt::print("{}\n", to_text(json_report(files)));
  if (options.format == "sarif") fmt::print("{}\n", to_text(sarif_report(files)));
  if (!uncompared.empty()) exit_code = fail(uncompared);  // behind the mistakes
  // With a robot DDS was there, which ends as it wants to.
  if (is_any_large && !options.robot) end_program(exit_code);
  return exit_code;
}

// Rules take some twenty times the room of their text.
void make_room(const std::vector<std::string>& files) {
  std::uintmax_t largest = 0;
  for (const std::string& file : files) {
    std::error_code error;
    if (const auto size = std::filesystem::file_size(file, error); !error)
      largest = std::max(largest, size);
  }
  if (largest >= kLarge)
    make_heap_room(20 *
                   static_cast<std::size_t>(std::min<std::uintmax_t>(largest, Source::kMaxSize)));
}

// The edits that the diagnostics of `file` offer, none of which touches another, the last one first.
std::vector<Edit> edits_of(const Expansion& file, Strictness strictness) {
  std::vector<Edit> edits;
  for (const Diagnostic& d : check(file, strictness).diagnostics) {
    const LocatedDiagnostic here = located(d, file.source);
    if (here.fix && here.place.file == 0) edits.push_back(*here.fix);
  }
  std::stable_sort(edits.begin(), edits.end(),
                   [](const Edit& a, const Edit& b) { return a.span.begin < b.span.begin; });
  std::uint32_t end = 0;
  bool is_first = true;
  std::erase_if(edits, [&](const Edit& edit) {
    const bool touches = !is_first && edit.span.begin <= end;
    if (!touches) end = edit.span.end;
    is_first = false;
    return touches;
  });
  std::reverse(edits.begin(), edits.end());
  return edits;
}

// Applies the fixes of the language server until there are none. Errors: the file cannot be read or
// written.
Expected<Expansion> fixed(const std::string& path, Expansion rules, const CheckOptions& options) {
  constexpr int kMostRounds = 20;  // a fix may make room for the next
  const Strictness strictness = options.strict ? Strictness::kStrict : Strictness::kLenient;
  for (int round = 0; round < kMostRounds; ++round) {
    const auto edits = edits_of(rules, strictness);
    if (edits.empty()) break;
    const Source& written = rules.source.file(0);
    std::string text(written.text());
    for (const Edit& edit : edits)
      text.replace(edit.span.begin, edit.span.end - edit.span.begin, edit.text);
    for (auto edit = edits.rbegin(); edit != edits.rend(); ++edit) {
      const Position at = written.position(edit->span.begin);
      fmt::print("{}:{}:{}: {}\n", path, at.line, at.column, title_of(*edit, written));
    }
    if (const auto done = write_text(path, text); !done) return Error{done.error()};
    auto again = rule_files::read(path);
    if (!again) return again;
    rules = std::move(*again);
  }
  return rules;
}

int check_files(const CheckOptions& options) {
  const auto robot = ros2::options_from_environment();
  if (options.robot && !robot) return fail(robot.error(), kUsage);
  int exit_code = kOk;
  std::vector<Expansion> all;
  for (const std::string& path : options.files) {
    const auto files = rule_files::files_in(path, ".rules");
    if (!files) exit_code = fail(files.error());
    if (files) make_room(*files);
    for (const std::string& file : files ? *files : std::vector<std::string>{}) {
      auto rules = rule_files::read(file);
      if (rules && options.fixes) rules = fixed(file, std::move(*rules), options);
      if (rules) {
        all.push_back(std::move(*rules));
      } else {
        exit_code = fail(rules.error());
      }
    }
  }
  return check_all(std::move(all), exit_code, options);
}

}  // namespace

void add_check(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* command = app.add_subcommand(
      "check", "Check rule files: every mistake with its place, cause and remedy");
  command->add_option("RULES", options->files, "Rule files, and folders of *.rules")
      ->type_name("FILE")
      ->required();
  command->add_flag("--strict", options->strict, "Every component and signal must be declared");
  auto* robot = command->add_flag(
      "--robot", options->robot,
      "Also report nodes, topics, parameters, diagnostics and services that the live robot lacks");
  add_seconds(*command, "--wait", options->wait_seconds, "How long to look at the robot", 0.1, 600)
      ->needs(robot);
  CLI::Option* bags =
      command
          ->add_option("--bag", options->recorded.bags,
                       "Report for each rule whether this recording can judge it; repeatable")
          ->type_name("FILE")
          ->allow_extra_args(false)
          ->excludes(robot);
  command
      ->add_option("--message-path", options->recorded.message_path,
                   "Where message definitions are, beside AMENT_PREFIX_PATH")
      ->type_name("FOLDER")
      ->allow_extra_args(false)
      ->needs(bags);
  command
      ->add_flag("--fix", options->fixes, "Apply the fixes that editors offer, and write the files")
      ->excludes(robot);
  command
      ->add_option("--fail-on", options->fail_on,
                   "Least severity that makes the command fail: error or warning")
      ->check(CLI::IsMember({"error", "warning"}))
      ->capture_default_str();
  command
      ->add_option("--format", options->format,
                   "text for people; json or sarif (2.1.0) for programs, on stdout")
      ->check(CLI::IsMember({"text", "json", "sarif"}))
      ->capture_default_str();
  command
      ->add_flag_function(
          "--json", [options](std::int64_t) { options->format = "json"; },
          "The same as --format json")
      ->excludes(command->get_option("--format"));
  bags->excludes(command->get_option("--format"))->excludes(command->get_option("--json"));
  command->callback([options, &exit_code] { exit_code = check_files(*options); });
}

}  // namespace culprit::cli
