#include "owners/supervisor.h"

#include <algorithm>
#include <csignal>
#include <poll.h>
#include <sys/wait.h>

#include "base/invariant.h"
#include "owners/bounded_log.h"
#include "owners/launch_note.h"
#include "owners/mark.h"
#include "owners/process_tree.h"

namespace culprit::owners {
namespace {

using namespace std::chrono_literals;

bool is_child(int pid) {
  siginfo_t info{};
  return waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED | WNOHANG | WNOWAIT) == 0;
}

}  // namespace

Supervisor::Supervisor(const RuleSet& rules, Options options, Inbox& inbox)
    : rules_(rules),
      inbox_(inbox),
      programs_{rules,
                std::move(options.log_folder),
                std::move(options.search_first),
                std::move(options.robot),
                options.lifetime,
                std::move(options.environments)},
      launchers_(programs_, inbox) {
  for (std::size_t c = 0; c < rules_.components.size(); ++c) take_over(ComponentId(c));
  {
    const MutexLock lock(mutex_);
    ports_.keep_earlier();
  }
  thread_ = std::thread([this] { run(); });
}

Supervisor::~Supervisor() {
  {
    const MutexLock lock(mutex_);
    is_ending_ = true;
  }
  wake();
  thread_.join();
}

void Supervisor::answer(CommandId command, Outcome outcome, std::string text) const {
  inbox_.put(Reply{command, outcome, {}, std::move(text)});
}

void Supervisor::take_over(ComponentId component) {
  if (programs_.robot.empty() || rules_[component].launch.empty()) return;
  for (const int pid : launched_as(programs_.mark(component))) {
    if (!is_known(component, pid)) watch(component, pid, Relation::kMarked);
  }
}

// ---- starting

void Supervisor::start(CommandId command, ComponentId component) {
  const Component& what = rules_[component];
  const MutexLock lock(mutex_);
  // The parent of its launcher may be what restarts it; without a LAUNCH there is no other way.
  if (launchers_.restarts(component) || (what.is_respawned && what.launch.empty()))
    return answer(command, Outcome::kDone, "its launcher starts it again");
  if (what.launch.empty())
    return answer(command, Outcome::kUnreachable, what.name + " has no LAUNCH command");
  if (!is_gone(component)) return meet(command, component);
  if (const auto begun = begin_start(command, component); !begun)
    return answer(command, Outcome::kUnreachable, begun.error());
  wake();
}

// A process that a killed culprit had started, and that has no node yet, fulfils the order.
void Supervisor::meet(CommandId command, ComponentId component) {
  const auto coming_up = std::ranges::find_if(members_, [&](const Member& member) {
    return member.component == component && member.awaited && !member.launch &&
           member.state == ProcessState::kRunning && state_letter(member.process.pid()) != 'T';
  });
  if (coming_up == members_.end())
    return answer(command, Outcome::kRefused, rules_[component].name + " is running already");
  const int pid = coming_up->process.pid();
  inbox_.put(ProcessSeen{component, ProcessState::kRunning, pid, ""});
  inbox_.put(Reply{command, Outcome::kDone, Value(std::int64_t{pid}), ""});
}

Expected<void> Supervisor::begin_start(CommandId command, ComponentId component) {
  if (const auto environment = programs_.environment(component); !environment)
    return Error{environment.error()};
  auto lock = programs_.lock_start(component);
  if (!lock) return Error{lock.error()};
  // A process that was started before no longer holds the lock, and is found here.
  take_over(component);
  if (!is_gone(component)) {
    meet(command, component);
    return {};
  }
  CULPRIT_ASSERT(is_gone(component));  // it would run twice
  end_what_is_left(component, "");
  const int launcher = launchers_.running(component);
  note_launch(programs_.log_folder, programs_.mark(component), launcher);
  Program program = programs_.program(component, launcher);
  program.kept_until_it_runs = lock->get();
  auto launch = Launch::begin(program, Until::kItRuns);
  if (!launch) return Error{launch.error()};
  // Nothing runs unwatched: if it cannot be held, the launch goes, and kills it.
  auto process = WatchedProcess::watch(launch->pid(), Relation::kChild);
  if (!process) return Error{process.error()};
  Member& member = members_.emplace_back(Member{++numbers_, component, std::move(*process),
                                                ProcessState::kRunning, std::move(*launch), command,
                                                std::move(*lock)});
  member.launcher = launcher;
  member.variable = variable_of(member.process.pid());
  return {};
}

