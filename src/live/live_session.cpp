#include "live/live_session.h"

#include <algorithm>
#include <set>
#include <unistd.h>

#include <fmt/core.h>

#include "base/amount.h"
#include "journal/requests.h"
#include "knowledge/describe.h"
#include "live/handover.h"
#include "live/health.h"
#include "live/launch.h"
#include "live/role.h"
#include "live/setups.h"
#include "live/stays_down.h"
#include "owners/launch_note.h"
#include "owners/proc.h"
#include "replay/replay.h"

namespace culprit::live {
namespace {

ros2::Severity severity_in_rosout(EventSeverity severity) {
  switch (severity) {
    case EventSeverity::kInfo:
      break;
    case EventSeverity::kWarning:
      return ros2::Severity::kWarn;
    case EventSeverity::kError:
      return ros2::Severity::kError;
  }
  return ros2::Severity::kInfo;
}

// Names of the nodes that no other culprit may manage, whatever name it gives to the robot.
std::vector<std::string> claimed_nodes(const RuleSet& rules) {
  std::vector<std::string> nodes;
  for (const ComponentId c : adapted_components(rules))
    nodes.push_back(rules[c].node.empty() ? "*/" + rules[c].name : rules[c].node);
  return nodes;
}

void add(KnownRobot& known, const KnownRobot& more) {
  known.parts.insert(known.parts.end(), more.parts.begin(), more.parts.end());
  known.topics.insert(known.topics.end(), more.topics.begin(), more.topics.end());
  for (const auto& [status, node] : more.publishers) known.publishers[status] = node;
}

// The manager and its journal begin from the same record, so that a replay begins from it too.
journal::Session session_of(const LiveSession::Frame& frame, const std::string& rules_text,
                            const RuleSet& rules, int domain, Time start,
                            std::optional<Time> watched_since, const RunBeginning& beginning) {
  const LiveSession::Options& options = frame.options;
  journal::Session session;
  session.version = options.version;
  session.robot = rules.robot;
  session.rules_path = options.rules_file;
  session.rules_text = rules_text;
  session.planner = options.planner_record;
  session.governor = options.governor_record;
  session.advises = frame.advises;
  session.domain = domain;
  session.process = getpid();
  session.boot = journal::boot_id();
  session.start = start;
  session.wall = wall_now();
  session.watched_since = watched_since;
  session.discovery = options.discovery;
  session.forgetting = options.forgetting;
  session.learned = beginning.learned;
  session.interrupted = beginning.interrupted;
  session.past = journal::to_json(beginning.past, rules);
  session.known_robot = journal::to_json(beginning.known_robot);
  session.is_paused = beginning.orders.pause.has_value();
  session.is_dry_run = beginning.orders.dry_run.has_value();
  session.orders_kept = frame.orders.is_kept();
  if (frame.fleet != nullptr && frame.records) session.fleet_context = frame.fleet->context();
  return session;
}

// Also those that left the graph while culprit did not watch, for example because they were
// stopped. Not where the rules name another node now.
void adopt_again(LiveRobot& robot, const History& past, const Discovered& discovered) {
  for (const Event& event : past) {
    const auto* found = std::get_if<ComponentFound>(&event.what);
    if (found != nullptr && discovered.has(found->component))
      robot.adopt_again(found->component, found->pid, event.at);
  }
}

// The journal's statements on processes hold only for those that have run since then. PIDs are
// reused.
void forget_other_processes(KnownRobot& known, const History& past, const RuleSet& rules) {
  for (KnownRobot::Part& part : known.parts) {
    const auto component = journal::find_component(rules, part.component);
    std::optional<Time> found;
    for (const Event& event : past) {
      const auto* seen = std::get_if<ComponentFound>(&event.what);
      if (seen == nullptr || !component || seen->component != *component) continue;
      found = seen->pid == part.pid ? std::optional(event.at) : std::nullopt;
    }
    const auto started = found ? owners::started_at(part.pid) : std::nullopt;
    if (!started || *started > *found) part.pid = 0;
  }
}

// In the order in which it happened.
void add(History& past, const History& more) {
  for (const Event& event : more) {
    const auto next = std::find_if(past.begin(), past.end(),
                                   [&](const Event& each) { return each.at > event.at; });
    past.insert(next, event);
  }
}

}  // namespace

Expected<std::unique_ptr<LiveSession>> LiveSession::open(const Frame& frame, LoadedRules rules) {
  LiveRobot::Options setup = frame.options.robot;
  std::unique_ptr<LiveSession> session(new LiveSession(frame, std::move(rules)));
  if (frame.lease) {
    setup.link.lease = {
        .claim = *frame.lease, .manages = !frame.advises, .told_orders = [&keeper = frame.orders] {
          return journal::to_text(keeper.told(), journal::clocks_now(live_now()));
        }};
    setup.link.lease->claim.nodes = claimed_nodes(session->rules_);
  }
  session->domain_ = static_cast<int>(setup.link.participant.domain);
  setup.supervisor.robot =
      fmt::format("{}/{}", setup.link.participant.domain, session->rules_.robot);
  const auto environments = environments_of(session->rules_);
  setup.supervisor.environments = environments;
  auto robot = LiveRobot::open(session->rules_, std::move(setup));
  if (!robot) return Error{robot.error()};
  session->robot_ = std::move(*robot);
  for (std::size_t c = 0; c < environments.size(); ++c) {
    if (!environments[c])
      session->robot_->report(session->rules_.components[c].name +
                              " can be neither started nor replaced: " + environments[c].error());
  }
  return session;
}

LiveSession::LiveSession(const Frame& frame, LoadedRules rules)
    : frame_(frame), rules_(std::move(rules.rules)), source_(std::move(rules.source)) {}

LiveSession::~LiveSession() {
  leave_fleet();
  if (is_observed_) frame_.observer->leaves();
}

void LiveSession::submit(Order order) { runtime_->submit(std::move(order)); }

KnownRobot LiveSession::known_robot() const { return manager_->knowledge().known_robot(); }

LoadedRules LiveSession::loaded_rules() const { return {rules_, source_, ""}; }

void LiveSession::say_lease() {
  if (link::LeaseLink* lease = robot_->link().lease()) lease->say();
}

RunBeginning LiveSession::look_back() {
  const std::filesystem::path& path = frame_.options.journal;
  if (frame_.records)
    return begin_journal(path, rules_, {robot_->now(), wall_now(), domain_}, frame_.manager_before);
  if (!frame_.options.no_journal.empty()) return begin_without_journal(path, robot_->now());
  return {};
}

// Collects the orders of the last run and of this process. The orders of the previous manager
// override our file, unless the file is later.
void LiveSession::hold(RunBeginning& beginning) {
  std::string trouble;
  if (const auto& told = frame_.told_orders) {
    const bool is_later = told->revision > beginning.orders.revision;
    beginning.orders = is_later ? *told : both(beginning.orders, *told);
    beginning.are_orders_kept = false;
    if (const auto& pause = told->pause)
      beginning.findings.push_back((pause->author == "culprit"
                                        ? pause->reason
                                        : "the culprit that managed before was paused by " +
                                              pause->author +
                                              (pause->reason.empty() ? "" : ": " + pause->reason)) +
                                   "; so it is paused until a person resumes it");
  }
  if (!frame_.options.no_journal.empty()) {
    beginning.orders = frame_.orders.begin_without(frame_.options.no_journal, beginning.orders);
  } else if (!frame_.records) {
    beginning.orders =
        frame_.orders.begin_advising("another culprit manages this robot; give orders to that one");
  } else if (beginning.is_of_another) {
    beginning.orders =
        frame_.orders.begin_without("another culprit writes the journal", beginning.orders);
  } else {
    beginning.orders = frame_.orders.begin(journal::orders_beside(frame_.options.journal),
                                           beginning.orders, beginning.are_orders_kept, trouble);
  }
  if (!trouble.empty()) beginning.findings.push_back("orders are not kept: " + trouble);
  for (Event& silence : journal::to_past(beginning.orders, rules_, robot_->now()))
    beginning.past.push_back(std::move(silence));
}

// The previous manager's own account overrides what our journal has of the time before.
void LiveSession::inherit(RunBeginning& beginning) {
  const auto& told = frame_.told_inheritance;
  if (!told) return;
  if (!*told) {
    beginning.findings.push_back(
        "the beliefs and attempts of the culprit that managed before are unknown (" +
        told->error() + "); limits count only the actions that this one knows");
    return;
  }
  journal::inherit(beginning.learned, (*told)->learned);
  beginning.past = journal::still_counting(journal::joined(beginning.past, (*told)->past, rules_),
                                           robot_->now(), rules_);
  beginning.findings.push_back(
      fmt::format("culprit takes over the beliefs in {}, and the attempts, of the culprit that "
                  "managed before",
                  amount_of((*told)->learned.beliefs.size(), "strategy", "strategies")));
}

void LiveSession::begin(const std::atomic<bool>& stop, const KnownRobot& known_robot) {
  begin(stop, known_robot, nullptr, {});
}

// `before`: what was seen until now, null: nothing. `orders`: with the first step.
void LiveSession::begin(const std::atomic<bool>& stop, const KnownRobot& known_robot,
                        const SeenSoFar* before, std::vector<Order> orders) {
  RunBeginning beginning = look_back();
  add(beginning.known_robot, known_robot);
  robot_->remember_hosts(beginning.known_robot);
  inherit(beginning);
  hold(beginning);
  for (const std::string& finding : beginning.findings)
    frame_.listener.on_remark("culprit: " + finding + "\n");
  std::vector<Observation> seen;
  std::optional<Time> watched_since;
  if (before != nullptr) {
    seen = before->observations();
    watched_since = std::max(before->since(), robot_->now() - frame_.options.discovery);
  }
  const bool is_held = beginning.orders.pause || beginning.orders.dry_run;
  const std::filesystem::path kept =
      frame_.options.no_journal.empty() ? launching_beside(frame_.options.journal) : "";
  LaunchKeeper keeper{read_unfinished(kept), frame_.options.launches, {}, {}, beginning.past};
  if ((keeper.starts_missing || !keeper.left.empty()) && !frame_.advises && !is_held) {
    keeper.runs = [&](ComponentId c) { return robot_->supervisor().has_started(c); };
    keeper.keep = [&](const Unfinished& unfinished) {
      if (kept.empty()) return;
      if (const auto written = write_unfinished(kept, unfinished); !written)
        frame_.listener.on_remark("culprit: cannot store the components that are being launched: " +
                                  written.error() + "\n");
    };
    const auto start = [&](CommandId command, ComponentId component) {
      robot_->start(command, component);
    };
    // A culprit that succeeds another one, or is restarted after a crash, was not started to bring back what a
    // person ended.
    if (frame_.told_inheritance || beginning.ended_unexpectedly)
      keeper.stay_down = that_stay_down(beginning.past);
    Launched launched = launch(*robot_, rules_, start, frame_.listener, stop, {}, keeper);
    seen = std::move(launched.seen);
    forget_that_stay_down(launched.parts, rules_, beginning.past);
    add(beginning.known_robot, {std::move(launched.parts), {}});
    add(beginning.past, launched.past);
  }
  const auto go_on_with = [&](const journal::StandingOrders::Said& said, auto order) {
    seen.push_back({robot_->now(), Order{0, said.author, said.reason, order}});
  };
  if (beginning.orders.pause) go_on_with(*beginning.orders.pause, Pause{});
  if (beginning.orders.dry_run && !frame_.advises)
    go_on_with(*beginning.orders.dry_run, SetDryRun{true});
  for (Order& order : orders) seen.push_back({robot_->now(), std::move(order)});
  manage(std::move(beginning), std::move(seen), "", watched_since);
}

// Components to be launched need a session of their own, which looks for them first.
bool LiveSession::can_take_over() const {
  const bool has_to_launch = frame_.options.launches ||
                             (frame_.options.no_journal.empty() &&
                              !read_unfinished(launching_beside(frame_.options.journal)).empty());
  return seen_ && seen_->is_whole() && lease() != nullptr && !has_to_launch;
}

Expected<void> LiveSession::take_over(const Frame& frame,
                                      const std::map<std::string, std::string>& elsewhere,
                                      const std::atomic<bool>& stop) {
  if (auto announced = robot_->link().lease()->take_over(frame.lease->term); !announced)
    return announced;
  const KnownRobot known = known_robot();
  const SeenSoFar before = *std::exchange(seen_, std::nullopt);
  std::vector<Order> orders = to_leave_alone(elsewhere);
  end();
  runtime_.reset();
  manager_.reset();
  frame_.advises = frame.advises;
  frame_.records = frame.records;
  frame_.lease = frame.lease;
  frame_.told_orders = frame.told_orders;
  frame_.told_inheritance = frame.told_inheritance;
  frame_.manager_before = frame.manager_before;
  begin(stop, known, &before, std::move(orders));
  return {};
}

void LiveSession::begin(Handover before) {
  RunBeginning beginning = look_back();
  // The manager's knowledge is kept, whether or not the journal could be written.
  beginning.learned = std::move(before.learned);
  beginning.orders = frame_.orders.orders();
  add(beginning.known_robot, before.known_robot);
  robot_->remember_hosts(beginning.known_robot);
  add(beginning.past, before.verdicts);
  manage(std::move(beginning), std::move(before.orders), std::move(before.occasion));
}

void LiveSession::manage(RunBeginning beginning, std::vector<Observation> seen,
                         std::string occasion, std::optional<Time> watched_since) {
  if (frame_.options.has_preflight && preflight_ == nullptr)
    preflight_ = std::make_unique<Preflight>(
        source_, frame_.options.message_path,
        [&listener = frame_.listener](const std::string& lines) { listener.on_remark(lines); });
  KnownRobot& known = beginning.known_robot;
  // One of another machine may be about to be heard of, and go before this one.
  const bool has_rivals = frame_.lease && !frame_.lease->key.empty();
  known.is_whole = known.is_whole && !has_rivals && beginning.last_rules == source_.text();
  forget_other_processes(known, beginning.past, rules_);
  forget_the_renamed(known, rules_, beginning.past);
  keep_down_what_ended_unseen(beginning);
  robot_->link().remember_publishers(known.publishers);
  if (known.is_whole)
    robot_->link().prove_listening(later(robot_->now(), frame_.options.discovery));
  journal::Session session = session_of(frame_, std::string(source_.text()), rules_, domain_,
                                        robot_->now(), watched_since, beginning);
  session.occasion = std::move(occasion);
  const Autonomy autonomy = frame_.advises ? Autonomy::kAdvise : Autonomy::kAct;
  manager_ = replay::manager_for(session, rules_, frame_.options.planner(),
                                 {autonomy, frame_.options.governor});
  adopt_again(*robot_, beginning.past, manager_->knowledge().discovered);
  bequest_.reset();
  if (!frame_.advises && frame_.lease && !frame_.lease->key.empty()) {
    bequest_.emplace(rules_);
    for (const Event& event : beginning.past) bequest_->add(event);
    is_bequest_new_ = true;
  }
  if (frame_.advises && frame_.lease) seen_.emplace(rules_, robot_->now());
  if (frame_.records) record(session, beginning);
  make_runtime();
  publish_health();
  // No order was before the beginning.
  for (Observation& each : seen) {
    if (std::holds_alternative<Order>(each.what)) each.at = session.start;
  }
  join_fleet();
  runtime_->step(seen);
  bequeath();
}

void LiveSession::record(const journal::Session& session, RunBeginning& beginning) {
  journal::Recorder::Options recorder;
  recorder.path = frame_.options.journal;
  recorder.wall_clock = wall_now;
  recorder.unwritten = std::move(beginning.unwritten);
  recorder.on_trouble = [this](const std::string& what) { robot_->report(what); };
  recorder_ = std::make_unique<journal::Recorder>(std::move(beginning.writer), std::move(recorder),
                                                  session, manager_->knowledge());
}

void LiveSession::make_runtime() {
  runtime_ = std::make_unique<Runtime>(*manager_, *robot_);
  if (Observer* observer = frame_.observer; observer != nullptr) {
    is_observed_ = true;
    observer->joined(robot_->link().entry());
    observer->begins(
        *manager_, [this] { return robot_->link().contested(); }, frame_.start);
    runtime_->next_look = [observer] { return observer->next_look(); };
  }
  // Each request is journaled before it is sent; others are informed afterwards.
  runtime_->before_commands = [this](const Runtime::Step& step) {
    if (recorder_ == nullptr) return;
    std::vector<Observation> observations = step.observations;
    recorder_->before_commands(step.now, observations, step.commands, step.events);
  };
  runtime_->on_step = [this](const Runtime::Step& step) {
    if (recorder_ != nullptr && !step.commands.empty()) recorder_->after_commands();
    if (seen_) seen_->note(step.observations);
    if (frame_.observer != nullptr) frame_.observer->stepped(step);
    if (recorder_ != nullptr && step.commands.empty())
      recorder_->stepped(step.now, step.observations, {}, step.events);
    withdraw_doubles();
    end_with_launches();
    note_what_goes_on();
  };
  runtime_->on_events = [this](std::span<const Event> events) { tell(events); };
}

// Sends the successor what was learned and tried, if it is new, and not for each step of many.
void LiveSession::bequeath() {
  link::LeaseLink* lease = robot_->link().lease();
  if (!bequest_ || lease == nullptr) return;
  const Time now = robot_->now();
  if (!is_bequest_new_ || now < later(bequeathed_, link::ManagerLease::kPeriod)) return;
  is_bequest_new_ = false;
  bequeathed_ = now;
  lease->tell_state(
      bequest_->text(learned_by(manager_->knowledge()), link::ManagerLease::kLongestState));
}

// A culprit that only advises learns nothing, and writes nothing.
void LiveSession::join_fleet() {
  if (frame_.fleet == nullptr || !frame_.records) return;
  is_in_fleet_ = true;
  frame_.fleet->begins(
      rules_, [this](PriorsTold priors) { robot_->tell(std::move(priors)); },
      [this](const std::string& trouble) { robot_->report(trouble); });
}

void LiveSession::leave_fleet() {
  if (std::exchange(is_in_fleet_, false)) frame_.fleet->ends();
}

// Not what a person, or another culprit, wants to be left alone, nor while a strategy changes it.
void LiveSession::withdraw_doubles() {
  if (manager_->autonomy() == Autonomy::kAdvise || !manager_->hears()) return;
  const Governor& governor = manager_->governor();
  if (governor.is_paused() || frame_.options.governor.approval == Approval::kEach) return;
  robot_->withdraw_doubles([&](ComponentId component) {
    const bool is_silenced = std::ranges::any_of(
        governor.silences(), [&](const auto& each) { return each.what == Silenceable(component); });
    return !is_silenced && manager_->knowledge().states.reservation(component) == nullptr;
  });
}

// A person's pause holds that back, too.
void LiveSession::end_with_launches() {
  if (manager_->autonomy() == Autonomy::kAdvise || manager_->governor().is_paused()) return;
  const Departures& departures = manager_->knowledge().departures;
  for (std::size_t c = 0; c < rules_.components.size(); ++c) {
    const ComponentId component(c);
    const int pid = departures.to_end(component);
    if (pid == 0) {
      ending_.erase(component);
    } else if (std::exchange(ending_[component], pid) != pid) {
      robot_->supervisor().end_with_launch(component);
    }
  }
}

// The next culprit finds the ended launch in the process's environment, and must not take its end for one that
// nobody saw.
void LiveSession::note_what_goes_on() {
  for (const Departures::Started& each : manager_->knowledge().departures.started()) {
    if (each.launcher == 0 && std::exchange(free_[each.component], each.pid) != each.pid)
      robot_->supervisor().stands_in_for_none(each.component);
  }
}

// If no process of a launch is left, and its launcher exited while no culprit watched, a person may have ended it. For a single component, this cannot be
// distinguished from a crash.
void LiveSession::keep_down_what_ended_unseen(RunBeginning& beginning) const {
  if (frame_.options.launches || frame_.options.governor.revives_in_doubt) return;
  const std::set<ComponentId> stay_down = that_stay_down(beginning.past);
  std::map<int, std::set<ComponentId>> ended;  // by launcher
  std::set<int> run_on;
  for (const Event& event : beginning.past) {
    const auto* found = std::get_if<ComponentFound>(&event.what);
    if (found == nullptr || rules_[found->component].has_owner()) continue;
    const owners::PlaceHeld place = owners::noted_launch(
        frame_.options.robot.supervisor.log_folder,
        fmt::format("{}/{}/{}", domain_, rules_.robot, rules_[found->component].name));
    if (place.launcher == 0 || place.goes_on) continue;
    ended[place.launcher].insert(found->component);
    const auto began = owners::started_at(found->pid);
    const bool is_there =
        began && *began <= event.at && owners::state_letter(found->pid).value_or('Z') != 'Z';
    if (is_there && !robot_->supervisor().has_started(found->component))
      run_on.insert(place.launcher);
  }
  for (auto& [launcher, components] : ended) {
    if (components.size() < 2 || run_on.contains(launcher)) continue;
    std::erase_if(components, [&](ComponentId each) { return stay_down.contains(each); });
    if (components.empty()) continue;
    beginning.past.push_back(
        {robot_->now(),
         StaysDown{{components.begin(), components.end()}, StaysDown::Why::kUnseen, launcher}});
  }
}

void LiveSession::publish_health() {
  const Reception reception = manager_->hears() ? Reception::kWorks : Reception::kLost;
  robot_->link().publish(health(manager_->knowledge(), reception));
}

void LiveSession::tell(std::span<const Event> events) {
  is_bequest_new_ |= !events.empty();
  for (const Event& event : events) {
    if (bequest_) bequest_->add(event);
    frame_.listener.on_event(event, rules_, frame_.start);
    const std::string text = describe(event, rules_);
    if (!text.empty()) robot_->link().log(severity_in_rosout(severity_of(event, rules_)), text);
  }
  publish_health();
  if (is_in_fleet_) frame_.fleet->happened();
  bequeath();
}

void LiveSession::announce(const EventWords& words, const std::string& text) {
  const Time now = robot_->now();
  frame_.listener.on_announcement(now - frame_.start, words, text);
  if (frame_.observer != nullptr) frame_.observer->announced(now, words, text);
  robot_->link().log(severity_in_rosout(words.severity), text);
}

std::set<std::string> LiveSession::adapted_nodes() const {
  std::set<std::string> nodes;
  for (const ComponentId c : adapted_components(rules_)) {
    const std::string& seen = manager_->knowledge().graph.node_name(c);
    nodes.insert(seen.empty() ? rules_[c].node : seen);
  }
  nodes.erase("");
  return nodes;
}

void LiveSession::leave_alone(const std::map<std::string, std::string>& nodes) {
  for (Order& order : to_leave_alone(nodes)) submit(std::move(order));
}

// Only new orders.
std::vector<Order> LiveSession::to_leave_alone(
    const std::map<std::string, std::string>& nodes) const {
  constexpr const char* kAuthor = "another culprit";
  std::vector<Order> orders;
  const auto& silences = manager_->governor().silences();
  for (const ComponentId c : adapted_components(rules_)) {
    const std::string& seen = manager_->knowledge().graph.node_name(c);
    const auto found = nodes.find(seen.empty() ? rules_[c].node : seen);
    const auto silence = std::find_if(silences.begin(), silences.end(), [&](const auto& each) {
      return each.what == Silenceable(c);
    });
    const bool is_silent = silence != silences.end();
    const bool is_ours = is_silent && silence->author == kAuthor;
    if (found == nodes.end()) {
      if (is_ours) orders.push_back({0, kAuthor, "it is gone", LiftSilence{c}});
      continue;
    }
    const std::string why = "it manages " + found->first + ": " + found->second;
    if (!is_silent || (is_ours && silence->reason != why))
      orders.push_back({0, kAuthor, why, Silence{c, {}}});
  }
  return orders;
}

void LiveSession::run(Time until) {
  runtime_->run(is_left_, until);
  is_left_ = false;
  bequeath();
}

void LiveSession::leave() {
  is_left_ = true;
  robot_->interrupt();
}

bool LiveSession::is_adapting() const {
  for (const RuleId id : manager_->knowledge().states.active()) {
    if (manager_->knowledge().states[id].attempt) return true;
  }
  return false;
}

std::vector<std::string> LiveSession::unfinished() const {
  std::vector<std::string> all;
  for (const RuleId id : manager_->knowledge().states.active()) {
    const auto& attempt = manager_->knowledge().states[id].attempt;
    const bool has_changed =
        attempt && attempt->stage == Attempt::Stage::kAdapting && attempt->first_change != kNever;
    if (has_changed) all.push_back(rules_[attempt->strategy].name + " for " + rules_[id].name);
  }
  return all;
}

Handover LiveSession::hand_over(const RuleSet& next, std::string occasion) {
  end();
  const Time sees = later(robot_->now(), frame_.options.discovery);
  return {learned_by(manager_->knowledge()), known_robot(),
          waiting_verdicts(manager_->knowledge(), next, sees),
          standing_orders(*manager_, frame_.advises, next, robot_->now()), std::move(occasion)};
}

void LiveSession::end(journal::Ending ending) {
  leave_fleet();
  if (recorder_ == nullptr) return;
  if (const auto written = recorder_->end(ending); !written)
    frame_.listener.on_trouble(written.error());
  recorder_.reset();
}

}  // namespace culprit::live
