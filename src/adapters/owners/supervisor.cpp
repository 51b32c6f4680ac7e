#include "owners/supervisor.h"

#include <algorithm>
#include <csignal>
#include <poll.h>
#include <sys/wait.h>

#include "owners/bounded_log.h"
#include "owners/launch_note.h"
#include "owners/mark.h"
#include "owners/process_tree.h"

namespace culprit::owners {
namespace {

using namespace std::chrono_literals;

// PIDs are reused.
bool was_there(int pid, Time known) {
  const auto started = started_at(pid);
  return started && *started <= known;
}

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
      launchers_(rules, programs_.log_folder, inbox) {
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
  end_what_is_left(component, "");
  const int launcher = launchers_.running(component);
  note_launch(programs_.log_folder, rules_[component].name, launcher);
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
  const bool has_ended = state_letter(pid).value_or('X') == 'Z';
  if (!has_ended && was_there(pid, known)) return adopt(component, pid, known);
  const MutexLock lock(mutex_);
  if (is_gone(component))
    inbox_.put(ProcessSeen{component, ProcessState::kGone, pid, "it ended unseen"});
}

void Supervisor::watch(ComponentId component, int pid, Relation relation) {
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
  const PlaceHeld noted = noted_launch(programs_.log_folder, rules_[component].name);
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

// ---- ending

// Why it is not proven that the process is the component's; nothing if it is.
std::optional<std::string> Supervisor::doubt(const Member& member) const {
  const int pid = member.process.pid();
  if (member.process.relation() != Relation::kAdopted ||
      carries_mark(pid, programs_.mark(member.component)))
    return std::nullopt;
  const auto found = identities_.find(member.component);
  const auto identity = identity_of(pid);
  if (!identity && member.process.state() == ProcessState::kGone) return std::nullopt;
  const std::string process = "process " + std::to_string(pid);
  if (!identity || found == identities_.end())
    return process + " is not ended: its program is unknown";
  if (*identity == found->second) return std::nullopt;
  return process + " is not ended: it runs " + to_string(*identity) + ", but " +
         rules_[member.component].name + " was " + to_string(found->second) +
         "; if that is right, restart culprit";
}

// A child of it may be the node.
std::optional<std::string> Supervisor::hold_of(const Member& member) {
  std::vector<int> all{member.process.pid()};
  if (member.process.relation() != Relation::kAdopted) all = members_of_group(all.front());
  for (const int pid : all) {
    if (auto hold = hold_of_debugger(pid)) return hold;
  }
  return std::nullopt;
}

std::optional<std::string> Supervisor::why_not_end(ComponentId component, Ending ending) const {
  for (const Member& member : members_) {
    if (member.component != component) continue;
    if (auto why = doubt(member)) return why;
    if (ending == Ending::kForGood) continue;  // it is to end in any case
    if (auto why = hold_of(member)) return why;
  }
  const Component& what = rules_[component];
  if (!what.is_respawned) return std::nullopt;
  if (!launchers_.restarts(component)) {
    if (!what.launch.empty() || ending == Ending::kForGood) return std::nullopt;
    return "the launcher of " + what.name +
           " has exited, and nothing else would start it again: it has no LAUNCH command";
  }
  if (ending == Ending::kForGood)
    return what.name + " is RESPAWNED: its launcher would start it again";
  return std::nullopt;
}

void Supervisor::stop(CommandId command, ComponentId component, int pid, Ending ending,
                      Hangs hangs) {
  const MutexLock lock(mutex_);
  std::set<std::uint64_t> meant = meant_by(component, pid);
  if (meant.empty() && !is_gone(component))
    return answer(command, Outcome::kDone, "process " + std::to_string(pid) + " has a successor");
  if (auto why = why_not_end(component, ending))
    return answer(command, Outcome::kRefused, std::move(*why));
  const auto trial = std::ranges::find(trials_, component, &Trial::component);
  if (trial != trials_.end()) {
    trial->commands.push_back(command);
    if (hangs == Hangs::kYes) trial->hangs = hangs;
  } else if (ending == Ending::kForGood || is_gone(component) || launchers_.restarts(component) ||
             shutdown_of(component) != nullptr) {
    begin_shutdown(command, component, hangs, std::move(meant));
  } else {
    const auto environment = programs_.environment(component);
    if (!environment)
      return answer(
          command, Outcome::kRefused,
          rules_[component].name +
              " is not ended, because it could not be started again: " + environment.error());
    const auto lock_of_start = programs_.lock_start(component);
    if (!lock_of_start) return answer(command, Outcome::kRefused, lock_of_start.error());
    auto launch = Launch::begin(programs_.program(component, 0), Until::kItCouldRun);
    if (!launch) return answer(command, Outcome::kRefused, launch.error());
    trials_.push_back({{command},
                       component,
                       std::move(*launch),
                       later(live_now(), kTrial),
                       hangs,
                       std::move(meant)});
  }
  wake();
}

void Supervisor::finish_trials(Time now) {
  for (Trial& trial : trials_) {
    const bool is_over = is_readable(trial.launch.descriptor());
    if (!is_over && now < trial.until) continue;
    const std::string& name = rules_[trial.component].name;
    const auto could_run =
        is_over ? trial.launch.outcome()
                : Expected<void>(Error{"its start was tried and hung for " +
                                       culprit::to_string(kTrial) +
                                       "; does the file system of its program answer?"});
    if (is_over && !could_run) note_missing(trial.launch, trial.component, could_run.error());
    for (const CommandId command : trial.commands) {
      if (could_run) {
        begin_shutdown(command, trial.component, trial.hangs, trial.meant);
      } else {
        answer(command, Outcome::kRefused,
               name + " is not ended, because it could not be started again: " + could_run.error());
      }
    }
    trial.until = kLongAgo;
  }
  std::erase_if(trials_, [](const Trial& t) { return t.until == kLongAgo; });
}

Supervisor::Shutdown* Supervisor::shutdown_of(ComponentId component) {
  const auto found = std::ranges::find_if(shutdowns_, [&](const Shutdown& s) {
    return s.component == component && !s.is_of_launch && s.escalate != kNever;
  });
  return found == shutdowns_.end() ? nullptr : &*found;
}

// A process that hangs cannot use the rest of its time.
void Supervisor::hurry(Shutdown& shutdown) {
  if (shutdown.hangs == Hangs::kYes) return;
  shutdown.hangs = Hangs::kYes;
  if (shutdown.signal == SIGINT) shutdown.escalate -= kPolite - kHung;
  if (shutdown.signal == SIGTERM) shutdown.escalate = live_now();
}

void Supervisor::begin_shutdown(CommandId command, ComponentId component, Hangs hangs,
                                std::set<std::uint64_t> meant) {
  Shutdown* const present = shutdown_of(component);
  if (present != nullptr && std::ranges::includes(present->meant, meant)) {
    if (hangs == Hangs::kYes) hurry(*present);
    shutdowns_.push_back({command, component, hangs, std::move(meant)});
    return;
  }
  for (Member& member : members_) {
    if (!meant.contains(member.number) || member.process.relation() != Relation::kAdopted) continue;
    member.left = descendants_of(member.process.pid());
    member.left_at = live_now();
  }
  Shutdown& shutdown =
      shutdowns_.emplace_back(Shutdown{command, component, hangs, std::move(meant)});
  shutdown.escalate = live_now();
}

// A process that was started before it, as `ros2 run` was, is meant, too. One that began later is a successor.
std::set<std::uint64_t> Supervisor::meant_by(ComponentId component, int pid) const {
  std::set<std::uint64_t> numbers = members_of(component);
  const auto last = ended_.find(component);
  const bool has_ended = last != ended_.end() && last->second.first == pid;
  if (pid != 0 && has_ended && !is_known(component, pid))
    std::erase_if(numbers, [&](std::uint64_t number) { return number > last->second.second; });
  return numbers;
}

std::set<std::uint64_t> Supervisor::members_of(ComponentId component) const {
  std::set<std::uint64_t> numbers;
  for (const Member& member : members_) {
    if (member.component == component) numbers.insert(member.number);
  }
  return numbers;
}

std::set<std::uint64_t> Supervisor::started_members_of(ComponentId component) const {
  std::set<std::uint64_t> numbers;
  for (const Member& member : members_) {
    if (member.component == component && was_started(member)) numbers.insert(member.number);
  }
  return numbers;
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

void Supervisor::withdraw(ComponentId component) {
  const MutexLock lock(mutex_);
  begin_shutdown({}, component, Hangs::kNo, started_members_of(component));
  wake();
}

void Supervisor::end_with_launch(ComponentId component) {
  const MutexLock lock(mutex_);
  std::set<std::uint64_t> meant = started_members_of(component);
  for (const Shutdown& under_way : shutdowns_) {
    for (const std::uint64_t number : under_way.meant) meant.erase(number);
  }
  if (meant.empty()) return;
  Shutdown& shutdown =
      shutdowns_.emplace_back(Shutdown{{}, component, Hangs::kNo, std::move(meant)});
  shutdown.is_of_launch = true;
  shutdown.escalate = live_now();
  wake();
}

void Supervisor::stands_in_for_none(ComponentId component) {
  const MutexLock lock(mutex_);
  note_launch(programs_.log_folder, rules_[component].name, 0);
}

bool Supervisor::was_started(const Member& member) const {
  return member.process.relation() != Relation::kAdopted ||
         carries_mark(member.process.pid(), programs_.mark(member.component));
}

bool Supervisor::is_meant(const Shutdown& shutdown, const Member& member) {
  return shutdown.meant.contains(member.number);
}

bool Supervisor::is_over(const Shutdown& shutdown) const {
  return std::ranges::none_of(members_, [&](const Member& m) { return is_meant(shutdown, m); });
}

void Supervisor::stop_all() {
  MutexLock lock(mutex_);
  std::set<ComponentId> started;
  for (const Member& member : members_) {
    if (member.process.relation() == Relation::kChild) started.insert(member.component);
  }
  for (const ComponentId component : started)
    begin_shutdown({}, component, Hangs::kNo, members_of(component));
  wake();
  something_ended_.wait(lock, [&]() CULPRIT_REQUIRES(mutex_) {
    return std::all_of(started.begin(), started.end(),
                       [&](ComponentId c) CULPRIT_REQUIRES(mutex_) { return is_gone(c); });
  });
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

void Supervisor::end_member(Member& member) {
  // Children of the process must not live on beside its successor. While it is not reaped, no other
  // group can have its number.
  member.process.kill_group();
  const ProcessEnd end = member.process.reap();
  const bool is_ours =
      std::ranges::any_of(shutdowns_, [&](const Shutdown& s) { return is_meant(s, member); });
  if (is_ours || end.cause == Cause::kFault) {
    for (const FileDescriptor& each : member.tree) send_signal(each, SIGKILL);
    if (!member.variable.empty()) end_what_is_left(member.component, member.variable);
  }
  ports_.keep(member.process.pid());  // before anybody can order a successor
  inbox_.put(ProcessSeen{member.component, ProcessState::kGone, member.process.pid(), end.remark,
                         is_ours ? Cause::kWish : end.cause});
  ended_[member.component] = {member.process.pid(), member.number};
  tell_what_stays(member);
  if (member.process.relation() == Relation::kAdopted)
    launchers_.note_end(member.component, member.process.pid());
}

// It is waited for, but not for long: the successor needs what it holds.
void Supervisor::end_what_is_left(ComponentId component, const std::string& variable) const {
  if (!programs_.robot.empty()) kill_left(programs_.mark(component), variable, kLeftEnds);
}

// Ctrl-Z stops the processes that were started together, and their launcher.
Cause Supervisor::cause_of_stop(const Member& member) const {
  return launchers_.is_stopped(member.component) ? Cause::kWish : Cause::kFault;
}

// Children of a process that somebody else started are not ours to end.
void Supervisor::tell_what_stays(const Member& member) const {
  std::string stays;
  for (const Relative& each : member.left) {
    const bool has_ended = state_letter(each.pid).value_or('X') == 'Z';
    if (!has_ended && was_there(each.pid, member.left_at))
      stays += (stays.empty() ? "" : ", ") + std::to_string(each.pid) + " (" + each.command + ")";
  }
  if (!stays.empty())
    inbox_.put(LinkTrouble{rules_[member.component].name + " was ended and left running: process " +
                           stays});
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

void Supervisor::finish_shutdowns(Time now) {
  for (Shutdown& shutdown : shutdowns_) {
    if (!is_over(shutdown)) {
      if (shutdown.escalate <= now) escalate(shutdown, now);
    } else if (shutdown.command != CommandId{}) {
      answer(shutdown.command, Outcome::kDone, "");
    }
  }
  std::erase_if(shutdowns_, [&](const Shutdown& s) CULPRIT_REQUIRES(mutex_) { return is_over(s); });
}

void Supervisor::escalate(Shutdown& shutdown, Time now) {
  const bool is_stopped = std::any_of(members_.begin(), members_.end(), [&](const Member& m) {
    return is_meant(shutdown, m) && m.state == ProcessState::kStopped;
  });
  const bool hangs = shutdown.hangs == Hangs::kYes && shutdown.signal == SIGINT;
  if (is_stopped || hangs || shutdown.signal == SIGTERM || shutdown.signal == SIGKILL) {
    shutdown.signal = SIGKILL;
    shutdown.escalate = later(now, kFirm);
  } else if (shutdown.signal == SIGINT) {
    shutdown.signal = SIGTERM;
    shutdown.escalate = later(now, shutdown.is_of_launch ? kOfLaunch : kFirm);
  } else {
    shutdown.signal = SIGINT;
    shutdown.escalate = later(now, shutdown.is_of_launch           ? kOfLaunch
                                   : shutdown.hangs == Hangs::kYes ? kHung
                                                                   : kPolite);
  }
  for (Member& member : members_) {
    if (!is_meant(shutdown, member)) continue;
    member.tree.clear();
    if (shutdown.signal == SIGKILL) ports_.note(member.process.pid());
    if (!member.variable.empty())
      member.tree = signal_descendants(member.process.pid(), member.variable, shutdown.signal);
    member.process.signal(shutdown.signal);
  }
}

}  // namespace culprit::owners