// Those whose programs run by now, or never will.
void Supervisor::finish_starts() {
  for (Member& member : members_) {
    if (!member.launch || !is_readable(member.launch->descriptor())) continue;
    // The answer of another's process would be taken for it.
    CULPRIT_ASSERT(member.process.relation() == Relation::kChild);
    const auto runs = member.launch->outcome();
    if (!runs) note_missing(*member.launch, member.component, runs.error());
    member.launch.reset();
    member.lock = FileDescriptor();
    member.awaited = live_now();
    if (!runs) {
      answer(member.command, Outcome::kUnreachable, runs.error());
      member.state = ProcessState::kGone;  // it is reaped, and was never the component
      continue;
    }
    const int pid = member.process.pid();
    inbox_.put(StartedHere{member.component, pid, member.launcher});
    inbox_.put(ProcessSeen{member.component, ProcessState::kRunning, pid, ""});
    inbox_.put(Reply{member.command, Outcome::kDone, Value(std::int64_t{pid}), ""});
  }
  std::erase_if(members_, [](const Member& m) { return m.state == ProcessState::kGone; });
}

// ---- starts that cannot happen now

void Supervisor::note_missing(const Launch& launch, ComponentId component,
                              const std::string& what) {
  if (!launch.is_missing_something()) return;
  inbox_.put(StartBarred{component, what});
  if (std::ranges::find(barred_, component, &Barred::component) == barred_.end())
    barred_.push_back({component, {}, later(live_now(), kMissingPeriod)});
}

// The supervisor does not wait for the file system: another process looks.
void Supervisor::look_for_missing(Time now) {
  std::erase_if(barred_, [&](Barred& each) CULPRIT_REQUIRES(mutex_) {
    if (each.trial && is_readable(each.trial->descriptor())) {
      const auto is_ready = each.trial->outcome();
      const bool is_there = is_ready || !each.trial->is_missing_something();
      each.trial.reset();
      each.next = later(now, kMissingPeriod);
      if (is_there) inbox_.put(StartBarred{each.component, ""});
      return is_there;
    }
    if (each.trial || now < each.next) return false;
    each.next = later(now, kMissingPeriod);
    if (auto launch = Launch::begin(programs_.program(each.component, 0), Until::kItIsReady))
      each.trial = std::move(*launch);
    return false;
  });
}

// ---- taking over what runs

void Supervisor::adopt(ComponentId component, int pid, Time known) {
  const MutexLock lock(mutex_);
  for (Member& member : members_) {
    if (member.component == component) member.awaited.reset();
  }
  ports_.note(pid);
  if (is_known(component, pid)) return;
  if (!was_there(pid, known)) {
    inbox_.put(ProcessSeen{component, ProcessState::kGone, pid, "ended"});
    return;
  }
  watch(component, pid, Relation::kAdopted);
}

void Supervisor::adopt_again(ComponentId component, int pid, Time known) {
  if (pid == 0) return;
  const bool has_ended = state_letter(pid).value_or('X') == 'Z';
  if (!has_ended && was_there(pid, known)) return adopt(component, pid, known);
  const MutexLock lock(mutex_);
  if (is_gone(component))
    inbox_.put(ProcessSeen{component, ProcessState::kGone, pid, "it ended unseen"});
}

