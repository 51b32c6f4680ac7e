#include <unistd.h>

#include <fmt/core.h>

#include "cli/commands.h"
#include "cli/listeners.h"
#include "cli/run_alerts.h"
#include "cli/run_options.h"
#include "live/live_run.h"
#include "live/node_name.h"
#include "live/observers.h"
#include "live/robot_names.h"
#include "live/rule_trust.h"
#include "live/snapshots.h"
#include "owners/spawn.h"
#include "owners/started_processes.h"
#include "ros_api/ros_api.h"
#include "terminal/command.h"
#include "terminal/console.h"
#include "terminal/local_service.h"
#include "web/component_route.h"
#include "web/doctor_routes.h"
#include "web/hindsight_route.h"
#include "web/hub_observer.h"
#include "web/incident_routes.h"
#include "web/live_routes.h"
#include "web/name_routes.h"
#include "web/order_routes.h"
#include "web/recording_routes.h"
#include "web/reload_routes.h"
#include "web/rule_routes.h"
#include "web/series_route.h"
#include "web/status_routes.h"
#include "web/what_if_route.h"

namespace culprit::cli {
namespace {

Expected<live::RoleOfCulprit> claim_robot(const RuleSet& rules, const RunOptions& options) {
  const auto participant = ros2::options_from_environment();
  if (!participant) return Error{participant.error()};
  std::string key;
  if (!options.lease_key.empty()) {
    auto read = web::read_secret(options.lease_key, "key");
    if (!read) return Error{read.error()};
    key = std::move(*read);
  }
  return live::RoleOfCulprit(rules, participant->domain, std::move(key));
}

std::string name_of(const RuleSet& rules) {
  return rules.robot.empty() ? "the robot" : rules.robot;
}

void add(std::vector<web::Route>& all, std::vector<web::Route> more) {
  for (web::Route& route : more) all.push_back(std::move(route));
}

// The longest wait of a person.
constexpr Duration kDiskAnswers = std::chrono::seconds(3);

// The calls for terminals of this machine, and for the page.
std::vector<web::Route> local_routes(web::Hub& hub, const web::Metrics& metrics,
                                     web::OrderDesk& orders, live::LiveRun& live,
                                     RunRecording* recording) {
  web::RecordNow record;
  if (recording != nullptr) {
    record = [recording](const std::string& why) {
      return recording->recorder().record_now(why, kDiskAnswers);
    };
  }
  std::vector<web::Route> all = web::live_routes(hub);
  add(all, web::recording_routes(std::move(record)));
  add(all, web::order_routes(orders, hub));
  add(all, web::status_routes(hub, metrics));
  add(all, web::reload_routes([&live](const std::string& author) { return live.reload(author); }));
  return all;
}

std::vector<web::Route> page_routes(web::Hub& hub, const web::Histories& histories,
                                    web::RuleDesk& desk, live::RobotNames& names,
                                    const std::filesystem::path& journal,
                                    const std::filesystem::path& recordings,
                                    PlannerFactory planner) {
  const auto look = [&names](const LiveInterest& interest) { return names.look(interest); };
  const auto log_of = [&names](const std::string& node) { return names.log_of(node); };
  const auto journal_of = [journal](const std::string&) -> Expected<std::filesystem::path> {
    if (journal.empty()) return Error{"no journal is written (--no-journal)"};
    return journal;
  };
  std::vector<web::Route> all = web::rule_routes(desk);
  add(all, web::name_routes(look, desk.loader()));
  add(all, web::incident_routes(hub, journal, recordings));
  add(all, web::doctor_routes(web::examine_robot));
  all.push_back(web::component_route(hub, histories.usage, look, log_of));
  all.push_back(web::series_route(histories));
  all.push_back(web::hindsight_route(journal_of));
  all.push_back(web::what_if_route(std::move(planner), desk.loader()));
  return all;
}

// Null: nothing is recorded.
Expected<std::unique_ptr<RunRecording>> open_recording(const RunOptions& options,
                                                       const std::string& robot,
                                                       const live::LiveSession::Options& session) {
  return RunRecording::open(options.recording,
                            {options.version, robot, options.state_path(),
                             session.robot.link.participant, session.robot.link.types});
}

// On a domain with keys, the owner of the keys vouches for every participant. Empty: no orders are taken.
ros_api::OrderServices::Give orders_over_dds(const RunOptions& options,
                                             const live::LiveSession::Options& session,
                                             web::OrderDesk& desk, web::Hub& hub,
                                             std::FILE* remarks) {
  const bool has_keys = session.robot.link.participant.security.has_value();
  if (!has_keys && !options.takes_orders_from_anyone) return {};
  if (!has_keys)
    say(remarks,
        "culprit: takes orders over DDS from any participant of this domain "
        "(--orders-from-anyone)\n");
  return [&desk, &hub](const Json& order) { return web::give_order(desk, hub, order); };
}

// After Ctrl-C. A disk can stall, and the middleware can hang with its locks held.
constexpr Duration kEndsWithin = std::chrono::milliseconds(2800);
// Of that: until the other processes of a launch that had started culprit, too.
constexpr Duration kLaunchEndsWithin = std::chrono::milliseconds(1500);

// The processes that culprit started outlive it.
void name_what_runs_on(const std::string& robot, const std::vector<int>& others,
                       std::FILE* remarks) {
  const auto ended = owners::end_with_own_launch(robot, others, kLaunchEndsWithin);
  for (const owners::StartedProcess& each : ended)
    say(remarks, "culprit: its own launch ends, and with it {}\n",
        escape_controls(to_string(each, live_now())));
  const auto started = owners::started_processes(robot);
  if (started.empty() || !ended.empty()) return;
  say(remarks, "culprit: these processes that it started run on; culprit end-started ends them:\n");
  for (const owners::StartedProcess& each : started)
    say(remarks, "  {}\n", escape_controls(to_string(each, live_now())));
}

int run(const RunOptions& options) {
  owners::keep_files_private();
  auto rules = live::trusted_rules(options.rules, options.improvise, colour_of(STDERR_FILENO));
  if (!rules) return fail(rules.error());
  const auto trusted = live::trust_state(options.state_path(), options.journal_path(rules->rules));
  if (!trusted) return fail(trusted.error());
  live::make_private(options.journal_path(rules->rules));
  say(stderr, "{}", rules->remarks);
  auto session = options.session(rules->rules);
  if (!session) return fail(session.error(), kUsage);
  std::optional<live::NodeNameClaim> node_name;
  if (options.node_name.empty()) {
    node_name.emplace(session->robot.link.participant);
    session->robot.link.name.name = node_name->name();
  }
  std::FILE* const remarks = options.json ? stderr : stdout;
  auto role = claim_robot(rules->rules, options);
  if (!role) return fail(role.error(), kUsage);
  if (!role->reason().empty()) say(remarks, "culprit: {}\n", role->reason());
  WhoServes who{options.version,
                rules->rules.robot,
                options.rules,
                session->robot.link.participant.domain,
                session->robot.link.name.name,
                ""};
  StopSignals signals(Hangup::kReloads);
  signals.end_within(kEndsWithin);
  // Its thread is not to be ended by a signal.
  const auto fleet = join_fleet(options.fleet, options.journal_path(rules->rules));
  if (!fleet) return fail(fleet.error(), kUsage);
  const auto alerts = RunAlerts::open(options.alerts);
  if (!alerts) return fail(alerts.error());
  const auto listener = listener_for(options.json ? Audience::kPrograms : Audience::kPeople);
  live::LiveRun* running = nullptr;
  web::Hub hub([&] { running->interrupt(); });
  web::Metrics metrics;
  web::HubObserver observer(hub, metrics);
  web::Histories histories;
  live::OrderKeeper keeper("the run has not begun");
  web::OrderDesk orders(keeper.keeping());
  ros_api::RosApi ros_api({options.version,
                           orders_over_dds(options, *session, orders, hub, remarks),
                           [&listener](const std::string& trouble) {
                             listener->on_remark("culprit: " + trouble + "\n");
                           }});
  std::vector<live::Observer*> onlookers{&observer, &histories.usage, &histories.signals, &ros_api};
  if (*alerts) onlookers.push_back(&(*alerts)->observer());
  const auto recording = open_recording(options, rules->rules.robot, *session);
  if (!recording) return fail(recording.error());
  if (*recording) onlookers.push_back(&(*recording)->observer());
  live::Snapshots snapshots({.recorder = options.recording.snapshot_of, .say = say_of_recording});
  if (!options.recording.snapshot_of.empty()) onlookers.push_back(&snapshots);
  live::Observers observers(std::move(onlookers));
  live::LiveRun live({std::move(*session), options.dry_run, options.improvise, fleet->get()},
                     std::move(*role), keeper, *listener, &observers);
  running = &live;
  const std::string robot = name_of(rules->rules);
  const std::string robot_key = fmt::format("{}/{}", who.domain, rules->rules.robot);
  const auto journal =
      options.no_journal ? std::filesystem::path() : options.journal_path(rules->rules);
  const std::size_t count = rules->rules.rules.size();
  if (const auto joined = live.join(std::move(*rules)); !joined) return fail(joined.error());
  std::vector<int> others;  // of the launch that started culprit, when it is told to end
  signals.on_stop([&] {
    others = owners::others_of_own_launch();
    live.leave();
  });
  say(remarks,
      "culprit: watching {} with {} rules{}; Ctrl-C ends it and leaves the robot "
      "as it is\n",
      robot, count, options.dry_run ? " (dry run)" : "");
  live.begin(orders, signals.stopped());

  web::RuleDesk desk(options.rules, options.may_edit_commands ? web::RuleDesk::Commands::kMayChange
                                                              : web::RuleDesk::Commands::kStay);
  live::RobotNames names(options.message_path);
  Expected<std::unique_ptr<web::HttpServer>> server(nullptr);
  if (options.is_on_web) {
    std::vector<web::Route> routes = local_routes(hub, metrics, orders, live, recording->get());
    add(routes,
        page_routes(hub, histories, desk, names, journal,
                    options.recording.folder_in(options.state_path()), options.planner.factory()));
    server = serve(options.web, std::move(routes), &hub, remarks);
    if (!server) return fail(server.error());
    histories.start();
    who.page = (*server)->address();
    if (*alerts) (*alerts)->set_page(who.page);
  }
  signals.on_user_signal([&] {
    if (*recording) (void)(*recording)->recorder().record_now("SIGUSR1", Duration::zero());
  });
  const auto local = serve_this_machine(
      who, local_routes(hub, metrics, orders, live, recording->get()), hub, remarks);
  signals.on_reload([&] {
    if (const auto reloaded = live.reload("SIGHUP"); !reloaded)
      say(stderr, "culprit: the rules are not reloaded: {}\n", reloaded.error());
  });
  const auto ended = live.run(orders, signals.stopped());
  signals.on_stop({});
  signals.on_reload({});
  signals.on_user_signal({});
  if (!ended) return fail(ended.error());
  say(remarks, "culprit: stopped; the robot goes on as it is\n");
  name_what_runs_on(robot_key, others, remarks);
  return kOk;
}

}  // namespace

void add_run(CLI::App& app, const std::string& version, int& exit_code) {
  auto options = std::make_shared<RunOptions>();
  options->version = version;
  CLI::App* command = app.add_subcommand("run",
                                         "Watch a live robot and repair it until Ctrl-C.\n"
                                         "Joins the DDS domain that ROS_DOMAIN_ID and "
                                         "ROS_LOCALHOST_ONLY name. SIGHUP reloads the rules.");
  options->add_to(*command);
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace culprit::cli
