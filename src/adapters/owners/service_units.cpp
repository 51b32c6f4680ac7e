#include "owners/service_units.h"

#include <algorithm>
#include <csignal>
#include <set>

#include "base/closest.h"
#include "base/invariant.h"
#include "base/live_clock.h"
#include "owners/proc.h"

namespace culprit::owners {
namespace {

using Activity = UnitState::Activity;

// PIDs are reused; two readings of one start differ by the clocks' rounding.
bool is_running(int pid, std::optional<Time> began) {
  constexpr Duration kSame = std::chrono::milliseconds(100);
  const auto begins = started_at(pid);
  return pid != 0 && began && begins && std::chrono::abs(*begins - *began) < kSame &&
         state_letter(pid).value_or('Z') != 'Z';
}

// It is a zombie, or was reaped.
bool has_ended(int pid) { return state_letter(pid).value_or('Z') == 'Z'; }

bool is_stopped(int pid) {
  const char state = state_letter(pid).value_or('Z');
  return state == 'T' || state == 't';
}

std::string in_words(const UnitState& state, const std::string& unit) {
  if (state.activity == Activity::kFailed) return unit + " failed: " + state.result;
  return unit + " is inactive";
}

Error not_loaded(const std::string& name, const UnitState& state, ServiceOwner& owner) {
  if (state.load_state != "not-found")
    return Error{owner.name() + " cannot use " + name + " (" + state.load_state +
                 "); see systemctl status"};
  std::string near;
  if (const auto all = owner.services()) {
    near = closest(name, std::vector<std::string_view>(all->begin(), all->end()));
  }
  return Error{owner.name() + " has no " + name +
               (near.empty() ? "; see " + owner.what_lists_all() : "; did you mean " + near + "?")};
}

Expected<void> could_manage_with(ServiceOwner& owner, const std::string& name) {
  const auto state = owner.state_of(name);
  if (!state) return Error{state.error()};
  if (!state->is_loaded) return not_loaded(name, *state, owner);
  return owner.may_manage(name);
}

}  // namespace

Units::Units(const RuleSet& rules, Inbox& inbox, Of whose, std::string host)
    : rules_(rules), inbox_(inbox), whose_(whose), host_(std::move(host)) {
  for (std::size_t c = 0; c < rules_.components.size(); ++c) {
    if (is_ours(ComponentId(c))) components_.push_back(ComponentId(c));
  }
  if (!components_.empty()) thread_ = std::thread([this] { run(); });
}

Units::~Units() {
  if (!thread_.joinable()) return;
  {
    const MutexLock lock(mutex_);
    is_ending_ = true;
  }
  something_came_.notify_all();
  thread_.join();
}

bool Units::is_ours(ComponentId component) const {
  const Component& what = rules_[component];
  return (whose_ == Of::kSystemd ? what.unit.has_value() : what.engine.has_value()) &&
         what.host() == host_;
}

const std::string& Units::name_of(ComponentId component) const {
  const Component& what = rules_[component];
  return whose_ == Of::kSystemd ? what.unit->name : what.engine->name;
}

ServiceOwner& Units::owner_of(ComponentId component) {
  const Component& what = rules_[component];
  if (whose_ == Of::kEngines)
    return what.engine->engine == EngineContainer::Engine::kDocker ? docker_ : podman_;
  return what.unit->is_of_user ? user_ : system_;
}

// PIDs of this computer mean nothing on another one.
bool Units::runs_here(int pid, std::optional<Time> began) const {
  return is_here() && is_running(pid, began);
}

Duration Units::idle_period() const {
  if (is_here()) return kIdlePeriod;
  return whose_ == Of::kSystemd ? kRemoteIdlePeriod : kEngineIdlePeriod;
}

void Units::found(ComponentId component, int pid) {
  if (components_.empty() || !is_here()) return;
  {
    const MutexLock lock(mutex_);
    found_.push_back({component, pid, started_at(pid)});
  }
  something_came_.notify_all();
}

void Units::start(CommandId command, ComponentId component) {
  add({command, component, Errand::Kind::kStart});
}

void Units::stop(CommandId command, ComponentId component, int pid, Ending ending, Hangs hangs) {
  const auto kind = ending == Ending::kToStartAgain ? Errand::Kind::kReplace : Errand::Kind::kEnd;
  add({command, component, kind, pid, started_at(pid), hangs});
}

Duration Units::polite_for(const Errand& errand) const {
  return errand.hangs == Hangs::kYes && is_here() ? Supervisor::kHung : kPolite;
}

void Units::add(Errand errand) {
  CULPRIT_ASSERT(is_ours(errand.component));  // another's unit would be asked to end
  errand.until = later(live_now(), kStart);
  errand.since = live_now();
  errand.latest = later(errand.since, kEnd);
  {
    const MutexLock lock(mutex_);
    errands_.push_back(std::move(errand));
  }
  something_came_.notify_all();
}

// ---- the thread

void Units::run() {
  std::vector<Errand> under_way;
  Time next_look = kLongAgo;
  MutexLock lock(mutex_);
  while (!is_ending_) {
    std::vector<Found> found = std::exchange(found_, {});
    std::move(errands_.begin(), errands_.end(), std::back_inserter(under_way));
    errands_.clear();
    lock.unlock();
    for (const Found& each : found) note(each);
    std::erase_if(under_way, [&](Errand& each) { return advance(each); });
    if (live_now() >= next_look) {
      look_at_all();
      look_for_work();
      next_look = later(live_now(), idle_period());
    }
    lock.lock();
    const auto has_news = [&]() CULPRIT_REQUIRES(mutex_) {
      return is_ending_ || !errands_.empty() || !found_.empty();
    };
    const Duration period = is_here() ? Duration(kPeriod) : Duration(kRemotePeriod);
    const Duration wait = under_way.empty() ? next_look - live_now() : period;
    something_came_.wait_for(lock, std::max(wait, Duration::zero()), has_news);
  }
}

void Units::look_at_all() {
  std::optional<std::string> trouble;
  for (const ComponentId component : components_) {
    ServiceOwner& owner = owner_of(component);
    const auto state = owner.state_of(name_of(component));
    if (state) {
      look_at(component, *state);
    } else if (!is_here() && !owner.was_reached()) {
      trouble = state.error();
      break;  // nor will the others be answered
    }
  }
  if (!is_here()) note_reach(trouble);
}

// A failed unit is proven to have exited, also if its node was never discovered, and if it never
// had a main process. An inactive one is proven to have exited only if it was active before: it may
// have been stopped on purpose before culprit started.
void Units::look_at(ComponentId component, const UnitState& state) {
  if (!state.is_loaded) return;
  const auto dump = dumps_.find(component);
  const bool is_dumping = dump != dumps_.end() && awaited_dump(component, dump->second.pid);
  if (!is_dumping && barred_.erase(component) > 0) inbox_.put(StartBarred{component, ""});
  if (state.is_over() && state.has_job) return;  // systemctl restart is half-way
  note_main_process(component, state);
  const auto before = before_.find(component);
  const bool is_first = before == before_.end();
  const bool has_ended =
      !is_first && before->second != Activity::kInactive && before->second != Activity::kFailed;
  const bool has_failed =
      state.activity == Activity::kFailed && (is_first || before->second != Activity::kFailed);
  before_.insert_or_assign(component, state.activity);
  if (state.is_over() && (has_failed || has_ended)) {
    const bool is_ours = ended_here_.contains(component);
    inbox_.put(ProcessSeen{component, ProcessState::kGone, is_here() ? state.last_main_pid : 0,
                           in_words(state, name_of(component)),
                           state.is_orderly && !is_ours ? Cause::kOrder : Cause::kUnknown});
  }
  note_successor(component, state);
}

// The process that culprit had ended may be seen once more before it is gone. A person may be ending its successor when
// that is first seen. If culprit knew no main process, the one that is being ended may have begun before its request.
void Units::note_successor(ComponentId component, const UnitState& state) {
  const auto ended_here = ended_here_.find(component);
  if (state.main_pid == 0 || ended_here == ended_here_.end() ||
      ended_here->second == state.main_pid)
    return;
  const bool is_being_ended = state.activity == Activity::kDeactivating;
  if (!state.is_over() && (!is_being_ended || ended_here->second != 0))
    ended_here_.erase(ended_here);
}

void Units::bar(ComponentId component, std::string why) {
  if (barred_.insert(component).second) inbox_.put(StartBarred{component, std::move(why)});
}

// The kernel reports an end sooner than it is known that a person had ordered it.
bool Units::is_news_of_an_order(const Errand& errand, const UnitState& state) const {
  const auto before = before_.find(errand.component);
  const bool ran = before != before_.end() && before->second != Activity::kInactive &&
                   before->second != Activity::kFailed;
  return errand.kind != Errand::Kind::kEnd && !errand.was_asked && ran && state.is_over() &&
         state.is_orderly && !state.has_job && !ended_here_.contains(errand.component);
}

// A lost connection is reported at once, and the return once the nodes had time to be discovered
// again.
void Units::note_reach(const std::optional<std::string>& trouble) {
  if (trouble) {
    // The error of a lost connection hardly gives the cause.
    constexpr int kEnough = 2;
    if (++failures_ < kEnough) return;
    returned_ = kLongAgo;
    if (!std::exchange(is_reached_, false)) return;
    inbox_.put(LinkTrouble{*trouble + "; until it answers, the state of what it runs is "
                                      "unknown"});
  } else {
    failures_ = 0;
    if (is_reached_) return;
    if (returned_ == kLongAgo) returned_ = live_now();
    if (live_now() < later(returned_, kReturn)) return;
    is_reached_ = true;
  }
  for (const ComponentId component : components_) inbox_.put(HostReached{component, is_reached_});
}

void Units::note_main_process(ComponentId component, const UnitState& state) {
  if (is_here() || state.main_pid == 0) return;
  const auto [known, is_first] = elsewhere_.try_emplace(component, Elsewhere{state.main_pid});
  if (!is_first && known->second.main_pid != state.main_pid)
    known->second = {state.main_pid, live_now()};
}

// Counts all processes in its session, which is the node's if `ros2 run` is the main process.
void Units::look_for_work() {
  const Time now = live_now();
  std::erase_if(coming_up_, [&](const ComingUp& each) {
    return now >= later(each.since, Supervisor::kComingUp) || !is_running(each.pid, each.began);
  });
  for (ComingUp& each : coming_up_) {
    const Work work = work_of_group(each.pid);
    if (each.work && work.is_more_than(*each.work))
      inbox_.put(ProcessWorked{each.component, each.pid});
    each.work = work;
  }
}

void Units::note(const Found& found) {
  std::erase_if(coming_up_,
                [&](const ComingUp& each) { return each.component == found.component; });
  last_found_[found.component] = found;
  if (!is_ours(found.component)) return;
  const auto state = owner_of(found.component).state_of(name_of(found.component));
  if (state && state->main_pid != 0 && is_running(found.pid, found.began))
    found_with_[found.component] = {found.pid, state->main_pid};
}

bool Units::answer(const Errand& errand, Outcome outcome, std::string text, int pid) {
  Reply reply{errand.command, outcome, {}, std::move(text)};
  // It may end before anybody looks.
  if (pid != 0) before_.insert_or_assign(errand.component, Activity::kActive);
  if (!is_here()) {
    // The main process that runs now is the one that the order asked for.
    elsewhere_.erase(errand.component);
    if (pid != 0) elsewhere_.emplace(errand.component, Elsewhere{pid});
    if (pid != 0) inbox_.put(ProcessSeen{errand.component, ProcessState::kRunning, 0, ""});
  } else if (pid != 0) {
    coming_up_.push_back({errand.component, pid, started_at(pid), live_now()});
    inbox_.put(ProcessSeen{errand.component, ProcessState::kRunning, pid, ""});
    reply.value = Value(std::int64_t{pid});
  }
  inbox_.put(std::move(reply));
  return true;
}

bool Units::advance(Errand& errand) {
  const std::string& name = name_of(errand.component);
  ServiceOwner& owner = owner_of(errand.component);
  const auto state = owner.state_of(name);
  if (!state) {
    // A lost connection is made again.
    if (!is_here() && !owner.was_reached() && live_now() < later(errand.since, kReconnect))
      return false;
    if (errand.was_asked && live_now() < std::min(errand.until, errand.latest)) return false;
    const bool is_away = is_here() && !owner.was_reached() && !errand.was_asked;
    if (is_away && errand.kind != Errand::Kind::kEnd)
      bar(errand.component, state.error().substr(0, state.error().rfind("; ")));
    return answer(errand, errand.was_asked ? Outcome::kTimedOut : Outcome::kRefused, state.error());
  }
  if (!state->is_loaded) {
    const std::string why = not_loaded(name, *state, owner).message;
    bar(errand.component, why);
    return answer(errand, Outcome::kRefused, why);
  }
  if (is_news_of_an_order(errand, *state)) {
    look_at(errand.component, *state);
    return answer(errand, Outcome::kRefused,
                  in_words(*state, name) + ": " + owner.name() + " was told to end it");
  }
  note_successor(errand.component, *state);
  if (!errand.was_asked) note_main_process(errand.component, *state);
  const bool is_start = errand.kind == Errand::Kind::kStart;
  if (!errand.was_asked) return is_start ? begin_start(errand, *state) : begin_end(errand, *state);
  return is_start ? watch_start(errand, *state) : watch_end(errand, *state);
}

// ---- starting

bool Units::begin_start(Errand& errand, const UnitState& state) {
  CULPRIT_ASSERT(errand.kind == Errand::Kind::kStart && !errand.was_asked);
  const std::string& name = name_of(errand.component);
  // systemd has not noticed yet.
  if (is_here() && state.main_pid != 0 && has_ended(state.main_pid) && live_now() < errand.until)
    return false;
  if (!state.is_over() && state.activity != Activity::kDeactivating)
    return answer(errand, Outcome::kDone,
                  owner_of(errand.component).name() + " has started " + name, state.main_pid);
  if (state.has_job)
    return answer(errand, Outcome::kDone,
                  owner_of(errand.component).name() + " is about to start " + name);
  if (const auto asked = owner_of(errand.component).start(name); !asked)
    return answer(errand, Outcome::kRefused, asked.error());
  errand.was_asked = true;
  errand.until = later(live_now(), kStart);
  return false;
}

bool Units::watch_start(Errand& errand, const UnitState& state) {
  CULPRIT_ASSERT(errand.kind == Errand::Kind::kStart && errand.was_asked);
  const std::string& name = name_of(errand.component);
  if (state.main_pid != 0) return answer(errand, Outcome::kDone, "", state.main_pid);
  if (!state.has_job && state.is_over())
    return answer(errand, Outcome::kRefused,
                  owner_of(errand.component).name() +
                      " could not start it: " + in_words(state, name) + "; see " +
                      owner_of(errand.component).where_to_look(name));
  // The steps before the main process (ExecStartPre) may take long.
  return live_now() >= errand.until &&
         answer(errand, Outcome::kDone, owner_of(errand.component).name() + " is starting " + name);
}

// ---- ending

// Errors of systemd are for the request itself to find.
std::optional<std::string> Units::would_end_too(ComponentId component) {
  for (const auto& [other, found] : last_found_) {
    if (other == component || !is_running(found.pid, found.began)) continue;
    const auto is_its = owner_of(component).runs(name_of(component), found.pid);
    if (is_its && *is_its) return rules_[other].name;
  }
  return std::nullopt;
}

// An order to end for good is done also if a debugger holds the process.
std::optional<std::string> Units::hold_of(const Errand& errand, const UnitState& state) {
  if (errand.kind != Errand::Kind::kReplace || !is_here()) return std::nullopt;
  for (const int pid : {errand.pid, state.main_pid}) {
    if (pid == 0) continue;
    if (auto hold = hold_of_debugger(pid)) return hold;
    const auto dump = awaited_dump(errand.component, pid);
    if (!dump) continue;
    bar(errand.component, *dump);
    return name_of(errand.component) + " is not ended: " + *dump;
  }
  return std::nullopt;
}

// As Supervisor's.
std::optional<std::string> Units::awaited_dump(ComponentId component, int pid) {
  auto text = is_here() && pid != 0 ? core_dump_of(pid) : std::nullopt;
  if (!text) return std::nullopt;
  Dump& dump = dumps_[component];
  if (dump.pid != pid) dump = {pid, later(live_now(), Supervisor::kDump)};
  return live_now() < dump.until ? std::move(text) : std::nullopt;
}

bool Units::begin_end(Errand& errand, const UnitState& state) {
  CULPRIT_ASSERT(errand.kind != Errand::Kind::kStart && !errand.was_asked);  // ended twice
  const std::string& name = name_of(errand.component);
  ServiceOwner& bus = owner_of(errand.component);
  if (!is_here() && errand.pid != 0)
    return answer(errand, Outcome::kRefused,
                  "process " + std::to_string(errand.pid) + " is of this computer, and " +
                      rules_[errand.component].name + " is declared to run on " + host_ +
                      ": nothing is ended; correct HOST, or end by hand what should not be here");
  const bool runs = runs_here(errand.pid, errand.began);
  if (runs) {
    const auto is_its = bus.runs(name, errand.pid);
    if (!is_its) return answer(errand, Outcome::kRefused, is_its.error());
    if (!*is_its)
      return answer(errand, Outcome::kRefused,
                    "process " + std::to_string(errand.pid) + " is not ended: it is not of " +
                        name +
                        ", which was not asked to end either; end it by hand, or correct "
                        "the rules of " +
                        rules_[errand.component].name);
  }
  // systemd has not noticed yet.
  if (!runs && errand.pid != 0 && state.main_pid == errand.pid && live_now() < errand.until)
    return false;
  const bool is_to_replace = errand.kind == Errand::Kind::kReplace;
  if (!runs && state.is_over() && !state.has_job) return answer(errand, Outcome::kDone, "");
  // A request to restart it would take the place of a person's to end it.
  const bool is_being_ended = state.activity == Activity::kDeactivating && state.has_job;
  if (is_to_replace && is_being_ended && !ended_here_.contains(errand.component))
    return live_now() >= errand.until &&
           answer(errand, Outcome::kRefused,
                  bus.name() + " was told to end " + name + ", and has not finished");
  const auto elsewhere = elsewhere_.find(errand.component);
  if (is_to_replace && elsewhere != elsewhere_.end() &&
      live_now() < later(elsewhere->second.since, kFresh))
    return answer(errand, Outcome::kDone, bus.name() + " has started it again");
  if (is_to_replace && errand.pid != 0 && !runs) {
    // systemd started it again, or will; but not where what has ended was a child of the main
    // process, which does not know.
    const auto found = found_with_.find(errand.component);
    const bool is_left = found != found_with_.end() && state.main_pid != 0 &&
                         found->second == std::pair(errand.pid, state.main_pid);
    if (!is_left) return answer(errand, Outcome::kDone, bus.name() + " starts it again");
  }
  if (auto hold = hold_of(errand, state))
    return answer(errand, Outcome::kRefused, std::move(*hold));
  if (const auto other = would_end_too(errand.component))
    return answer(errand, Outcome::kRefused,
                  name + " runs " + *other + ", too, and would end it; give " +
                      rules_[errand.component].name + " a unit of its own");
  const auto asked =
      is_to_replace ? bus.restart(name, polite_for(errand)) : bus.stop(name, polite_for(errand));
  if (!asked) return answer(errand, Outcome::kRefused, asked.error());
  ended_here_.insert_or_assign(errand.component, state.main_pid);
  errand.was_asked = true;
  errand.main_pid = state.main_pid;
  const bool acts = !is_here() || (!is_stopped(errand.pid) && !is_stopped(errand.main_pid));
  errand.escalate = acts ? later(live_now(), polite_for(errand)) : live_now();
  errand.until = errand.latest;
  return false;
}

bool Units::watch_end(Errand& errand, const UnitState& state) {
  // A unit that was to start would be killed.
  CULPRIT_ASSERT(errand.kind != Errand::Kind::kStart && errand.was_asked);
  const std::string& name = name_of(errand.component);
  const bool is_left_by_systemd = errand.kind == Errand::Kind::kEnd
                                      ? state.is_over() && !state.has_job
                                      : state.main_pid != errand.main_pid || state.is_over();
  const bool runs = runs_here(errand.pid, errand.began);
  if (is_left_by_systemd && !runs) return answer(errand, Outcome::kDone, "");
  const Time now = live_now();
  if (now >= errand.until) {
    return answer(errand, Outcome::kTimedOut,
                  runs && is_left_by_systemd
                      ? "process " + std::to_string(errand.pid) + " goes on although " +
                            owner_of(errand.component).name() + " ended " + name +
                            (whose_ == Of::kSystemd ? "; what is its KillMode=?" : "")
                      : owner_of(errand.component).name() + " did not end " + name + " in time");
  }
  // Never the successor: only while the process is still the one that is to end.
  if (now >= errand.escalate && !is_left_by_systemd && errand.main_pid != 0 &&
      state.main_pid == errand.main_pid) {
    errand.escalate = later(now, polite_for(errand));
    if (awaited_dump(errand.component, errand.main_pid)) return false;
    if (const auto killed = owner_of(errand.component).kill(name); !killed)
      inbox_.put(LinkTrouble{killed.error()});
  }
  return false;
}

// ---- all of them

AllUnits::AllUnits(const RuleSet& rules, Inbox& inbox) {
  std::set<std::pair<Units::Of, std::string>> made;
  for (const Component& each : rules.components) {
    const auto whose = each.unit ? Units::Of::kSystemd : Units::Of::kEngines;
    if (each.has_owner() && made.emplace(whose, each.host()).second)
      all_.push_back(std::make_unique<Units>(rules, inbox, whose, each.host()));
  }
}

void AllUnits::found(ComponentId component, int pid) {
  for (const auto& each : all_) each->found(component, pid);
}

Units* AllUnits::of(ComponentId component) {
  const auto its = std::find_if(all_.begin(), all_.end(),
                                [&](const auto& each) { return each->is_ours(component); });
  return its == all_.end() ? nullptr : its->get();
}

// ---- before anything breaks

Expected<void> could_manage(const SystemdUnit& unit) {
  SystemdBus bus(unit.is_of_user ? SystemdBus::Whose::kUser : SystemdBus::Whose::kSystem,
                 unit.host);
  return could_manage_with(bus, unit.name);
}

Expected<void> could_manage(const EngineContainer& container) {
  Engine engine(container.engine, container.host);
  return could_manage_with(engine, container.name);
}

}  // namespace culprit::owners
