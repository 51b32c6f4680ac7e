#include "process/supervisor.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <poll.h>
#include <set>
#include <sys/eventfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include "process/proc.h"
#include "process/spawn.h"

namespace culprit::process {
namespace {

constexpr const char* kPidVariable = "CULPRIT_PROCESS";

// Not one that it started in turn, which inherits the mark.
bool is_what_was_launched(int pid) {
  return has_variable(pid, kPidVariable + ("=" + std::to_string(pid)));
}

// Numbers are given out anew.
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
      options_(std::move(options)),
      inbox_(inbox),
      wake_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  for (std::size_t c = 0; c < rules_.components.size(); ++c) take_over(ComponentId(c));
  thread_ = std::thread([this] { run(); });
}

Supervisor::~Supervisor() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  wake();
  thread_.join();
}

std::string Supervisor::mark(ComponentId component) const {
  return "CULPRIT_COMPONENT=" + options_.robot + "/" + rules_[component].name;
}

void Supervisor::take_over(ComponentId component) {
  if (options_.robot.empty() || rules_[component].launch.empty()) return;
  for (const int pid : processes_with(mark(component))) {
    const bool has_ended = state_letter(pid).value_or('X') == 'Z';
    if (!has_ended && pid != getpid() && is_what_was_launched(pid))
      adopt(component, pid, live_now());
  }
}

void Supervisor::adopt_again(ComponentId component, int pid, Time known) {
  const bool has_ended = state_letter(pid).value_or('X') == 'Z';
  if (!has_ended && was_there(pid, known)) adopt(component, pid, known);
}

void Supervisor::start(CommandId command, ComponentId component) {
  const Component& what = rules_[component];
  const auto answer = [&](Outcome outcome, decltype(Reply::value) value, std::string text) {
    inbox_.put(Reply{command, outcome, std::move(value), std::move(text)});
  };
  if (what.launch.empty())
    return answer(Outcome::kUnreachable, {}, what.name + " has no LAUNCH command");
  take_over(component);
  const std::lock_guard lock(mutex_);
  // The old process must be proven gone before a new one takes its place.
  if (!is_gone(component)) return answer(Outcome::kRefused, {}, what.name + " is running already");
  Program program{
      what.launch, options_.search_first, options_.log_folder / (what.name + ".log"), {}};
  if (!options_.robot.empty()) {
    program.environment = {mark(component)};
    program.pid_variable = kPidVariable;
  }
  const auto pid = spawn(program);
  if (!pid) return answer(Outcome::kUnreachable, {}, pid.error());
  auto process = WatchedProcess::watch(*pid, Relation::kChild);
  if (!process) return answer(Outcome::kUnreachable, {}, process.error());
  members_.push_back({component, std::move(*process), Relation::kChild, ProcessState::kRunning});
  inbox_.put(ProcessSeen{component, ProcessState::kRunning, *pid, ""});
  answer(Outcome::kDone, Value(std::int64_t{*pid}), "");
  wake();
}

void Supervisor::adopt(ComponentId component, int pid, Time known) {
  const std::lock_guard lock(mutex_);
  if (is_known(component, pid)) return;
  if (!was_there(pid, known)) {
    inbox_.put(ProcessSeen{component, ProcessState::kGone, pid, "ended"});
    return;
  }
  // A supervisor before this one may have started it.
  const Relation relation = is_child(pid) ? Relation::kChild : Relation::kAdopted;
  auto process = WatchedProcess::watch(pid, relation);
  if (!process) {
    inbox_.put(ProcessSeen{component, ProcessState::kGone, pid, process.error()});
    return;
  }
  members_.push_back({component, std::move(*process), relation, ProcessState::kRunning});
  inbox_.put(ProcessSeen{component, ProcessState::kRunning, pid, ""});
  wake();
}

void Supervisor::stop(CommandId command, ComponentId component) {
  const std::lock_guard lock(mutex_);
  begin_shutdown(command, component);
  wake();
}

void Supervisor::begin_shutdown(CommandId command, ComponentId component) {
  shutdowns_.push_back({command, component, 0, live_now()});
}