void Supervisor::watch(ComponentId component, int pid, Relation relation) {
  CULPRIT_ASSERT(!is_known(component, pid));  // its end would be reaped twice
  // A supervisor before this one may have started it.
  if (is_child(pid)) relation = Relation::kChild;
  auto process = WatchedProcess::watch(pid, relation);
  if (!process) {
    inbox_.put(ProcessSeen{component, ProcessState::kGone, pid, process.error()});
    return;
  }
  const bool is_others =
      relation == Relation::kAdopted && !carries_mark(pid, programs_.mark(component));
  if (const auto identity = is_others ? identity_of(pid) : std::nullopt) {
    const bool is_first = identities_.try_emplace(component, *identity).second;
    if (is_first) tell_of_unit(component, pid);
  }
  launchers_.note_process(component, pid, is_others);
  Member& member = members_.emplace_back(Member{++numbers_, component, std::move(*process)});
  const bool is_marked = carries_mark(pid, programs_.mark(component));
  if (relation != Relation::kAdopted && is_marked) member.awaited = live_now();
  const PlaceHeld marked = is_marked ? place_held_by(pid) : PlaceHeld{};
  // A mark stays, and the note goes once the process is to go on without the launch.
  const PlaceHeld noted = noted_launch(programs_.log_folder, programs_.mark(component));
  const PlaceHeld place = noted.launcher == marked.launcher ? marked : PlaceHeld{};
  if (is_marked) {
    const auto began = started_at(pid);
    inbox_.put(StartedHere{component, pid, place.launcher,
                           began ? std::max(Duration::zero(), live_now() - *began) : Duration()});
  }
  inbox_.put(ProcessSeen{component, ProcessState::kRunning, pid, ""});
  if (was_started(member)) member.variable = variable_of(pid);
  launchers_.report(component);
  if (place.launcher != 0 && !place.goes_on)
    inbox_.put(LauncherSeen{component, place.launcher, true});
  wake();
}

// Both systemd (Restart=) and culprit would start it.
void Supervisor::tell_of_unit(ComponentId component, int pid) const {
  const Component& what = rules_[component];
  const auto unit = what.launch.empty() || what.is_respawned ? std::nullopt : unit_started_as(pid);
  if (unit)
    inbox_.put(LinkTrouble{what.name + " has a LAUNCH, but systemd runs it as " + unit->name +
                           ", and may start it beside culprit: declare UNIT " + unit->name +
                           (unit->is_of_user ? " USER" : "") + " instead"});
}

// ---- one process too many

std::set<int> Supervisor::started(ComponentId component) const {
  const MutexLock lock(mutex_);
  const auto is_its = [&](const auto& each) { return each.component == component; };
  if (std::ranges::any_of(shutdowns_, is_its) || std::ranges::any_of(trials_, is_its)) return {};
  std::set<int> all;
  for (const Member& member : members_) {
    if (member.component != component || !was_started(member)) continue;
    if (member.launch) return {};
    all.insert(member.process.pid());
    if (member.process.relation() == Relation::kAdopted) continue;
    for (const int pid : members_of_group(member.process.pid())) all.insert(pid);
  }
  return all;
}

bool Supervisor::is_known(ComponentId component, int pid) const {
  return std::any_of(members_.begin(), members_.end(), [&](const Member& m) {
    return m.process.pid() == pid && m.component == component;
  });
}

bool Supervisor::has_started(ComponentId component) const {
  const MutexLock lock(mutex_);
  return !is_gone(component) &&
         std::none_of(members_.begin(), members_.end(),
                      [&](const Member& m) { return m.component == component && !was_started(m); });
}

bool Supervisor::is_gone(ComponentId component) const {
  return std::none_of(members_.begin(), members_.end(),
                      [&](const Member& m) { return m.component == component; });
}

// Ctrl-Z stops the processes that were started together, and their launcher unless that is a shell.
Cause Supervisor::cause_of_stop(const Member& member) const {
  if (member.process.is_frozen()) return Cause::kOrder;
  const bool is_of_person = launchers_.is_stopped_with(member.component, member.process.pid());
  return is_of_person ? Cause::kWish : Cause::kFault;
}

// ---- the thread

Time Supervisor::next_deadline() const {
  Time next = kNever;
  for (const Shutdown& shutdown : shutdowns_) next = std::min(next, shutdown.escalate);
  for (const Trial& trial : trials_) next = std::min(next, trial.until);
  for (const Barred& each : barred_) {
    if (!each.trial) next = std::min(next, each.next);
  }
  for (const Member& member : members_) {
    if (member.stands_since) next = std::min(next, later(*member.stands_since, kStopSettles));
  }
  return next;
}

