// Starts, stops and watches the processes of components.
//
// In the words of Erlang/OTP: the supervisor starts a child from its launch command. It shuts it
// down by escalation: SIGINT, after kPolite SIGTERM, after kFirm SIGKILL; or, if it hangs, SIGINT,
// after kHung SIGKILL. It reports when the process runs, stops and ends, and until its node is
// there whether it works. It decides nothing: restarting is up to the manager. A process that is
// stopped (SIGSTOP) cannot act on a polite signal and must not wake up to do so late: it is killed
// at once.
//
// Each process that it starts carries a mark (mark.h). The next supervisor of the same robot
// recognizes it by that, also if this process died the moment after: a component is never started
// beside a process that runs already. A process is not marked until its program runs; until then it
// holds a lock on the log, which outlives us, too. (The tools of ROS 2 leave a daemon behind, which
// outlives the nodes that were launched with them.)
//
// Proof before harm. A process that was not started here, and carries no mark of ours, is ended
// only if it still is what it was when it was found first: the same program of the same user.
// Before a process is ended to be started again, the start is tried, all but its last step. The
// supervisor never waits for a program whose file system does not answer. A process that a debugger
// holds is not replaced.
//
// The launcher of a RESPAWNED component starts it: culprit ends the process, and its launcher
// starts it again. culprit starts it only once that launcher is known and has exited.
//
// The supervisor reports an exit at once, with its status, and whether somebody wanted it
// (process_end.h); an end by culprit itself was wanted. It also reports which process started one
// that culprit did not start, and when that one has exited.
//
// A process that is started while the launcher of the component's first one runs stands in for that one: its mark names
// the launcher (StartedHere). Whether it is to end with the launch is up to the manager; it then ends as ros2 launch
// ends its own, by end_with_launch().
//
// An order to stop applies to the processes that run when it comes, and not to their successors.
//
// If a start fails because its program or its parameter file is missing, that is reported with the
// path (StartBarred). A crashed process that writes its core dump is not killed for kDump: a person
// needs the dump. Until it is complete, the component is not ended to be started again (StartBarred).
// The supervisor then tries the start, all but its last step, every
// kMissingPeriod until it would succeed.
//
// A process ends with all its descendants, also with one that leads a session of its own, as in a
// service of systemd: such a descendant holds the device that the successor needs. Descendants are
// found by the mark that they inherited, and by their parents. If the process exited by itself
// without a fault, its children may be the node (a launch command that makes a daemon). They go on
// until the component is ended or started. Children of a process that somebody else started are
// reported instead.
//
// All processes that it started go on running when the supervisor ends, unless stop_all() was
// called or their lifetime is the starter's.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <thread>
#include <vector>

#include "base/mutex.h"
#include "base/wake_file.h"
#include "inbox/inbox.h"
#include "language/rule_set.h"
#include "owners/component_programs.h"
#include "owners/launchers.h"
#include "owners/proc.h"
#include "owners/shared_memory_ports.h"
#include "owners/spawn.h"
#include "owners/watched_process.h"
#include "robot/command.h"

namespace culprit::owners {

enum class Ending : std::uint8_t { kForGood, kToStartAgain };
// A process that hangs is not expected to act on a polite signal. It gets only the time that a
// process needs to end without a thread of its own.
enum class Hangs : bool { kNo, kYes };

// All members may be called from any thread. Observations (ProcessSeen, Reply) go to the inbox.
class Supervisor {
 public:
  static constexpr Duration kPolite = std::chrono::seconds(2);
  static constexpr Duration kFirm = std::chrono::seconds(1);
  static constexpr Duration kHung = std::chrono::milliseconds(300);
  // As ros2 launch: sigterm_timeout, sigkill_timeout.
  static constexpr Duration kOfLaunch = std::chrono::seconds(5);
  // After a start, until the node is there: how often the supervisor checks whether the process
  // works, and for how long.
  static constexpr Duration kWorkPeriod = std::chrono::seconds(1);
  static constexpr Duration kComingUp = std::chrono::minutes(5);
  // How often it is looked whether a process was stopped; its end is known at once.
  static constexpr Duration kStatePeriod = std::chrono::milliseconds(200);
  // How often it is looked whether a log has become too long.
  static constexpr Duration kLogPeriod = std::chrono::seconds(1);
  // A process that is stopped for a shorter time may be part of a stop that is on its way through a
  // launch.
  static constexpr Duration kStopSettles = std::chrono::milliseconds(50);
  // How often it is looked whether what a start needs is there by now.
  static constexpr Duration kMissingPeriod = std::chrono::milliseconds(500);
  // How long the supervisor waits for the children that it kills.
  static constexpr Duration kLeftEnds = std::chrono::milliseconds(200);
  // How long the core dump of a crashed process is waited for.
  static constexpr Duration kDump = std::chrono::seconds(60);
  // How long the trial of a start may take.
  static constexpr Duration kTrial = std::chrono::seconds(5);

