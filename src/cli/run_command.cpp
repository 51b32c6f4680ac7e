#include <filesystem>
#include <unistd.h>

#include <fmt/core.h>

#include "cli/commands.h"
#include "cli/console.h"
#include "cli/health.h"
#include "cli/live_robot.h"
#include "cli/paths.h"
#include "cli/planner_options.h"
#include "cli/rule_file.h"
#include "cli/web_service.h"
#include "cli/what_if_route.h"
#include "knowledge/describe.h"
#include "manager/manager.h"
#include "manager/runtime.h"
#include "web/live_routes.h"
#include "web/order_routes.h"
#include "web/rule_routes.h"
#include "web/watched_manager.h"

namespace culprit::cli {
namespace {

struct RunOptions {
  std::string rules;
  bool dry_run = false;
  bool launch = false;
  PlannerOptions planner;
  double forgetting = 1;
  double settle_seconds = seconds(Manager::kDiscovery);
  std::string state_folder;
  std::vector<std::filesystem::path> message_path;
  bool is_on_web = false;
  WebOptions web;
};

ros2::Severity severity_of(const Event& event) {
  if (std::holds_alternative<RuleExhausted>(event.what)) return ros2::Severity::kError;
  const bool is_bad = std::holds_alternative<FailureDetected>(event.what) ||
                      std::holds_alternative<StrategyFailed>(event.what) ||
                      std::holds_alternative<ComponentLost>(event.what) ||
                      std::holds_alternative<AdaptationFailed>(event.what) ||
                      std::holds_alternative<Trouble>(event.what);
  return is_bad ? ros2::Severity::kWarn : ros2::Severity::kInfo;
}

Expected<LiveRobot::Options> robot_options(const RunOptions& options) {
  auto participant = ros2::options_from_environment();
  if (!participant) return Error{participant.error()};
  const auto state = options.state_folder.empty() ? default_state_folder()
                                                  : std::filesystem::path(options.state_folder);
  LiveRobot::Options out;
  out.link.participant = *participant;
  out.link.message_path =
      ros2::message_directories(options.message_path, environment("AMENT_PREFIX_PATH"));
  out.link.parameters = {{"rules", Value(options.rules)},
                         {"planner", Value(options.planner.name)},
                         {"dry_run", Value(options.dry_run)}};
  out.supervisor = {state / "log", {own_folder()}};
  return out;
}

// Looks at what is there, so that what runs already is not started again.
std::vector<Observation> discover(LiveRobot& robot, const std::atomic<bool>& stop) {
  constexpr Duration kLook = std::chrono::seconds(3);
  std::vector<Observation> seen;
  for (const Time end = robot.now() + kLook; robot.now() < end && !stop;) robot.observe(end, seen);
  return seen;
}

void launch_missing(LiveRobot& robot, const RuleSet& rules, const std::vector<Observation>& seen) {
  ComponentBinding binding(rules);
  std::vector<bool> is_there(rules.components.size());
  for (const Observation& o : seen) {
    if (const auto* node = std::get_if<NodeAppeared>(&o.what)) {
      if (const auto component = binding.bind(node->node)) is_there[component->index] = true;
    }
  }
  for (std::size_t c = 0; c < rules.components.size(); ++c) {
    if (is_there[c] || rules.components[c].launch.empty()) continue;
    fmt::print("starting {}\n", rules.components[c].name);
    robot.supervisor().start({}, ComponentId(c));
  }
}

std::vector<web::Route> web_routes(web::Hub& hub, web::RuleDesk& desk, const RuleSet& rules,
                                   Runtime& runtime, PlannerFactory planner) {
  std::vector<web::Route> routes = web::live_routes(hub);
  const auto submit = [&runtime](Order order) { runtime.submit(std::move(order)); };
  for (web::Route& route : web::order_routes(rules, submit)) routes.push_back(std::move(route));
  for (web::Route& route : web::rule_routes(desk)) routes.push_back(std::move(route));
  routes.push_back(what_if_route(std::move(planner)));
  return routes;
}

int run(const RunOptions& options) {
  const auto rules = load_rules(options.rules);
  if (rules == nullptr) return kFailed;
  auto robot_setup = robot_options(options);
  if (!robot_setup) {
    fmt::print(stderr, "culprit: {}\n", robot_setup.error());
    return kUsage;
  }
  StopSignals signals;
  auto robot = LiveRobot::open(*rules, std::move(*robot_setup));
  if (!robot) {
    fmt::print(stderr, "culprit: {}\n", robot.error());
    return kFailed;
  }
  signals.on_stop([&] { (*robot)->interrupt(); });
  fmt::print("culprit: watching {} with {} rules{}; Ctrl-C ends it and leaves the robot as it is\n",
             rules->robot.empty() ? "the robot" : rules->robot, rules->rules.size(),
             options.dry_run ? " (dry run)" : "");
  std::fflush(stdout);

  std::vector<Observation> seen;
  if (options.launch) {
    seen = discover(**robot, signals.stopped());
    launch_missing(**robot, *rules, seen);
  }
  Manager::Options manager_options;
  manager_options.autonomy = options.dry_run ? Autonomy::kAdvise : Autonomy::kAct;
  manager_options.start = (*robot)->now();
  manager_options.settling = from_seconds(options.settle_seconds);
  manager_options.forgetting = options.forgetting;
  Manager manager(*rules, options.planner.planner(), manager_options);

  web::Hub hub([&] { (*robot)->interrupt(); });
  web::WatchedManager watched(manager, hub, manager_options.start);
  Runtime runtime(watched, **robot);
  web::RuleDesk desk(options.rules);
  Expected<std::unique_ptr<web::Server>> server(nullptr);
  if (options.is_on_web) {
    server =
        serve(options.web, web_routes(hub, desk, *rules, runtime, options.planner.factory()), &hub);
    if (!server) {
      fmt::print(stderr, "culprit: {}\n", server.error());
      return kUsage;
    }
  }

  const Colour colour = colour_of(STDOUT_FILENO);
  runtime.on_events = [&](std::span<const Event> events) {
    for (const Event& event : events) {
      const std::string text = line(event, *rules, manager_options.start, colour);
      if (text.empty()) continue;
      fmt::print("{}\n", text);
      (*robot)->link().log(severity_of(event), describe(event, *rules));
    }
    std::fflush(stdout);
    (*robot)->link().publish(health(manager.knowledge()));
  };
  (*robot)->link().publish(health(manager.knowledge()));
  for (const Command& command : watched.step((*robot)->now(), seen)) (*robot)->execute(command);
  if (!manager.events().empty()) runtime.on_events(manager.events());
  runtime.run(signals.stopped());
  signals.on_stop({});
  fmt::print("culprit: stopped; the robot goes on as it is\n");
  return kOk;
}

}  // namespace

void add_run(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command =
      app.add_subcommand("run",
                         "Watch a live robot and heal it until Ctrl-C.\nJoins the DDS domain that "
                         "ROS_DOMAIN_ID and ROS_LOCALHOST_ONLY name.");
  command->add_option("RULES", options->rules, "The rule file")->required();
  command->add_flag("--dry-run", options->dry_run, "Say what would be done, and do nothing");
  command->add_flag("--launch", options->launch,
                    "Start components that are missing, by their LAUNCH commands");
  command
      ->add_option("--settle", options->settle_seconds,
                   "For so many seconds, nothing is called missing because it was not seen")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  command->add_option("--state-dir", options->state_folder, "Where logs of started components go")
      ->default_str("~/.local/state/culprit");
  command->add_option("--message-path", options->message_path,
                      "Folders with .msg files: <folder>/<package>/msg/<Type>.msg");
  command
      ->add_option("--forgetting", options->forgetting,
                   "What was learned n outcomes ago weighs this to the n-th power; 1: nothing is "
                   "forgotten")
      ->check(CLI::Range(0.5, 1.0))
      ->capture_default_str();
  options->planner.add_to(*command);
  command->add_flag("--web", options->is_on_web,
                    "Show in a browser what is seen, decided and done");
  options->web.add_to(*command);
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace culprit::cli
