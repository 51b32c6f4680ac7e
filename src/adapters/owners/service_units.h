// Components that systemd runs (UNIT), or the engine of a container (CONTAINER): culprit asks it to
// start and to end them, and its answer is proof. This header speaks of systemd and its units; all
// of it also holds for an engine and its containers.
//
// A redeploy is RestartUnit: systemd starts the unit again by itself, also if culprit exits in
// between. A unit that systemd started again already (Restart=), or is about to, is not ended and
// not started a second time. systemd ends a process politely. The process gets SIGKILL, through
// systemd too, if it is stopped, is still there after kPolite, or hangs and is still there after
// Supervisor::kHung. While somebody else's request to end it is under way, culprit does not restart it.
//
// Proof before harm: if the process is not part of the unit, ending the unit would not end it, so
// nothing is ended then; nor is a process replaced that a debugger holds. If systemd cannot be
// asked, or refuses, that is the answer, and nothing was ended. If it does not answer, as during an upgrade, its components
// cannot be started until it does (StartBarred), whether or not they run on meanwhile.
//
// A process that was started is reported as working (ProcessWorked) as long as it works, until its
// node is there: so a slow start is not taken for a hang.
//
// On another computer (HOST) there is no process of ours to look at, and its owner's reports are
// the only evidence. The manager receives no PID, and never takes a process of this computer for
// it. While that computer cannot be asked, its components are unreachable (HostReached), and none
// of them is reported as exited. Once it answers again, its nodes have kReturn to be discovered.
//
// All requests are made on a thread of their own, so no caller waits for a bus that does not
// answer.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <thread>
#include <vector>

#include "base/mutex.h"
#include "inbox/inbox.h"
#include "language/rule_set.h"
#include "owners/engine.h"
#include "owners/supervisor.h"
#include "owners/systemd_bus.h"
#include "robot/command.h"

namespace culprit::owners {

// All members may be called from any thread. Observations (ProcessSeen, Reply) go to the inbox.
class Units {
 public:
  static constexpr Duration kPolite = std::chrono::seconds(3);
  // Until when an end is answered, one way or the other: less than a StopProcess may take.
  static constexpr Duration kEnd = std::chrono::seconds(10);
  static constexpr Duration kStart = std::chrono::seconds(4);
  // How often it is looked: while something is asked for, and else.
  static constexpr Duration kPeriod = std::chrono::milliseconds(50);
  static constexpr Duration kIdlePeriod = std::chrono::seconds(1);
  // Likewise over ssh. An engine needs a connection of its own for each look.
  static constexpr Duration kRemotePeriod = std::chrono::milliseconds(200);
  static constexpr Duration kRemoteIdlePeriod = std::chrono::seconds(2);
  static constexpr Duration kEngineIdlePeriod = std::chrono::seconds(5);
  static constexpr Duration kReconnect = std::chrono::seconds(1);
  // Once a computer can be asked again, its nodes have so long to be discovered.
  static constexpr Duration kReturn = std::chrono::seconds(10);
  // A process that somebody else started so recently is not replaced: it takes the place of the
  // missing one.
  static constexpr Duration kFresh = std::chrono::seconds(10);

  // An engine answers a restart when it is done, so systemd's units do not wait for its containers.
  enum class Of : std::uint8_t { kSystemd, kEngines };

  // `rules` and `inbox` must outlive this. If no component has such an owner on that computer,
  // nothing is asked and no thread is started. `host`: empty, this one.
  Units(const RuleSet& rules, Inbox& inbox, Of whose = Of::kSystemd, std::string host = {});
  ~Units();

  bool is_ours(ComponentId component) const;

  // The component's node runs in this process now; of components without a UNIT, too: a unit that
  // runs several is not ended for one of them.
  void found(ComponentId component, int pid);

  // Starts the component's unit and replies when systemd has started it, or does so by itself.
  void start(CommandId command, ComponentId component);

  // Ends the process `pid` of the component's unit, and the unit; 0: whichever it runs. Replies
  // when systemd and the kernel report that it has exited. `hangs` counts on this computer only: a
  // node on another computer that does not answer may be hard to reach.
  void stop(CommandId command, ComponentId component, int pid, Ending ending,
            Hangs hangs = Hangs::kNo);

 private:
  struct Errand {
    enum class Kind : std::uint8_t { kStart, kReplace, kEnd };
    CommandId command;
    ComponentId component;
    Kind kind = Kind::kStart;
    int pid = 0;                  // that is to end; 0: not known
    std::optional<Time> began{};  // of it
    Hangs hangs = Hangs::kNo;
    bool was_asked = false;  // systemd was
    int main_pid = 0;        // when it was
    Time escalate = kNever;
    Time until = kNever;
    Time since{};
    Time latest = kNever;  // when it is answered, one way or the other
  };
  struct Found {
    ComponentId component;
    int pid = 0;
    std::optional<Time> began{};
  };

