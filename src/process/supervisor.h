// Starts, stops and watches the processes of components.
//
// In the words of Erlang/OTP: the supervisor starts a child from its launch command, shuts it down
// by escalation (SIGINT, after kPolite SIGTERM, after kFirm SIGKILL), and tells what becomes of it.
// It decides nothing: restarting is up to the manager. A stopped process cannot act on a polite
// signal and must not wake up to do so late: it is killed at once.
//
// What it starts carries a mark in its environment, CULPRIT_COMPONENT, so that whoever supervises
// the same robot later knows it again, also if this process died the moment after: a component is
// never started beside a process that runs already. What that process starts in turn inherits the
// mark and is not the component: CULPRIT_PROCESS says which process is. (The tools of ROS 2 leave a
// daemon behind, which outlives whatever was launched with them.)
//
// Whatever it started goes on running when the supervisor ends, unless stop_all() was called.
#pragma once

#include <condition_variable>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

#include "language/rule_set.h"
#include "process/watched_process.h"
#include "robot/command.h"
#include "robot/inbox.h"

namespace culprit::process {

// All members may be called from any thread. Observations (ProcessSeen, Reply) go to the inbox.
class Supervisor {
 public:
  static constexpr Duration kPolite = std::chrono::seconds(2);
  static constexpr Duration kFirm = std::chrono::seconds(1);
  // How often it is looked whether a process was stopped; its end is known at once.
  static constexpr Duration kStatePeriod = std::chrono::milliseconds(200);

  struct Options {
    std::filesystem::path log_folder;
    std::vector<std::filesystem::path> search_first;  // for launch commands without a path
    // Which robot, of all on this machine: "0/sunset". Empty: nothing is marked, and what other
    // supervisors started is not looked for.
    std::string robot{};
  };

  // `rules` and `inbox` must outlive the supervisor. Takes over what carries its mark.
  Supervisor(const RuleSet& rules, Options options, Inbox& inbox);
  ~Supervisor();

  // Starts the component's launch command and replies.
  void start(CommandId command, ComponentId component);

  // Ends all processes of the component that are watched, and no others, whatever their numbers;
  // replies when they are gone.
  void stop(CommandId command, ComponentId component);

  // Watches the process that had this number at `known` as the component's; one that began later is
  // another. Tells that it is gone if it is. Does nothing if it is watched already.
  void adopt(ComponentId component, int pid, Time known);

  // Likewise. Says nothing if it is gone.
  void adopt_again(ComponentId component, int pid, Time known);

  // Ends every process that was started here, and waits until all are gone.
  void stop_all();

 private:
  struct Member {
    ComponentId component;
    WatchedProcess process;
    Relation relation;
    ProcessState state = ProcessState::kRunning;
  };
  // A shutdown under way.
  struct Shutdown {
    CommandId command;  // number 0: nobody waits for a reply
    ComponentId component;
    int signal = 0;          // sent last
    Time escalate = kNever;  // when the next one is due
  };

  std::string mark(ComponentId component) const;
  void take_over(ComponentId component);
  void run();
  void look(Time now);
  void escalate(Shutdown& shutdown, Time now);
  bool is_known(ComponentId component, int pid) const;
  bool is_gone(ComponentId component) const;
  void begin_shutdown(CommandId command, ComponentId component);
  void end_member(Member& member);
  Time next_escalation() const;
  void wake();

  const RuleSet& rules_;
  Options options_;
  Inbox& inbox_;

  mutable std::mutex mutex_;
  std::condition_variable something_ended_;
  std::vector<Member> members_;
  std::vector<Shutdown> shutdowns_;
  bool is_ending_ = false;
  FileDescriptor wake_;
  std::thread thread_;
};

}  // namespace culprit::process