  struct Options {
    std::filesystem::path log_folder;  // on this machine: a remote file system could hang
    std::vector<std::filesystem::path> search_first;  // for launch commands without a path
    // Which robot, of all on this machine: "0/sunset". Empty: nothing is marked, and what other
    // supervisors started is not looked for.
    std::string robot{};
    Lifetime lifetime = Lifetime::kOwn;  // of what is started
    // The variables of each component beside the inherited ones; components that have none may be
    // left out. If a component's environment could not be determined, it is neither ended to be
    // started again nor started.
    std::vector<Expected<std::vector<std::string>>> environments{};
  };

  // `rules` and `inbox` must outlive the supervisor. Takes over what carries its mark.
  Supervisor(const RuleSet& rules, Options options, Inbox& inbox);
  ~Supervisor();

  // Starts the component's launch command and replies when it runs; or at once, without a pid, if
  // its launcher starts it.
  void start(CommandId command, ComponentId component);

  // Ends all processes of the component that are watched, and no others, whatever their PIDs;
  // replies when they are gone. Refuses if one of them is not proven to be the component's, or if
  // it could not be started again: then none is ended. Where that is under way already, it only
  // waits for its end, and hurries it if it is known to hang by now. `pid`: the process that is
  // meant; 0: whichever runs. If it has ended and only its successor runs, replies at once.
  void stop(CommandId command, ComponentId component, int pid, Ending ending,
            Hangs hangs = Hangs::kNo);

  // Watches the process that had this number at `known` as the component's, for its node is there;
  // one that began later is another. Reports that it has exited if it has. Does nothing if it is
  // watched already.
  void adopt(ComponentId component, int pid, Time known);

  // As adopt(), for a process that an earlier run of culprit knew, if it is not a zombie now.
  // Reports nothing if another process of the component is watched, or if it was not known (`pid` 0): one on another
  // computer may run on.
  void adopt_again(ComponentId component, int pid, Time known);

  // Whether all processes of the component that run were started here, or by a supervisor of the
  // same robot before, and there is one.
  bool has_started(ComponentId component) const;

  // The component's processes that this or an earlier supervisor of the same robot started, with
  // all their descendants and all that is in their groups. Empty: none, or one is being started or
  // ended.
  std::set<int> started(ComponentId component) const;

  // Ends what was started of the component, here or by a supervisor of the same robot before, and
  // nothing else: it is not needed, for somebody else started one, too.
  void withdraw(ComponentId component);

  // As withdraw(), but with the signals of ros2 launch: SIGINT, after kOfLaunch SIGTERM, after
  // kOfLaunch SIGKILL. Does nothing where that is under way.
  void end_with_launch(ComponentId component);

  // The launch that the component's process stood in for has ended, and the process goes on: it stands in
  // for none from now on, for the next supervisor either.
  void stands_in_for_none(ComponentId component);

  // Ends every process that was started here, and waits until all have exited.
  void stop_all();

 private:
  struct Member {
    std::uint64_t number;  // no other has it
    ComponentId component;
    WatchedProcess process;
    ProcessState state = ProcessState::kRunning;
    // While its program does not run yet: the start, the command that it answers, and its lock.
    std::optional<Launch> launch{};
    CommandId command{};
    FileDescriptor lock{};
    // While its node is awaited: since when, and what it had done when that was looked at last.
    std::optional<Time> awaited{};
    Time worked_at{};
    std::optional<Work> work{};
    std::vector<Relative> left{};  // what somebody else's had started when its end was ordered
    Time left_at{};
    std::optional<Time> stands_since{};  // while its stop is not reported yet
    std::optional<Time> dump_until{};    // it writes its core dump, and that is waited for
    bool is_dump_awaited = false;
    int launcher = 0;        // that it stands in for, while its program does not run yet
    std::string variable{};  // what it and all that it started have in their environment
    std::vector<FileDescriptor> tree{};  // what it had started when its end was ordered
  };
  // A start that is tried before an end.
  struct Trial {
    std::vector<CommandId> commands;
    ComponentId component;
    Launch launch;
    Time until;
    Hangs hangs;
    std::set<std::uint64_t> meant;
  };
  // A start that needs what is not there, and the trial that looks for it.
  struct Barred {
    ComponentId component;
    std::optional<Launch> trial{};
    Time next = kLongAgo;  // look, while no trial is under way
  };
  // A shutdown under way.
  struct Shutdown {
    CommandId command;  // number 0: no reply is due
    ComponentId component;
    Hangs hangs = Hangs::kNo;
    std::set<std::uint64_t> meant{};  // members
    bool is_of_launch = false;        // it takes as long as ros2 launch
    int signal = 0;                   // sent last
    Time escalate = kNever;  // when the next one is due; kNever: another shutdown sees to that
  };