  // A process whose node is awaited.
  struct ComingUp {
    ComponentId component;
    int pid = 0;
    std::optional<Time> began{};
    Time since{};
    std::optional<Work> work{};
  };

  // For a unit on another computer: the process that it runs, and since when, if somebody else
  // started that after culprit looked for the first time.
  struct Elsewhere {
    int main_pid = 0;
    Time since = kLongAgo;
  };

  bool is_here() const { return host_.empty(); }
  bool runs_here(int pid, std::optional<Time> began) const;
  Duration idle_period() const;
  Duration polite_for(const Errand& errand) const;

  void add(Errand errand);
  void run();
  void look_at_all();
  void look_at(ComponentId component, const UnitState& state);
  void note_successor(ComponentId component, const UnitState& state);
  void bar(ComponentId component, std::string why);
  bool is_news_of_an_order(const Errand& errand, const UnitState& state) const;
  void note_reach(const std::optional<std::string>& trouble);
  void note_main_process(ComponentId component, const UnitState& state);
  void note(const Found& found);
  void look_for_work();

  // Gives whether the errand is done.
  bool advance(Errand& errand);
  bool begin_start(Errand& errand, const UnitState& state);
  std::optional<std::string> hold_of(const Errand& errand, const UnitState& state);
  std::optional<std::string> awaited_dump(ComponentId component, int pid);
  bool begin_end(Errand& errand, const UnitState& state);
  bool watch_start(Errand& errand, const UnitState& state);
  bool watch_end(Errand& errand, const UnitState& state);
  std::optional<std::string> would_end_too(ComponentId component);
  bool answer(const Errand& errand, Outcome outcome, std::string text, int pid = 0);

  const std::string& name_of(ComponentId component) const;
  ServiceOwner& owner_of(ComponentId component);

  const RuleSet& rules_;
  Inbox& inbox_;
  const Of whose_;
  const std::string host_;
  std::vector<ComponentId> components_;  // those with such an owner

  // Used by the thread only.
  SystemdBus system_{SystemdBus::Whose::kSystem, host_};
  SystemdBus user_{SystemdBus::Whose::kUser, host_};
  Engine docker_{EngineContainer::Engine::kDocker, host_};
  Engine podman_{EngineContainer::Engine::kPodman, host_};
  std::map<ComponentId, UnitState::Activity> before_;
  // A crashed process that writes its core dump, and until when that is waited for.
  struct Dump {
    int pid = 0;
    Time until = kNever;
  };
  std::map<ComponentId, Dump> dumps_;
  // The main process that ended on culprit's request; until another one runs.
  std::map<ComponentId, int> ended_here_;
  std::map<ComponentId, Elsewhere> elsewhere_;
  int failures_ = 0;          // in a row, to ask the computer
  bool is_reached_ = true;    // as reported
  Time returned_ = kLongAgo;  // when it could be asked again, if that is not reported yet
  // The node's process, and the main process of the unit then: `ros2 run` is another one.
  std::map<ComponentId, std::pair<int, int>> found_with_;
  std::map<ComponentId, Found> last_found_;
  std::vector<ComingUp> coming_up_;
  std::set<ComponentId> barred_;  // asked for, and their owner has no such unit

  Mutex mutex_;
  ConditionVariable something_came_;
  std::vector<Errand> errands_ CULPRIT_GUARDED_BY(mutex_);  // that are new
  std::vector<Found> found_ CULPRIT_GUARDED_BY(mutex_);     // likewise
  bool is_ending_ CULPRIT_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

// All that the rules name, each owner of each computer by itself: an owner that does not answer
// delays no other.
class AllUnits {
 public:
  // `rules` and `inbox` must outlive this.
  AllUnits(const RuleSet& rules, Inbox& inbox);

  // As of Units.
  void found(ComponentId component, int pid);
  // Those that the component's is one of; nothing: it is none.
  Units* of(ComponentId component);

 private:
  std::vector<std::unique_ptr<Units>> all_;
};

// Whether culprit could start and end it. Errors: its owner cannot be asked, has no such one, or
// refuses. Waits for the owner, SystemdBus::kPatience for each of a few calls.
Expected<void> could_manage(const SystemdUnit& unit);
Expected<void> could_manage(const EngineContainer& container);

}  // namespace culprit::owners
