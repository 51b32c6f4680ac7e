#include <filesystem>
#include <future>
#include <memory>
#include <unistd.h>

#include <fmt/core.h>

#include "cli/commands.h"
#include "cli/diagnostic_report.h"
#include "live/live_robot.h"
#include "live/preflight.h"
#include "live/robot_survey.h"
#include "live/rule_file.h"
#include "manager/manager.h"
#include "manager/runtime.h"
#include "plan/passive_planner.h"
#include "rule_test/plan_report.h"
#include "rule_test/state.h"
#include "terminal/console.h"
#include "terminal/planner_options.h"
#include "terminal/seconds_option.h"

namespace culprit::cli {
namespace {

struct PlanOptions {
  std::string rules;
  std::string state;  // empty: the live robot's
  std::string format = "text";
  double settle_seconds = seconds(Manager::kDiscovery);
  std::vector<std::filesystem::path> message_path;
  PlannerOptions planner;
};

void print(const rule_test::PlanReport& report, const PlanOptions& options) {
  if (options.format == "json") {
    fmt::print("{}\n", to_text(rule_test::plan_as_json(report)));
  } else {
    fmt::print("{}", rule_test::plan_as_text(report));
  }
}

int plan_for_state(const RuleSet& rules, const PlanOptions& options) {
  const auto source = Source::read(options.state);
  if (!source) {
    fmt::print(stderr, "culprit: {}\n", source.error());
    return kFailed;
  }
  std::vector<Diagnostic> diagnostics;
  const rule_test::State state = rule_test::read_state(*source, rules, diagnostics);
  fmt::print(stderr, "{}", render(diagnostics, *source, colour_of(STDERR_FILENO)));
  if (!diagnostics.empty()) {
    fmt::print(stderr, "culprit: {} cannot be used\n", options.state);
    return kFailed;
  }
  const rule_test::Watched watched = rule_test::watch(state, rules);
  rule_test::PlanReport report(*options.planner.planner(), watched.failures, *watched.knowledge,
                               watched.held_back);
  if (state.moment) report.now = watched.now;
  print(report, options);
  return kOk;
}

// ---- a live robot

bool all_is_known(const Knowledge& knowledge) {
  for (std::size_t i = 0; i < knowledge.rules.inputs.size(); ++i) {
    const bool matters = !knowledge.rules.inputs[i].readers.empty();
    if (matters && !knowledge.signals[InputId(i)].known) return false;
  }
  return true;
}

// Runs until discovery has settled and all inputs of triggers are known (or as long again has
// passed). Then it runs as long as rules wait before they report a failure.
void watch(Manager& manager, live::LiveRobot& robot, const RuleSet& rules, Duration discovery,
           const std::atomic<bool>& stop) {
  Runtime runtime(manager, robot);
  const Time settled = later(robot.now(), discovery);
  runtime.run(stop, settled);
  for (const Time limit = later(settled, discovery);
       !stop && robot.now() < limit && !all_is_known(manager.knowledge());)
    runtime.run(stop, later(robot.now(), rules.cycle));
  runtime.run(stop, later(robot.now(), longest_detection(rules)));
}

int plan_for_robot(const live::LoadedRules& loaded, const PlanOptions& options) {
  const RuleSet& rules = loaded.rules;
  auto participant = ros2::options_from_environment();
  if (!participant) {
    fmt::print(stderr, "culprit: {}\n", participant.error());
    return kUsage;
  }
  live::LiveRobot::Options robot_options;
  robot_options.link.participant = *participant;
  robot_options.link.name = {"/", "_culprit_plan"};  // hidden, as tools are
  robot_options.link.types = live::sources_of_types(options.message_path);
  StopSignals signals;
  auto robot = live::LiveRobot::open(rules, std::move(robot_options));
  if (!robot) {
    fmt::print(stderr, "culprit: {}\n", robot.error());
    return kFailed;
  }
  signals.on_stop([&] { (*robot)->interrupt(); });

  // It decides nothing, so nothing is asked of the robot.
  Manager::Options manager_options;
  manager_options.start = (*robot)->now();
  manager_options.discovery = from_seconds(options.settle_seconds);
  manager_options.governor = Governor::Options::recommended();
  manager_options.governor.quiet_at_start = Duration::zero();  // the question is about the robot
  Manager manager(rules, std::make_unique<PassivePlanner>(), manager_options);
  fmt::print(stderr, "culprit: watching {} for {:g} s or more; nothing is changed on it\n",
             rules.robot.empty() ? "the robot" : rules.robot,
             seconds(manager_options.discovery + longest_detection(rules)));
  auto preflight = std::async(
      std::launch::async, [&] { return live::take_snapshot(loaded.source, options.message_path); });
  watch(manager, **robot, rules, manager_options.discovery, signals.stopped());
  const bool is_stopped = signals.stopped();
  signals.on_stop({});
  if (is_stopped) {
    fmt::print(stderr, "culprit: stopped before the robot was seen; nothing is planned\n");
    return kFailed;
  }
  const auto seen = preflight.get();
  if (seen) fmt::print(stderr, "{}", seen->report);
  if (seen && !seen->has_robot) {
    fmt::print(stderr,
               "culprit: nothing is planned; --state FILE takes the robot's state from a file\n");
    return kFailed;
  }
  rule_test::PlanReport report(*options.planner.planner(), manager.plannable(), manager.knowledge(),
                               manager.held_back());
  report.now = (*robot)->now();
  print(report, options);
  return kOk;
}

int plan(const PlanOptions& options) {
  const auto loaded =
      live::read_rules(options.rules, Strictness::kLenient, colour_of(STDERR_FILENO));
  if (!loaded) return fail(loaded.error());
  fmt::print(stderr, "{}", loaded->remarks);
  return options.state.empty() ? plan_for_robot(*loaded, options)
                               : plan_for_state(loaded->rules, options);
}

}  // namespace

void add_plan(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<PlanOptions>();
  CLI::App* command = app.add_subcommand(
      "plan", "Show the decision that would be made now, its reasons, and what would change it");
  command->add_option("RULES", options->rules, "The rule file")->type_name("FILE")->required();
  auto* robot = command->add_flag_function(
      "--robot", [](std::int64_t) {},
      "Watch the live robot for a moment, without changing it (default)");
  command
      ->add_option("--state", options->state,
                   "Take the robot's state from this file instead (docs/plan.md)")
      ->type_name("FILE")
      ->excludes(robot);
  command->add_option("--format", options->format, "text for people, json for programs")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
  command->add_flag_function(
      "--json", [options](std::int64_t) { options->format = "json"; }, "The same as --format json");
  add_seconds(*command, "--settle", options->settle_seconds,
              "Without --state: grace period for discovery", 0, 3600);
  command
      ->add_option("--message-path", options->message_path,
                   "Folders with .msg files: <folder>/<package>/msg/<Type>.msg")
      ->type_name("FOLDER");
  options->planner.add_to(*command);
  command->callback([options, &exit_code] { exit_code = plan(*options); });
}

}  // namespace culprit::cli
