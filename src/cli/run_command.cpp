#include <mutex>
#include <unistd.h>

#include <fmt/core.h>

#include "cli/commands.h"
#include "cli/journal_file.h"
#include "cli/live_session.h"
#include "cli/run_options.h"
#include "live/begin_anew.h"
#include "live/robot_names.h"
#include "live/role.h"
#include "live/rule_trust.h"
#include "live/service_manager.h"
#include "terminal/console.h"
#include "web/live_routes.h"
#include "web/name_routes.h"
#include "web/order_routes.h"
#include "web/reload_routes.h"
#include "web/rule_routes.h"
#include "web/status_routes.h"
#include "web/what_if_route.h"

namespace culprit::cli {
namespace {

Expected<RoleOfCulprit> claim_robot(const RuleSet& rules, const RunOptions& options) {
  const auto participant = ros2::options_from_environment();
  if (!participant) return Error{participant.error()};
  std::string key;
  if (!options.lease_key.empty()) {
    auto read = web::read_secret(options.lease_key, "key");
    if (!read) return Error{read.error()};
    key = std::move(*read);
  }
  return RoleOfCulprit(rules, participant->domain, std::move(key));
}

// Whoever acts leaves alone what others manage.
void look_at_neighbours(RoleOfCulprit& role, LiveSession& session,
                        const LiveSession::Frame& frame) {
  std::set<std::string> nodes;
  if (!frame.advises) nodes = session.adapted_nodes();
  const auto elsewhere = role.managed_elsewhere(nodes, session.link());
  if (!frame.advises) session.leave_alone(elsewhere);
  for (const std::string& warning : role.warnings(session.link()))
    session.announce("neighbour", warning);
  // One that was slow, or cut off, and is about to step back.
  const auto told = role.told_orders(session.link());
  if (frame.advises || !told || !*told) return;
  for (Order& order : frame.orders.heed(**told, session.rules(), session.now()))
    session.submit(std::move(order));
}

// Whoever only advises neither acts nor writes the journal.
void take_role(LiveSession::Frame& frame, const RoleOfCulprit& role) {
  frame.advises = frame.options.dry_run || role.role() == Role::kAdvise;
  frame.records = !frame.options.no_journal && role.role() == Role::kManage;
  if (!frame.options.dry_run) frame.lease = role.lease();
}

// Who cannot tell whether a person has paused the robot is paused.
std::optional<journal::StandingOrders> orders_for_successor(const RoleOfCulprit& role,
                                                            const ros2::Link& link) {
  if (role.role() != Role::kManage) return std::nullopt;
  auto told = role.told_orders(link);
  if (told) return *told;
  journal::StandingOrders paused;
  paused.pause = journal::StandingOrders::Said{"culprit", told.error()};
  return paused;
}

std::string name_of(const RuleSet& rules) {
  return rules.robot.empty() ? "the robot" : rules.robot;
}

Expected<LoadedRules> rules_for(const RunOptions& options, Colour colour) {
  auto loaded = read_rules(options.rules, Strictness::kLenient, colour);
  if (!loaded) return loaded;
  if (const auto trusted = trust_rules(options.rules); !trusted) return Error{trusted.error()};
  if (!options.improvise) return loaded;
  return improvised(std::move(*loaded), options.rules);
}

// The session that is on, for other threads, and the rules that are to be next.
class Stage {
 public:
  struct Next {
    LoadedRules rules;
    std::string author;
  };

  // `options` must outlive it.
  explicit Stage(const RunOptions& options) : options_(options) {}

