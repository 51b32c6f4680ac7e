#include <unistd.h>

#include <fmt/core.h>

#include "base/amount.h"
#include "base/name_grammar.h"
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
#include "web/calls.h"
#include "web/hub_observer.h"
#include "web/order_routes.h"

namespace culprit::cli {
namespace {

Expected<live::RoleOfCulprit> claim_robot(const RuleSet& rules, const RunOptions& options) {
  const auto participant = ros2::options_from_environment();
  if (!participant) return Error{participant.error()};
  std::string key;
  if (!options.lease_key.empty()) {
    auto read = http::read_secret(options.lease_key, "key");
    if (!read) return Error{read.error()};
    key = std::move(*read);
  }
  return live::RoleOfCulprit(rules, participant->domain, std::move(key));
}

std::string name_of(const RuleSet& rules) {
  return rules.robot.empty() ? "the robot" : rules.robot;
}

void add(std::vector<http::Route>& all, std::vector<http::Route> more) {
  for (http::Route& route : more) all.push_back(std::move(route));
}

// The longest wait of a person.
constexpr Duration kDiskAnswers = std::chrono::seconds(3);

// The calls for terminals of this machine, and for the page.
std::vector<http::Route> local_routes(http::Hub& hub, const web::Metrics& metrics,
                                      web::OrderDesk& orders, live::LiveRun& live,
                                      RunRecording* recording) {
  web::RecordNow record;
  if (recording != nullptr) {
    record = [recording](const std::string& why) {
      return recording->recorder().record_now(why, kDiskAnswers);
    };
  }
  std::vector<http::Route> all = web::live_routes(hub);
  add(all, web::recording_routes(std::move(record)));
  add(all, web::order_routes(orders, hub));
  add(all, web::status_routes(hub, metrics));
  add(all, web::reload_routes([&live](const std::string& author) { return live.reload(author); }));
  return all;
}

std::vector<http::Route> page_routes(http::Hub& hub, const web::Histories& histories,
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
  std::vector<http::Route> all = web::rule_routes(desk);
  add(all, web::name_routes(look, desk.loader()));
  add(all, web::incident_routes(hub, journal, recordings));
  add(all, web::doctor_routes(web::examine_robot));
  all.push_back(web::component_route(hub, histories.usage, look, log_of));
  all.push_back(web::map_route(
      [&names](const std::string& topic, std::uint64_t known) { return names.map(topic, known); }));
  all.push_back(web::series_route(histories));
  all.push_back(web::past_series_route(journal));
  all.push_back(web::hindsight_route(journal_of));
  all.push_back(web::what_if_route(std::move(planner), desk.loader()));
  return all;
}

// After Ctrl-C. A disk can stall, and the middleware can hang with its locks held.
constexpr Duration kEndsWithin = std::chrono::milliseconds(2800);
// Of that: until the other processes of a launch that had started culprit, too.
constexpr Duration kLaunchEndsWithin = std::chrono::milliseconds(1500);

// The processes that culprit started outlive it. `role`: its own, at its end. If it only advised, another
// culprit goes on with them.
void name_what_runs_on(const std::string& robot, const std::vector<int>& others, live::Role role,
                       std::FILE* remarks) {
  const auto ended = owners::end_with_own_launch(robot, others, kLaunchEndsWithin);
  for (const owners::StartedProcess& each : ended)
    say(remarks, "culprit: its own launch ends, and with it {}\n",
        escape_controls(to_string(each, live_now())));
  const auto started = owners::started_processes(robot);
  if (started.empty() || !ended.empty() || role == live::Role::kAdvise) return;
  say(remarks,
      "culprit: these processes that culprit started run on; culprit end-started ends them:\n");
  for (const owners::StartedProcess& each : started)
    say(remarks, "  {}\n", escape_controls(to_string(each, live_now())));
}

// The parts of a run whose making can fail. Null: the run has none.
struct Opened {
  live::LiveSession::Options session;
  std::unique_ptr<live::Fleet> fleet;
  std::unique_ptr<RunAlerts> alerts;
  std::unique_ptr<RunRecording> recording;
};

// One run, put together: each part is made after those that it uses, and ends before them.
class Run {
 public:
  Run(const RunOptions& options, const RuleSet& rules, Opened opened, live::RoleOfCulprit role,
      std::FILE* remarks);

