#include <filesystem>
#include <unistd.h>

#include <fmt/core.h>

#include "cli/commands.h"
#include "cli/console.h"
#include "cli/governor_options.h"
#include "cli/health.h"
#include "cli/journal_file.h"
#include "cli/live_robot.h"
#include "cli/paths.h"
#include "cli/planner_options.h"
#include "cli/role.h"
#include "cli/rule_file.h"
#include "cli/run_journal.h"
#include "cli/service_manager.h"
#include "cli/web_service.h"
#include "cli/what_if_route.h"
#include "knowledge/describe.h"
#include "manager/manager.h"
#include "manager/runtime.h"
#include "replay/replay.h"
#include "web/live_routes.h"
#include "web/order_routes.h"
#include "web/rule_routes.h"
#include "web/watched_manager.h"

namespace culprit::cli {
namespace {

struct RunOptions {
  std::string version;  // of culprit
  std::string rules;
  bool dry_run = false;
  bool launch = false;
  PlannerOptions planner;
  GovernorOptions governor;
  double forgetting = 1;
  double settle_seconds = seconds(Manager::kDiscovery);
  std::string state_folder;
  std::string journal;
  bool no_journal = false;
  std::vector<std::filesystem::path> message_path;
  bool is_on_web = false;
  WebOptions web;
};

ros2::Severity severity_of(const Event& event) {
  if (std::holds_alternative<RuleExhausted>(event.what) ||
      std::holds_alternative<LastResortReached>(event.what) ||
      std::holds_alternative<StormBegan>(event.what))
    return ros2::Severity::kError;
  const bool is_bad = std::holds_alternative<FailureDetected>(event.what) ||
                      std::holds_alternative<StrategyFailed>(event.what) ||
                      std::holds_alternative<ComponentLost>(event.what) ||
                      std::holds_alternative<AdaptationFailed>(event.what) ||
                      std::holds_alternative<ActionHeldBack>(event.what) ||
                      std::holds_alternative<ApprovalAsked>(event.what) ||
                      std::holds_alternative<StrategyAbandoned>(event.what) ||
                      std::holds_alternative<RivalSeen>(event.what) ||
                      std::holds_alternative<Trouble>(event.what);
  return is_bad ? ros2::Severity::kWarn : ros2::Severity::kInfo;
}

std::filesystem::path state_folder(const RunOptions& options) {
  return options.state_folder.empty() ? default_state_folder()
                                      : std::filesystem::path(options.state_folder);
}

std::filesystem::path journal_file(const RunOptions& options, const RuleSet& rules) {
  return options.journal.empty() ? default_journal(state_folder(options), rules.robot)
                                 : std::filesystem::path(options.journal);
}

Expected<LiveRobot::Options> robot_options(const RunOptions& options, const RuleSet& rules) {
  auto participant = ros2::options_from_environment();
  if (!participant) return Error{participant.error()};
  LiveRobot::Options out;
  out.link.participant = *participant;
  out.link.message_path =
      ros2::message_directories(options.message_path, environment("AMENT_PREFIX_PATH"));
  out.link.parameters = {{"rules", Value(options.rules)},
                         {"planner", Value(options.planner.name)},
                         {"dry_run", Value(options.dry_run)}};
  out.supervisor = {state_folder(options) / "log",
                    {own_folder()},
                    fmt::format("{}/{}", participant->domain, rules.robot)};
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

// The manager and its journal begin from the same record, so that a replay begins from it too.
journal::Session session_of(const RunOptions& options, const RuleSet& rules, bool advises,
                            Time start, const RunBeginning& beginning) {
  journal::Session session;
  session.version = options.version;
  session.robot = rules.robot;
  session.rules_path = options.rules;
  if (const auto source = Source::read(options.rules)) session.rules_text = source->text();
  session.planner = options.planner.to_json();
  session.governor = options.governor.to_json();
  session.advises = advises;
  session.boot = journal::boot_id();
  session.start = start;
  session.settling = from_seconds(options.settle_seconds);
  session.forgetting = options.forgetting;
  session.learned = beginning.learned;
  session.interrupted = beginning.interrupted;
  session.past = journal::to_json(beginning.past, rules);
  session.is_paused = beginning.is_paused;
  session.is_dry_run = beginning.is_dry_run;
  return session;
}

RunBeginning begin_run(const RunOptions& options, const RuleSet& rules, bool is_only_manager) {
  if (options.no_journal || !is_only_manager) return {};
  RunBeginning beginning =
      begin_journal(journal_file(options, rules), rules, {live_now(), wall_now()});
  for (const std::string& finding : beginning.findings) fmt::print("culprit: {}\n", finding);
  return beginning;
}

// Also those that left the graph while nobody looked on, because they were stopped, say.
void adopt_again(LiveRobot& robot, const Past& past) {
  for (const Event& event : past) {
    if (const auto* found = std::get_if<ComponentFound>(&event.what))
      robot.supervisor().adopt_again(found->component, found->pid, event.at);
  }
}

std::unique_ptr<journal::Recorder> record(const RunOptions& options, RunBeginning beginning,
                                          const journal::Session& session, const Manager& manager,
                                          LiveRobot& robot) {
  journal::Recorder::Options recorder;
  recorder.path = journal_file(options, manager.knowledge().rules);
  recorder.wall_clock = wall_now;
  recorder.on_trouble = [&robot](const std::string& what) { robot.report(what); };
  return std::make_unique<journal::Recorder>(std::move(beginning.writer), std::move(recorder),
                                             session, manager.knowledge());
}

// Until it is asked to stop, or the role is another one. Gives the exit code; nothing in the second
// case. Whoever only advises neither acts nor writes the journal.
std::optional<int> run_in_role(const RunOptions& options, const RuleSet& rules,
                               const Governor::Options& governor, LiveRobot::Options robot_setup,
                               RoleOfCulprit& role, StopSignals& signals) {
  const bool is_manager = role.role() == Role::kManage;
  const bool advises = options.dry_run || !is_manager;
  if (!role.reason().empty()) fmt::print("culprit: {}\n", role.reason());
  auto robot = LiveRobot::open(rules, std::move(robot_setup));
  if (!robot) {
    fmt::print(stderr, "culprit: {}\n", robot.error());
    return kFailed;
  }
  signals.on_stop([&] { (*robot)->interrupt(); });
  RunBeginning beginning = begin_run(options, rules, is_manager);
  adopt_again(**robot, beginning.past);
  fmt::print("culprit: watching {} with {} rules{}; Ctrl-C ends it and leaves the robot as it is\n",
             rules.robot.empty() ? "the robot" : rules.robot, rules.rules.size(),
             options.dry_run ? " (dry run)" : "");
  std::fflush(stdout);

  std::vector<Observation> seen;
  if (options.launch && !advises && role.reason().empty()) {
    seen = discover(**robot, signals.stopped());
    launch_missing(**robot, rules, seen);
  }
  const journal::Session session = session_of(options, rules, advises, (*robot)->now(), beginning);
  const auto manager =
      replay::manager_for(session, rules, options.planner.planner(),
                          {advises ? Autonomy::kAdvise : Autonomy::kAct, governor});
  std::unique_ptr<journal::Recorder> recorder;
  if (!options.no_journal && is_manager)
    recorder = record(options, std::move(beginning), session, *manager, **robot);

  web::Hub hub([&] { (*robot)->interrupt(); });
  web::WatchedManager watched(*manager, hub, session.start);
  Runtime runtime(watched, **robot);
  web::RuleDesk desk(options.rules);
  Expected<std::unique_ptr<web::Server>> server(nullptr);
  if (options.is_on_web) {
    server =
        serve(options.web, web_routes(hub, desk, rules, runtime, options.planner.factory()), &hub);
    if (!server) {
      fmt::print(stderr, "culprit: {}\n", server.error());
      return kUsage;
    }
  }

  const Colour colour = colour_of(STDOUT_FILENO);
  if (recorder != nullptr) {
    runtime.on_step = [&](const Runtime::Step& step) {
      recorder->stepped(step.now, step.observations, step.commands, step.events);
    };
  }
  runtime.on_events = [&](std::span<const Event> events) {
    for (const Event& event : events) {
      const std::string text = line(event, rules, session.start, colour);
      if (text.empty()) continue;
      fmt::print("{}\n", text);
      (*robot)->link().log(severity_of(event), describe(event, rules));
    }
    std::fflush(stdout);
    (*robot)->link().publish(health(manager->knowledge()));
  };
  (*robot)->link().publish(health(manager->knowledge()));
  const auto go_on_with = [&](const char* reason, auto order) {
    seen.push_back({session.start, Order{0, "the last run", reason, order}});
  };
  if (session.is_paused) go_on_with("it was paused when it ended", Pause{});
  if (session.is_dry_run && !advises)
    go_on_with("a dry run was ordered when it ended", SetDryRun{true});
  runtime.step(seen);
  ServiceManager systemd;
  systemd.ready(fmt::format("watching {}", rules.robot.empty() ? "the robot" : rules.robot));
  constexpr Duration kLookAtRole = std::chrono::milliseconds(500);
  bool has_other_role = false;
  while (!signals.stopped() && !has_other_role) {
    systemd.feed((*robot)->now());
    const Time look = later((*robot)->now(), kLookAtRole);
    runtime.run(signals.stopped(), std::min(systemd.next_feeding(), look));
    has_other_role = role.has_changed((*robot)->link(), (*robot)->now(), session.start);
  }
  signals.on_stop({});
  if (recorder != nullptr) {
    if (const auto written = recorder->end(); !written)
      fmt::print(stderr, "culprit: {}\n", written.error());
  }
  if (has_other_role) return std::nullopt;
  systemd.stopping();
  fmt::print("culprit: stopped; the robot goes on as it is\n");
  return kOk;
}

int run(const RunOptions& options) {
  const auto rules = load_rules(options.rules);
  if (rules == nullptr) return kFailed;
  const auto governor = options.governor.options();
  if (!governor) {
    fmt::print(stderr, "culprit: {}\n", governor.error());
    return kUsage;
  }
  auto robot_setup = robot_options(options, *rules);
  if (!robot_setup) {
    fmt::print(stderr, "culprit: {}\n", robot_setup.error());
    return kUsage;
  }
  auto role = RoleOfCulprit::claim(*rules, robot_setup->link.participant.domain);
  if (!role) return complain(role.error());
  if (!options.dry_run) robot_setup->link.claim = role->lease();
  StopSignals signals;
  while (true) {
    const auto code = run_in_role(options, *rules, *governor, *robot_setup, *role, signals);
    if (code) return *code;
  }
}

}  // namespace

void add_run(CLI::App& app, const std::string& version, int& exit_code) {
  auto options = std::make_shared<RunOptions>();
  options->version = version;
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
  auto* journal = command->add_option(
      "--journal", options->journal,
      "Where everything is written down (default: <robot>.journal in the state folder)");
  command->add_flag("--no-journal", options->no_journal, "Write nothing down, and know nothing")
      ->excludes(journal);
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
  options->governor.add_to(*command);
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace culprit::cli