  // Null: none is on now.
  void enter(LiveSession* session) {
    const std::lock_guard lock(mutex_);
    session_ = session;
  }
  void interrupt() {
    const std::lock_guard lock(mutex_);
    if (session_ != nullptr) session_->interrupt();
  }
  void leave() {
    const std::lock_guard lock(mutex_);
    if (session_ != nullptr) session_->leave();
  }
  // web::Reload
  Expected<std::size_t> reload(const std::string& author) {
    auto loaded = rules_for(options_, Colour::kOff);
    if (!loaded) return Error{loaded.error()};
    const std::size_t count = loaded->rules.rules.size();
    const std::lock_guard lock(mutex_);
    if (session_ == nullptr) return Error{"the rules are just being reloaded; ask again"};
    if (loaded->rules.robot != session_->rules().robot)
      return Error{fmt::format("{} is now about the robot '{}' instead of '{}'; start culprit anew",
                               options_.rules, loaded->rules.robot, session_->rules().robot)};
    next_ = Next{std::move(*loaded), author};
    session_->leave();
    return count;
  }
  std::optional<Next> take_next() {
    const std::lock_guard lock(mutex_);
    return std::exchange(next_, std::nullopt);
  }

 private:
  const RunOptions& options_;
  std::mutex mutex_;  // guards what follows
  LiveSession* session_ = nullptr;
  std::optional<Next> next_;
};

// Gives the session of the new rules, or the old one if the robot cannot be joined anew.
std::unique_ptr<LiveSession> reloaded(std::unique_ptr<LiveSession> old, Stage::Next next,
                                      const LiveSession::Frame& frame, Stage& stage,
                                      web::OrderDesk& orders) {
  const std::string& path = frame.options.rules;
  auto opened = LiveSession::open(frame, std::move(next.rules));
  if (!opened) {
    old->announce("trouble", "the rules are not reloaded: " + opened.error());
    return old;
  }
  std::unique_ptr<LiveSession> session = std::move(*opened);
  orders.close();
  stage.enter(nullptr);
  LiveSession::Handover handover = old->hand_over(session->rules(), "reloaded by " + next.author);
  old.reset();
  session->begin(std::move(handover));
  session->announce("reloaded", fmt::format("{}: {} is reloaded, with {} rules", next.author, path,
                                            session->rules().rules.size()));
  stage.enter(session.get());
  orders.open(session->rules(),
              [&session = *session](Order order) { session.submit(std::move(order)); });
  return session;
}

std::vector<web::Route> web_routes(web::Hub& hub, const web::Metrics& metrics, web::RuleDesk& desk,
                                   web::OrderDesk& orders, Stage& stage, RobotNames& names,
                                   PlannerFactory planner) {
  std::vector<web::Route> all;
  const auto reload = [&stage](const std::string& author) { return stage.reload(author); };
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

// Begins anew in another role, with the same rules. Gives null, and says why, if the robot cannot
// be joined.
std::unique_ptr<LiveSession> in_role(const RoleOfCulprit& role, std::unique_ptr<LiveSession> old,
                                     LiveSession::Frame& frame, Stage& stage,
                                     web::OrderDesk& orders, const std::atomic<bool>& stopped) {
  orders.close();
  stage.enter(nullptr);
  old->say_lease();
  LoadedRules rules = old->loaded_rules();
  const KnownRobot known = old->known_robot();
  frame.told_orders = orders_for_successor(role, old->link());
  old->end();
  old.reset();
  take_role(frame, role);
  auto session = LiveSession::open(frame, std::move(rules));
  if (!session) return fail(session.error()), nullptr;
  (*session)->begin(stopped, known);
  (*session)->announce("role", role.reason());
  stage.enter(session->get());
  orders.open((*session)->rules(),
              [&session = **session](Order order) { session.submit(std::move(order)); });
  return std::move(*session);
}

// How long nothing is heard before culprit begins anew. A cut cable is no reason: what it says to
// itself does not leave the computer.
constexpr Duration kDeafAtMost = std::chrono::seconds(20);
// After Ctrl-C. The middleware can hang with its locks held.
constexpr Duration kEndsWithin = std::chrono::seconds(8);

// One session after the other, as often as the rules are reloaded or the role is another one.
int manage(std::unique_ptr<LiveSession> session, LiveSession::Frame& frame, RoleOfCulprit& role,
           Stage& stage, web::OrderDesk& orders, const std::atomic<bool>& stopped) {
  ServiceManager systemd;
  systemd.ready("watching " + name_of(session->rules()));
  std::optional<Stage::Next> next;
  Time joined = session->now();
  while (!stopped) {
    if (role.has_changed(session->link(), session->now(), joined)) {
      session = in_role(role, std::move(session), frame, stage, orders, stopped);
      if (session == nullptr) return kFailed;
      joined = session->now();
    }
    look_at_neighbours(role, *session, frame);
    if (frame.orders.is_kept_again())
      session->announce("kept", "what people have ordered was not kept, and is now");
    // Whoever stays deaf is not fed, and begins anew.
    const auto deaf_since = session->deaf_since();
    if (!deaf_since) {
      systemd.feed(session->now());
    } else if (session->now() >= later(*deaf_since, kDeafAtMost)) {
      session->announce("deaf", "the robot was not heard for " + to_string(kDeafAtMost) +
                                    "; culprit begins anew");
      orders.close();
      stage.enter(nullptr);
      session->end();
      fail(begin_anew());
      std::_Exit(kFailed);
    }
    // Without a journal nobody would know what is under way: then the new rules wait for its end.
    const bool has_to_wait = next && !frame.records && session->is_adapting();
    if (next && !has_to_wait) {
      session = reloaded(std::move(session), std::move(*next), frame, stage, orders);
      next.reset();
    }
    constexpr Duration kLook = std::chrono::milliseconds(100);
    constexpr Duration kLookAtRole = std::chrono::milliseconds(500);
    const Time until = later(session->now(), has_to_wait ? kLook : kLookAtRole);
    session->run(deaf_since ? until : std::min(until, systemd.next_feeding()));
    if (auto newest = stage.take_next()) next = std::move(newest);
  }
  systemd.stopping();
  orders.close();
  stage.enter(nullptr);
  session->say_lease();
  session->end();
  return kOk;
}

int run(const RunOptions& options) {
  auto rules = rules_for(options, colour_of(STDERR_FILENO));
  if (!rules) return fail(rules.error());
  const auto trusted = trust_state(options.state_path(), options.journal_path(rules->rules));
  if (!trusted) return fail(trusted.error());
  say(stderr, "{}", rules->remarks);
  const auto governor = options.governor.options();
  if (!governor) return fail(governor.error()), kUsage;
  auto role = claim_robot(rules->rules, options);
  if (!role) return fail(role.error()), kUsage;
  if (!role->reason().empty()) say(stdout, "culprit: {}\n", role->reason());
  StopSignals signals(Hangup::kReloads);
  signals.end_within(kEndsWithin);
  Stage stage(options);
  web::Hub hub([&] { stage.interrupt(); });
  web::Metrics metrics;
  OrderKeeper keeper("the run has not begun");
  LiveSession::Frame frame{options, *governor, false,  true,       {},
                           hub,     metrics,   keeper, live_now(), {}};
  take_role(frame, *role);
  const std::string robot = name_of(rules->rules);
  auto session = LiveSession::open(frame, std::move(*rules));
  if (!session) return fail(session.error());
  signals.on_stop([&] { stage.leave(); });
  say(stdout,
      "culprit: watching {} with {} rules{}; Ctrl-C ends it and leaves the robot "
      "as it is\n",
      robot, (*session)->rules().rules.size(), options.dry_run ? " (dry run)" : "");
  (*session)->begin(signals.stopped());

  web::OrderDesk orders(keeper.keeping());
  orders.open((*session)->rules(),
              [&session = **session](Order order) { session.submit(std::move(order)); });
  stage.enter(session->get());
  web::RuleDesk desk(options.rules);
  RobotNames names(options.message_path);
  Expected<std::unique_ptr<web::Server>> server(nullptr);
  if (options.is_on_web) {
    server = serve(options.web,
                   web_routes(hub, metrics, desk, orders, stage, names, options.planner.factory()),
                   &hub);
    if (!server) return fail(server.error()), kUsage;
  }
  signals.on_reload([&] {
    if (const auto count = stage.reload("SIGHUP"); !count)
      say(stderr, "culprit: the rules are not reloaded: {}\n", count.error());
  });
  const int code = manage(std::move(*session), frame, *role, stage, orders, signals.stopped());
  signals.on_stop({});
  signals.on_reload({});
  if (code != kOk) return code;
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