  void answer(CommandId command, Outcome outcome, std::string text) const;

  void take_over(ComponentId component) CULPRIT_REQUIRES(mutex_);
  void watch(ComponentId component, int pid, Relation relation) CULPRIT_REQUIRES(mutex_);
  Expected<void> begin_start(CommandId command, ComponentId component) CULPRIT_REQUIRES(mutex_);
  void meet(CommandId command, ComponentId component) CULPRIT_REQUIRES(mutex_);
  std::optional<std::string> doubt(const Member& member) const CULPRIT_REQUIRES(mutex_);
  static std::optional<std::string> hold_of(const Member& member);
  void tell_of_unit(ComponentId component, int pid) const;
  std::set<std::uint64_t> members_of(ComponentId component) const CULPRIT_REQUIRES(mutex_);
  std::set<std::uint64_t> meant_by(ComponentId component, int pid) const CULPRIT_REQUIRES(mutex_);
  std::optional<std::string> why_not_end(ComponentId component, Ending ending) const
      CULPRIT_REQUIRES(mutex_);
  void finish_starts() CULPRIT_REQUIRES(mutex_);
  void finish_trials(Time now) CULPRIT_REQUIRES(mutex_);
  void note_missing(const Launch& launch, ComponentId component, const std::string& what)
      CULPRIT_REQUIRES(mutex_);
  void look_for_missing(Time now) CULPRIT_REQUIRES(mutex_);
  void finish_shutdowns(Time now) CULPRIT_REQUIRES(mutex_);
  void tell_what_stays(const Member& member) const;

  void run();
  void look(Time now) CULPRIT_REQUIRES(mutex_);
  void look_for_work(Member& member, Time now) CULPRIT_REQUIRES(mutex_);
  void escalate(Shutdown& shutdown, Time now) CULPRIT_REQUIRES(mutex_);
  bool is_known(ComponentId component, int pid) const CULPRIT_REQUIRES(mutex_);
  bool is_gone(ComponentId component) const CULPRIT_REQUIRES(mutex_);
  bool was_started(const Member& member) const;
  static bool is_meant(const Shutdown& shutdown, const Member& member);
  bool is_over(const Shutdown& shutdown) const CULPRIT_REQUIRES(mutex_);
  Shutdown* shutdown_of(ComponentId component) CULPRIT_REQUIRES(mutex_);
  static void hurry(Shutdown& shutdown);
  std::optional<std::string> awaited_dump(Member& member, Time now);
  void await_dump_no_more(Member& member);
  void begin_shutdown(CommandId command, ComponentId component, Hangs hangs,
                      std::set<std::uint64_t> meant) CULPRIT_REQUIRES(mutex_);
  std::set<std::uint64_t> started_members_of(ComponentId component) const CULPRIT_REQUIRES(mutex_);
  void end_member(Member& member) CULPRIT_REQUIRES(mutex_);
  void end_what_is_left(ComponentId component, const std::string& variable) const;
  Cause cause_of_stop(const Member& member) const CULPRIT_REQUIRES(mutex_);
  Cause cause_of_end(const Member& member, const ProcessEnd& end) const CULPRIT_REQUIRES(mutex_);
  static bool is_settled(Member& member, ProcessState state, Time now);
  Time next_deadline() const CULPRIT_REQUIRES(mutex_);
  void wake();

  const RuleSet& rules_;
  Inbox& inbox_;
  const ComponentPrograms programs_;

  mutable Mutex mutex_;
  ConditionVariable something_ended_;
  std::vector<Member> members_ CULPRIT_GUARDED_BY(mutex_);
  std::vector<Trial> trials_ CULPRIT_GUARDED_BY(mutex_);
  std::vector<Barred> barred_ CULPRIT_GUARDED_BY(mutex_);
  std::vector<Shutdown> shutdowns_ CULPRIT_GUARDED_BY(mutex_);
  std::map<ComponentId, Identity> identities_
      CULPRIT_GUARDED_BY(mutex_);  // of what others started, when it was found first
  Launchers launchers_ CULPRIT_GUARDED_BY(mutex_);
  std::uint64_t numbers_ CULPRIT_GUARDED_BY(mutex_) = 0;  // of members
  std::map<ComponentId, std::pair<int, std::uint64_t>> ended_
      CULPRIT_GUARDED_BY(mutex_);  // the last process that ended, and which member it was
  SharedMemoryPorts ports_ CULPRIT_GUARDED_BY(mutex_);
  bool is_ending_ CULPRIT_GUARDED_BY(mutex_) = false;
  WakeFile wake_file_;
  std::thread thread_;
};

}  // namespace culprit::owners
