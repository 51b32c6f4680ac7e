#include "live/live_run.h"

#include <cstdlib>

#include <fmt/core.h>

#include "base/amount.h"
#include "base/invariant.h"
#include "live/announcements.h"
#include "live/begin_anew.h"

namespace culprit::live {
namespace {

// Time without any message before culprit begins anew. A cut cable is no reason: culprit's messages
// to itself do not leave the computer.
constexpr Duration kDeafAtMost = std::chrono::seconds(20);

// If it is unknown whether a person has paused the robot, the successor starts paused.
std::optional<journal::StandingOrders> orders_for_successor(const RoleOfCulprit& role,
                                                            const link::LeaseLink* lease) {
  if (role.role() != Role::kManage) return std::nullopt;
  auto told = role.told_orders(lease);
  if (told) return *told;
  journal::StandingOrders paused;
  paused.pause = journal::StandingOrders::Said{"culprit", told.error()};
  return paused;
}

// Learned and tried by the predecessor.
std::optional<Expected<journal::Inheritance>> inheritance_for_successor(
    const RoleOfCulprit& role, const link::LeaseLink* lease, const RuleSet& rules, Time now) {
  if (role.role() != Role::kManage) return std::nullopt;
  return role.told_inheritance(lease, rules, now);
}

std::string name_of(const RuleSet& rules) {
  return rules.robot.empty() ? "the robot" : rules.robot;
}

}  // namespace

LiveRun::LiveRun(Options options, RoleOfCulprit role, OrderKeeper& keeper, Listener& listener,
                 Observer* observer)
    : options_(std::move(options)),
      role_(std::move(role)),
      frame_{.options = options_.session,
             .lease = {},
             .orders = keeper,
             .listener = listener,
             .observer = observer,
             .fleet = options_.fleet,
             .start = live_now()} {
  take_role();
}

// A culprit that only advises neither acts nor writes the journal.
void LiveRun::take_role() {
  frame_.advises = options_.dry_run || role_.role() == Role::kAdvise;
  frame_.records = options_.session.no_journal.empty() && role_.role() == Role::kManage;
  if (!options_.dry_run) frame_.lease = role_.lease();
}

void LiveRun::enter(LiveSession* session) {
  const MutexLock lock(mutex_);
  entered_ = session;
}

void LiveRun::interrupt() {
  const MutexLock lock(mutex_);
  if (entered_ != nullptr) entered_->interrupt();
}

void LiveRun::leave() {
  const MutexLock lock(mutex_);
  if (entered_ != nullptr) entered_->leave();
}

Expected<std::size_t> LiveRun::reload(const std::string& author) {
  const std::string& path = options_.session.rules_file;
  auto loaded = trusted_rules(path, options_.improvises, Colour::kOff);
  if (!loaded) return Error{loaded.error()};
  const std::size_t count = loaded->rules.rules.size();
  const MutexLock lock(mutex_);
  if (entered_ == nullptr) return Error{"the rules are just being reloaded; ask again"};
  const std::string& robot = entered_->rules().robot;
  if (loaded->rules.robot != robot)
    return Error{fmt::format("{} is now about the robot '{}' instead of '{}'; restart culprit",
                             path, loaded->rules.robot, robot)};
  next_ = Next{std::move(*loaded), author};
  entered_->leave();
  return count;
}

std::optional<LiveRun::Next> LiveRun::take_next() {
  const MutexLock lock(mutex_);
  return std::exchange(next_, std::nullopt);
}

Expected<void> LiveRun::join(LoadedRules rules) {
  auto session = LiveSession::open(frame_, std::move(rules));
  if (!session) return Error{session.error()};
  session_ = std::move(*session);
  return {};
}

void LiveRun::begin(OrderTaker& desk, const std::atomic<bool>& stopped) {
  CULPRIT_ASSERT(session_);
  session_->begin(stopped);
  open(desk);
}

void LiveRun::open(OrderTaker& desk) {
  enter(session_.get());
  desk.open(session_->rules(),
            [&session = *session_](Order order) { session.submit(std::move(order)); });
}

void LiveRun::close(OrderTaker& desk) {
  desk.close();
  enter(nullptr);
}

// The acting culprit leaves alone the components that others manage.
void LiveRun::look_at_neighbours() {
  std::set<std::string> nodes;
  if (!frame_.advises) nodes = session_->adapted_nodes();
  const auto elsewhere = role_.managed_elsewhere(nodes, session_->lease());
  if (!frame_.advises) session_->leave_alone(elsewhere);
  for (const std::string& warning : role_.warnings(session_->lease()))
    session_->announce(announcements::kNeighbour, warning);
  // One that was slow, or cut off, and is about to step back.
  const auto told = role_.told_orders(session_->lease());
  if (frame_.advises || !told || !*told) return;
  for (Order& order : frame_.orders.heed(**told, session_->rules(), session_->now()))
    session_->submit(std::move(order));
}

// Begins anew in another role, with the same rules. A new manager keeps what it observed while it
// only advised.
Expected<void> LiveRun::change_role(OrderTaker& desk, const std::atomic<bool>& stopped) {
  close(desk);
  frame_.told_orders = orders_for_successor(role_, session_->lease());
  frame_.told_inheritance =
      inheritance_for_successor(role_, session_->lease(), session_->rules(), session_->now());
  if (role_.role() == Role::kManage && take_over(stopped)) {
    session_->announce(announcements::kRole, role_.reason());
    open(desk);
    return {};
  }
  session_->say_lease();
  LoadedRules rules = session_->loaded_rules();
  const KnownRobot known = session_->known_robot();
  session_->end(role_.role() == Role::kManage ? journal::Ending::kStopped
                                              : journal::Ending::kSteppedBack);
  session_.reset();
  take_role();
  frame_.manager_before = role_.manager_before();
  if (auto joined = join(std::move(rules)); !joined) return joined;
  frame_.manager_before.reset();  // the sessions that come next follow this one
  session_->begin(stopped, known);
  session_->announce(announcements::kRole, role_.reason());
  open(desk);
  return {};
}

// False: it has to begin anew.
bool LiveRun::take_over(const std::atomic<bool>& stopped) {
  if (options_.dry_run || !session_->can_take_over()) return false;
  take_role();
  frame_.manager_before = role_.manager_before();
  const auto elsewhere = role_.managed_elsewhere(session_->adapted_nodes(), session_->lease());
  const auto taken = session_->take_over(frame_, elsewhere, stopped);
  frame_.manager_before.reset();
  if (!taken) frame_.listener.on_remark("culprit: it rejoins the domain: " + taken.error() + "\n");
  return taken.has_value();
}

// Goes on with the old ones if the robot cannot be joined anew.
void LiveRun::change_rules(Next next, OrderTaker& desk) {
  auto opened = LiveSession::open(frame_, std::move(next.rules));
  if (!opened)
    return session_->announce(announcements::kNotReloaded,
                              "the rules are not reloaded: " + opened.error());
  close(desk);
  Handover handover = session_->hand_over((*opened)->rules(), "reloaded by " + next.author);
  session_ = std::move(*opened);
  session_->begin(std::move(handover));
  session_->announce(
      announcements::kReloaded,
      fmt::format("{}: {} is reloaded, with {}", next.author, options_.session.rules_file,
                  amount_of(session_->rules().rules.size(), "rule")));
  open(desk);
}

// A culprit that stays deaf does not feed the watchdog, and replaces itself.
void LiveRun::watch_hearing(OrderTaker& desk) {
  const auto deaf_since = session_->deaf_since();
  if (!deaf_since) return systemd_.feed(session_->now());
  if (session_->now() < later(*deaf_since, kDeafAtMost)) return;
  session_->announce(announcements::kBeginsAnew, "no message of the robot arrived for " +
                                                     to_string(kDeafAtMost) + "; culprit restarts");
  close(desk);
  session_->end();
  frame_.listener.on_trouble(begin_anew());
  std::_Exit(EXIT_FAILURE);
}

Expected<void> LiveRun::run(OrderTaker& desk, const std::atomic<bool>& stopped) {
  CULPRIT_ASSERT(session_);
  systemd_.ready("watching " + name_of(session_->rules()));
  std::optional<Next> next;
  Time joined = session_->now();
  while (!stopped) {
    if (role_.has_changed(session_->lease(), session_->now(), joined)) {
      if (auto changed = change_role(desk, stopped); !changed) return changed;
      joined = session_->now();
    }
    look_at_neighbours();
    if (frame_.orders.is_kept_again())
      session_->announce(announcements::kKept, "the orders of people were not stored, and are now");
    watch_hearing(desk);
    // Without a journal, the actions under way would be lost: then the new rules wait for their
    // end.
    const bool has_to_wait = next && !frame_.records && session_->is_adapting();
    if (next && !has_to_wait) {
      change_rules(std::move(*next), desk);
      next.reset();
      joined = session_->now();  // its link has to find the others first
    }
    constexpr Duration kLook = std::chrono::milliseconds(100);
    constexpr Duration kLookAtRole = std::chrono::milliseconds(500);
    const bool is_waiting = has_to_wait || role_.role() == Role::kAdvise;
    const Time until = later(session_->now(), is_waiting ? kLook : kLookAtRole);
    session_->run(session_->deaf_since() ? until : std::min(until, systemd_.next_feeding()));
    if (auto newest = take_next()) next = std::move(newest);
  }
  systemd_.stopping();
  close(desk);
  for (const std::string& each : session_->unfinished())
    frame_.listener.on_remark("culprit: it ends in the middle of " + each +
                              (frame_.records ? "; the next `culprit run` finishes it\n"
                                              : ", and keeps no journal to finish it later\n"));
  session_->say_lease();
  session_->end();
  session_.reset();
  return {};
}

}  // namespace culprit::live