void Supervisor::stop_all() {
  std::unique_lock lock(mutex_);
  std::set<ComponentId> started;
  for (const Member& member : members_) {
    if (member.relation == Relation::kChild) started.insert(member.component);
  }
  for (const ComponentId component : started) begin_shutdown({}, component);
  wake();
  something_ended_.wait(lock, [&] {
    return std::all_of(started.begin(), started.end(), [&](ComponentId c) { return is_gone(c); });
  });
}

bool Supervisor::is_known(ComponentId component, int pid) const {
  return std::any_of(members_.begin(), members_.end(), [&](const Member& m) {
    return m.process.pid() == pid && m.component == component;
  });
}

bool Supervisor::is_gone(ComponentId component) const {
  return std::none_of(members_.begin(), members_.end(),
                      [&](const Member& m) { return m.component == component; });
}

Time Supervisor::next_escalation() const {
  Time next = kNever;
  for (const Shutdown& shutdown : shutdowns_) next = std::min(next, shutdown.escalate);
  return next;
}

void Supervisor::wake() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = write(wake_.get(), &one, sizeof one);
}

void Supervisor::run() {
  std::unique_lock lock(mutex_);
  Time next_look = live_now();
  while (!is_ending_) {
    std::vector<pollfd> watched{{wake_.get(), POLLIN, 0}};
    for (const Member& member : members_)
      watched.push_back({member.process.descriptor(), POLLIN, 0});
    const Time until =
        members_.empty() ? next_escalation() : std::min(next_look, next_escalation());
    const auto wait =
        until == kNever ? Duration(-1) : std::max(Duration::zero(), until - live_now());
    lock.unlock();
    // Round up: a deadline that is a fraction of a millisecond away must not be polled for in a
    // hurry.
    const auto milliseconds =
        wait < Duration::zero()
            ? -1
            : static_cast<int>(std::chrono::ceil<std::chrono::milliseconds>(wait).count());
    poll(watched.data(), watched.size(), milliseconds);
    std::uint64_t count = 0;
    [[maybe_unused]] const auto taken = read(wake_.get(), &count, sizeof count);
    lock.lock();
    const Time now = live_now();
    look(now);
    if (now >= next_look) next_look = later(now, kStatePeriod);
  }
}

void Supervisor::look(Time now) {
  for (Member& member : members_) {
    const ProcessState state = member.process.state();
    if (state == ProcessState::kGone) {
      end_member(member);
    } else if (state != member.state) {
      inbox_.put(ProcessSeen{member.component, state, member.process.pid(), ""});
    }
    member.state = state;
  }
  std::erase_if(members_, [](const Member& m) { return m.state == ProcessState::kGone; });
  for (Shutdown& shutdown : shutdowns_) {
    if (!is_gone(shutdown.component)) {
      if (shutdown.escalate <= now) escalate(shutdown, now);
      continue;
    }
    if (shutdown.command != CommandId{})
      inbox_.put(Reply{shutdown.command, Outcome::kDone, {}, ""});
  }
  std::erase_if(shutdowns_, [&](const Shutdown& s) { return is_gone(s.component); });
  something_ended_.notify_all();
}

void Supervisor::end_member(Member& member) {
  // What the process had started must not live on beside its successor. While it is not reaped, no
  // other group can have its number.
  if (member.relation == Relation::kChild) member.process.kill_group();
  const std::string remark = member.process.reap();
  inbox_.put(ProcessSeen{member.component, ProcessState::kGone, member.process.pid(), remark});
}

void Supervisor::escalate(Shutdown& shutdown, Time now) {
  const bool is_stopped = std::any_of(members_.begin(), members_.end(), [&](const Member& m) {
    return m.component == shutdown.component && m.state == ProcessState::kStopped;
  });
  if (is_stopped || shutdown.signal == SIGTERM || shutdown.signal == SIGKILL) {
    shutdown.signal = SIGKILL;
    shutdown.escalate = later(now, kFirm);
  } else if (shutdown.signal == SIGINT) {
    shutdown.signal = SIGTERM;
    shutdown.escalate = later(now, kFirm);
  } else {
    shutdown.signal = SIGINT;
    shutdown.escalate = later(now, kPolite);
  }
  for (const Member& member : members_) {
    if (member.component == shutdown.component) member.process.signal(shutdown.signal);
  }
}

}  // namespace culprit::process