  // Manages the robot until it is stopped. Errors: it cannot be joined, or not be served.
  Expected<void> manage(live::LoadedRules rules, StopSignals& signals);
  // The processes of the launch that started culprit, when it was told to end.
  const std::vector<int>& others_of_launch() const { return others_; }
  live::Role role() const { return live_.role(); }

 private:
  std::vector<live::Observer*> observers();
  ros_api::OrderServices::Give orders_over_dds(bool has_keys);
  Expected<void> serve_page();

  const RunOptions& options_;
  std::FILE* const remarks_;
  CulpritIdentity identity_;
  const std::filesystem::path journal_;  // empty: none is written
  const std::unique_ptr<live::Fleet> fleet_;
  const std::unique_ptr<RunAlerts> alerts_;
  const std::unique_ptr<live::Listener> listener_;
  http::Hub hub_;
  web::Metrics metrics_;
  web::HubObserver observer_;
  web::Histories histories_;
  live::OrderKeeper keeper_;
  web::OrderDesk orders_;
  ros_api::RosApi ros_api_;
  const std::unique_ptr<RunRecording> recording_;
  live::Snapshots snapshots_;
  live::Observers observers_;
  live::LiveRun live_;
  std::vector<int> others_;
  web::RuleDesk desk_;
  live::RobotNames names_;
  std::unique_ptr<http::HttpServer> page_;
  std::unique_ptr<LocalService> local_;
};

Run::Run(const RunOptions& options, const RuleSet& rules, Opened opened, live::RoleOfCulprit role,
         std::FILE* remarks)
    : options_(options),
      remarks_(remarks),
      identity_{options.version,
                rules.robot,
                options.rules,
                opened.session.robot.link.participant.domain,
                opened.session.robot.link.name.name,
                ""},
      journal_(options.no_journal ? std::filesystem::path() : options.journal_path(rules)),
      fleet_(std::move(opened.fleet)),
      alerts_(std::move(opened.alerts)),
      listener_(listener_for(options.json ? Audience::kPrograms : Audience::kPeople)),
      hub_([this] { live_.interrupt(); }),
      observer_(hub_, metrics_),
      keeper_("the run has not begun"),
      orders_(keeper_.keeping()),
      ros_api_({options.version,
                orders_over_dds(opened.session.robot.link.participant.security.has_value()),
                [this](const std::string& trouble) {
                  listener_->on_remark("culprit: " + trouble + "\n");
                }}),
      recording_(std::move(opened.recording)),
      snapshots_({.recorder = options.recording.snapshot_of, .say = say_of_recording}),
      observers_(observers()),
      live_({std::move(opened.session), options.dry_run, options.improvise, fleet_.get()},
            std::move(role), keeper_, *listener_, &observers_),
      desk_(options.rules, options.may_edit_commands ? web::RuleDesk::Commands::kMayChange
                                                     : web::RuleDesk::Commands::kStay),
      names_(options.message_path) {}

std::vector<live::Observer*> Run::observers() {
  std::vector<live::Observer*> all{&observer_, &histories_.usage, &histories_.signals, &ros_api_};
  if (alerts_) all.push_back(&alerts_->observer());
  if (recording_) all.push_back(&recording_->observer());
  if (!options_.recording.snapshot_of.empty()) all.push_back(&snapshots_);
  return all;
}

// On a domain with keys, the owner of the keys vouches for every participant. Empty: no orders are taken.
ros_api::OrderServices::Give Run::orders_over_dds(bool has_keys) {
  if (!has_keys && !options_.takes_orders_from_anyone) return {};
  if (!has_keys)
    say(remarks_,
        "culprit: takes orders over DDS from any participant of this domain "
        "(--orders-from-anyone)\n");
  return [this](const Json& order) { return web::give_order(orders_, hub_, order); };
}

Expected<void> Run::serve_page() {
  std::vector<http::Route> routes = local_routes(hub_, metrics_, orders_, live_, recording_.get());
  add(routes,
      page_routes(hub_, histories_, desk_, names_, journal_,
                  options_.recording.folder_in(options_.state_path()), options_.planner.factory()));
  auto server = serve(options_.web, std::move(routes), &hub_, remarks_);
  if (!server) return Error{server.error()};
  page_ = std::move(*server);
  histories_.start();
  identity_.page = page_->address();
  if (alerts_) alerts_->set_page(identity_.page);
  return {};
}

Expected<void> Run::manage(live::LoadedRules rules, StopSignals& signals) {
  const std::string robot = name_of(rules.rules);
  const std::size_t count = rules.rules.rules.size();
  if (const auto joined = live_.join(std::move(rules)); !joined) return Error{joined.error()};
  signals.on_stop([this] {
    others_ = owners::others_of_own_launch();
    live_.leave();
  });
  say(remarks_,
      "culprit: watching {} with {}{}; Ctrl-C ends it and leaves the robot "
      "as it is\n",
      robot, amount_of(count, "rule"), options_.dry_run ? " (dry run)" : "");
  live_.begin(orders_, signals.stopped());
  if (options_.is_on_web) {
    if (const auto served = serve_page(); !served) return Error{served.error()};
  }
  signals.on_user_signal([this] {
    if (recording_) (void)recording_->recorder().record_now("SIGUSR1", Duration::zero());
  });
  local_ = serve_this_machine(
      identity_, local_routes(hub_, metrics_, orders_, live_, recording_.get()), hub_, remarks_);
  signals.on_reload([this] {
    if (const auto reloaded = live_.reload("SIGHUP"); !reloaded)
      say(stderr, "culprit: the rules are not reloaded: {}\n", reloaded.error());
  });
  const auto ended = live_.run(orders_, signals.stopped());
  signals.on_stop({});
  signals.on_reload({});
  signals.on_user_signal({});
  return ended;
}

// A mistyped path begins a journal that knows neither what was learned nor who paused culprit.
std::string remark_on_folder(const std::string& journal) {
  const std::filesystem::path folder = std::filesystem::path(journal).parent_path();
  std::error_code error;
  if (folder.empty() || std::filesystem::exists(folder, error)) return "";
  return fmt::format(
      "culprit: --journal: there is no folder '{}' yet; it is created, and the journal begins "
      "empty\n",
      printable(folder.string()));
}

int run(const RunOptions& options) {
  owners::keep_files_private();
  auto rules = live::trusted_rules(options.rules, options.improvise, colour_of(STDERR_FILENO));
  if (!rules) return fail(rules.error());
  const std::filesystem::path journal = options.journal_path(rules->rules);
  if (std::error_code error; std::filesystem::is_directory(journal, error))
    return fail("--journal: '" + options.journal + "' is a folder; name a file in it", kUsage);
  auto receivers = RunAlerts::read(options.alerts);
  if (!receivers) return fail(receivers.error());
  const auto trusted = live::trust_state(options.state_path(), journal);
  if (!trusted) return fail(trusted.error());
  live::make_private(journal);
  say(stderr, "{}{}{}", rules->remarks, remark_on_folder(options.journal), options.remarks());
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
  StopSignals signals(Hangup::kReloads);
  signals.end_within(kEndsWithin);
  // Its thread is not to be ended by a signal.
  auto fleet = join_fleet(options.fleet, journal);
  if (!fleet) return fail(fleet.error(), kUsage);
  auto alerts = RunAlerts::open(std::move(*receivers));
  auto recording = RunRecording::open(options.recording,
                                      {options.version, rules->rules.robot, options.state_path(),
                                       session->robot.link.participant, session->robot.link.types});
  if (!recording) return fail(recording.error());
  const std::string robot =
      fmt::format("{}/{}", session->robot.link.participant.domain, rules->rules.robot);
  Run whole(options, rules->rules,
            {std::move(*session), std::move(*fleet), std::move(alerts), std::move(*recording)},
            std::move(*role), remarks);
  if (const auto ended = whole.manage(std::move(*rules), signals); !ended)
    return fail(ended.error());
  say(remarks, "culprit: stopped; the robot goes on as it is\n");
  name_what_runs_on(robot, whole.others_of_launch(), whole.role(), remarks);
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
