#include <unistd.h>

#include <fmt/core.h>

#include "cli/commands.h"
#include "cli/run_options.h"
#include "live/live_run.h"
#include "live/node_name.h"
#include "live/robot_names.h"
#include "live/rule_trust.h"
#include "terminal/command.h"
#include "terminal/console.h"
#include "web/hub_observer.h"
#include "web/live_routes.h"
#include "web/name_routes.h"
#include "web/order_routes.h"
#include "web/reload_routes.h"
#include "web/rule_routes.h"
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

// Says everything at the terminal, or wherever the output goes.
class ConsoleListener : public live::Listener {
 public:
  void on_event(const Event& event, const RuleSet& rules, Time start) override {
    const std::string text = line(event, rules, start, colour_of(STDOUT_FILENO));
    if (!text.empty()) say(stdout, "{}\n", text);
  }
  void on_announcement(Duration after, const EventWords& words, const std::string& text) override {
    say(stdout, "{}\n", line(words, after, text, colour_of(STDOUT_FILENO)));
  }
  void on_remark(const std::string& lines) override { say_text(stdout, lines); }
  void on_trouble(const std::string& text) override { fail(text); }
};

std::vector<web::Route> web_routes(web::Hub& hub, const web::Metrics& metrics, web::RuleDesk& desk,
                                   web::OrderDesk& orders, live::LiveRun& live,
                                   live::RobotNames& names, PlannerFactory planner) {
  std::vector<web::Route> all;
  const auto reload = [&live](const std::string& author) { return live.reload(author); };
  for (auto routes :
       {web::live_routes(hub), web::order_routes(orders), web::status_routes(hub, metrics),
        web::rule_routes(desk), web::reload_routes(reload),
        web::name_routes(
            [&names](const LiveInterest& interest) { return names.look(interest); })}) {
    for (web::Route& route : routes) all.push_back(std::move(route));
  }
  all.push_back(web::what_if_route(std::move(planner)));
  return all;
}

// After Ctrl-C. The middleware can hang with its locks held.
constexpr Duration kEndsWithin = std::chrono::seconds(8);

int run(const RunOptions& options) {
  auto rules = live::trusted_rules(options.rules, options.improvise, colour_of(STDERR_FILENO));
  if (!rules) return fail(rules.error());
  const auto trusted = live::trust_state(options.state_path(), options.journal_path(rules->rules));
  if (!trusted) return fail(trusted.error());
  say(stderr, "{}", rules->remarks);
  auto session = options.session(rules->rules);
  if (!session) return fail(session.error(), kUsage);
  std::optional<live::NodeNameClaim> node_name;
  if (options.node_name.empty()) {
    node_name.emplace(session->robot.link.participant);
    session->robot.link.name.name = node_name->name();
  }
  auto role = claim_robot(rules->rules, options);
  if (!role) return fail(role.error(), kUsage);
  if (!role->reason().empty()) say(stdout, "culprit: {}\n", role->reason());
  StopSignals signals(Hangup::kReloads);
  signals.end_within(kEndsWithin);
  ConsoleListener listener;
  live::LiveRun* running = nullptr;
  web::Hub hub([&] { running->interrupt(); });
  web::Metrics metrics;
  web::HubObserver observer(hub, metrics);
  live::OrderKeeper keeper("the run has not begun");
  web::OrderDesk orders(keeper.keeping());
  live::LiveRun live({std::move(*session), options.dry_run, options.improvise}, std::move(*role),
                     keeper, listener, &observer);
  running = &live;
  const std::string robot = name_of(rules->rules);
  const std::size_t count = rules->rules.rules.size();
  if (const auto joined = live.join(std::move(*rules)); !joined) return fail(joined.error());
  signals.on_stop([&] { live.leave(); });
  say(stdout,
      "culprit: watching {} with {} rules{}; Ctrl-C ends it and leaves the robot "
      "as it is\n",
      robot, count, options.dry_run ? " (dry run)" : "");
  live.begin(orders, signals.stopped());

  web::RuleDesk desk(options.rules);
  live::RobotNames names(options.message_path);
  Expected<std::unique_ptr<web::Server>> server(nullptr);
  if (options.is_on_web) {
    server =
        serve(options.web,
              web_routes(hub, metrics, desk, orders, live, names, options.planner.factory()), &hub);
    if (!server) return fail(server.error(), kUsage);
  }
  signals.on_reload([&] {
    if (const auto reloaded = live.reload("SIGHUP"); !reloaded)
      say(stderr, "culprit: the rules are not reloaded: {}\n", reloaded.error());
  });
  const auto ended = live.run(orders, signals.stopped());
  signals.on_stop({});
  signals.on_reload({});
  if (!ended) return fail(ended.error());
  say(stdout, "culprit: stopped; the robot goes on as it is\n");
  return kOk;
}

}  // namespace

void add_run(CLI::App& app, const std::string& version, int& exit_code) {
  auto options = std::make_shared<RunOptions>();
  options->version = version;
  CLI::App* command =
      app.add_subcommand("run",
                         "Watch a live robot and heal it until Ctrl-C.\nJoins the DDS domain that "
                         "ROS_DOMAIN_ID and ROS_LOCALHOST_ONLY name. SIGHUP reloads the rules.");
  options->add_to(*command);
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace culprit::cli
