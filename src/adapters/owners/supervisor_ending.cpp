// How the supervisor ends processes: the proof that each is the component's, the signals one after the other, and what
// is told of those that stay.
#include <algorithm>
#include <csignal>

#include "base/invariant.h"
#include "owners/launch_note.h"
#include "owners/mark.h"
#include "owners/proc.h"
#include "owners/process_tree.h"
#include "owners/supervisor.h"

namespace culprit::owners {

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

// A child of it may be the node. It has crashed, so nothing of it works any more.
std::optional<std::string> Supervisor::awaited_dump(Member& member, Time now) {
  std::vector<int> all{member.process.pid()};
  if (member.process.relation() != Relation::kAdopted) all = members_of_group(all.front());
  for (const int pid : all) {
    auto dump = core_dump_of(pid);
    if (!dump) continue;
    if (!member.dump_until) {
      member.dump_until = later(now, kDump);
      member.is_dump_awaited = true;
      inbox_.put(StartBarred{member.component, *dump});
    }
    return now < *member.dump_until ? std::move(dump) : std::nullopt;
  }
  member.dump_until.reset();  // it is complete: another one is waited for anew
  return std::nullopt;
}

void Supervisor::await_dump_no_more(Member& member) {
  if (std::exchange(member.is_dump_awaited, false)) inbox_.put(StartBarred{member.component, ""});
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
  for (Member& member : members_) {
    if (member.component != component || ending == Ending::kForGood) continue;
    if (const auto dump = awaited_dump(member, live_now()))
      return answer(command, Outcome::kRefused, rules_[component].name + " is not ended: " + *dump);
  }
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
  note_launch(programs_.log_folder, programs_.mark(component), 0);
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

void Supervisor::end_member(Member& member) {
  CULPRIT_ASSERT(!member.launch);  // which reaps it itself, if it does not run
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
  await_dump_no_more(member);
  inbox_.put(ProcessSeen{member.component, ProcessState::kGone, member.process.pid(), end.remark,
                         is_ours ? Cause::kWish : cause_of_end(member, end)});
  ended_[member.component] = {member.process.pid(), member.number};
  tell_what_stays(member);
  if (member.process.relation() == Relation::kAdopted)
    launchers_.note_end(member.component, member.process.pid());
}

// A unit's or a container's owner knows better whether it was told to end it.
Cause Supervisor::cause_of_end(const Member& member, const ProcessEnd& end) const {
  const auto found = identities_.find(member.component);
  const bool is_in_doubt = end.remark == exited(kExceptionInPython).remark &&
                           found != identities_.end() && runs_python(found->second) &&
                           !rules_[member.component].has_owner();
  const bool may_be_wanted = end.cause == Cause::kWish || is_in_doubt;
  if (may_be_wanted && launchers_.ran_in_foreground(member.component, member.process.pid()))
    return Cause::kOrder;
  return is_in_doubt ? Cause::kDoubt : end.cause;
}

// It is waited for, but not for long: the successor needs what it holds.
void Supervisor::end_what_is_left(ComponentId component, const std::string& variable) const {
  if (!programs_.robot.empty()) kill_left(programs_.mark(component), variable, kLeftEnds);
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
  for (Member& member : members_) {
    if (!is_meant(shutdown, member) || !awaited_dump(member, now)) continue;
    shutdown.escalate = later(now, kStatePeriod);
    return;
  }
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
    CULPRIT_ASSERT(member.component == shutdown.component);  // another's process would be ended
    member.tree.clear();
    if (shutdown.signal == SIGKILL) ports_.note(member.process.pid());
    if (!member.variable.empty())
      member.tree = signal_descendants(member.process.pid(), member.variable, shutdown.signal);
    member.process.signal(shutdown.signal);
  }
}

}  // namespace culprit::owners