void Supervisor::wake() { wake_file_.wake(); }

void Supervisor::run() {
  MutexLock lock(mutex_);
  Time next_look = live_now();
  Time next_look_at_logs = next_look;
  std::vector<std::filesystem::path> logs;
  while (!is_ending_) {
    std::vector<pollfd> watched{{wake_file_.descriptor(), POLLIN, 0}};
    for (const Member& member : members_) {
      watched.push_back({member.process.descriptor(), POLLIN, 0});
      if (member.launch) watched.push_back({member.launch->descriptor(), POLLIN, 0});
    }
    for (const Trial& trial : trials_) watched.push_back({trial.launch.descriptor(), POLLIN, 0});
    for (const Barred& each : barred_) {
      if (each.trial) watched.push_back({each.trial->descriptor(), POLLIN, 0});
    }
    launchers_.add_to(watched);
    const Time until = members_.empty() ? next_deadline() : std::min(next_look, next_deadline());
    const auto wait =
        until == kNever ? Duration(-1) : std::max(Duration::zero(), until - live_now());
    lock.unlock();
    // Without the lock: a slow disk must block no caller.
    for (const std::filesystem::path& log : std::exchange(logs, {})) bound_log(log);
    // Round up: a deadline that is a fraction of a millisecond away must not be polled for in a
    // hurry.
    const auto milliseconds =
        wait < Duration::zero()
            ? -1
            : static_cast<int>(std::chrono::ceil<std::chrono::milliseconds>(wait).count());
    poll(watched.data(), watched.size(), milliseconds);
    wake_file_.clear();
    lock.lock();
    const Time now = live_now();
    look(now);
    if (now < next_look) continue;
    next_look = later(now, kStatePeriod);
    if (now < next_look_at_logs) continue;
    next_look_at_logs = later(now, kLogPeriod);
    for (const Member& member : members_) logs.push_back(programs_.log(member.component));
    launchers_.look_at_children();
  }
}

void Supervisor::look(Time now) {
  finish_starts();
  for (Member& member : members_) {
    if (member.launch) continue;
    const ProcessState state = member.process.state();
    // Its wrapper may run on.
    if (member.is_dump_awaited && !awaited_dump(member, now)) await_dump_no_more(member);
    if (state == ProcessState::kGone) end_member(member);
    if (!is_settled(member, state, now)) continue;
    if (state != member.state && state != ProcessState::kGone) {
      inbox_.put(
          ProcessSeen{member.component, state, member.process.pid(), "",
                      state == ProcessState::kStopped ? cause_of_stop(member) : Cause::kUnknown});
    }
    member.state = state;
    look_for_work(member, now);
  }
  std::erase_if(members_, [](const Member& m) { return m.state == ProcessState::kGone; });
  finish_trials(now);
  look_for_missing(now);
  finish_shutdowns(now);
  launchers_.report_ended();
  something_ended_.notify_all();
}

// Ctrl-Z reaches one process after the other, and may reach the launcher last.
bool Supervisor::is_settled(Member& member, ProcessState state, Time now) {
  if (state != ProcessState::kStopped || member.state == ProcessState::kStopped) {
    member.stands_since.reset();
    return true;
  }
  if (!member.stands_since) member.stands_since = now;
  return now >= later(*member.stands_since, kStopSettles);
}

// Counts its whole group: the node may be a child of the tool that runs it.
void Supervisor::look_for_work(Member& member, Time now) {
  if (!member.awaited || member.state != ProcessState::kRunning ||
      now < later(member.worked_at, kWorkPeriod))
    return;
  if (now >= later(*member.awaited, kComingUp)) return member.awaited.reset();
  const Work work = work_of_group(member.process.pid());
  if (member.work && work.is_more_than(*member.work))
    inbox_.put(ProcessWorked{member.component, member.process.pid()});
  member.work = work;
  member.worked_at = now;
}

}  // namespace culprit::owners
