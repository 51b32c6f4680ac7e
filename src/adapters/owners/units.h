// Components that systemd runs (UNIT), or the engine of a container (CONTAINER): it is asked to start
// and to end them, and what it says of them is proof. What follows is said of systemd, and holds of
// an engine likewise, whose containers are its units.
//
// To redeploy is RestartUnit: systemd starts the unit again by itself, also if culprit ends in
// between. A unit that systemd started again already (Restart=), or is about to, is not ended and
// not started a second time. systemd ends a process politely; a process that is stopped, or is still
// there after kPolite, or after Supervisor::kHung if it hangs, gets SIGKILL, through systemd too.
//
// Proof before harm: a process that is not of the unit is not ended by ending the unit, so nothing
// is ended then; nor is what a debugger holds replaced. Where systemd cannot be asked, or refuses, that is the answer, and nothing was
// ended.
//
// What was started is said to work, until its node is there, as long as it does (ProcessWorked): what
// is slow is not taken for what hangs.
//
// On another computer (HOST) there is no process of ours to look at: what its owner says is all that is
// known, no process is named to the manager, and one of this computer is never taken for it. While
// that computer cannot be asked, its components are out of reach (HostReached), and nothing that is
// missed of them is said to be dead. Once it can be again, they get kReturn to be heard.
//
// Everything is asked on a thread of its own: nobody waits here for a bus that does not answer.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <thread>
#include <vector>

#include "base/mutex.h"
#include "language/rule_set.h"
#include "owners/engine.h"
#include "owners/supervisor.h"
#include "owners/systemd_bus.h"
#include "robot/command.h"
#include "robot/inbox.h"

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
  // Likewise over ssh. An engine takes a connection of its own for each look.
  static constexpr Duration kRemotePeriod = std::chrono::milliseconds(200);
  static constexpr Duration kRemoteIdlePeriod = std::chrono::seconds(2);
  static constexpr Duration kEngineIdlePeriod = std::chrono::seconds(5);
  static constexpr Duration kReconnect = std::chrono::seconds(1);
  // How long the nodes of a computer that can be asked again have to be seen again.
  static constexpr Duration kReturn = std::chrono::seconds(10);
  // What somebody else started so lately is not replaced: it takes the place of what was missed.
  static constexpr Duration kFresh = std::chrono::seconds(10);

  // An engine answers a restart when it is done, so systemd's units do not wait for its containers.
  enum class Of : std::uint8_t { kSystemd, kEngines };

  // `rules` and `inbox` must outlive this. Nothing is asked, and no thread is started, if no
  // component has such an owner on that computer. `host`: empty, this one.
  Units(const RuleSet& rules, Inbox& inbox, Of whose = Of::kSystemd, std::string host = {});
  ~Units();

  bool is_ours(ComponentId component) const;

  // The component's node runs in this process now; of components without a UNIT, too: a unit that
  // runs several is not ended for one of them.
  void found(ComponentId component, int pid);

  // Starts the component's unit and replies when systemd has started it, or does so by itself.
  void start(CommandId command, ComponentId component);

  // Ends the process `pid` of the component's unit, and the unit; 0: whichever it runs. Replies when
  // systemd and the kernel say that it is gone. That it hangs counts on this computer only: what does
  // not answer from another one may be hard to reach.
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

  // Of a unit on another computer: which process it runs, and since when, if somebody else started
  // that after culprit looked for the first time.
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
  void note_reach(const std::optional<std::string>& trouble);
  void note_main_process(ComponentId component, const UnitState& state);
  void note(const Found& found);
  void look_for_work();

  // Gives whether the errand is done.
  bool advance(Errand& errand);
  bool begin_start(Errand& errand, const UnitState& state);
  std::optional<std::string> hold_of(const Errand& errand, const UnitState& state) const;
  bool begin_end(Errand& errand, const UnitState& state);
  bool watch_start(Errand& errand, const UnitState& state);
  bool watch_end(Errand& errand, const UnitState& state);
  std::optional<std::string> who_else_would_end(ComponentId component);
  bool answer(const Errand& errand, Outcome outcome, std::string text, int pid = 0);

  const std::string& name_of(ComponentId component) const;
  ServiceOwner& owner_of(ComponentId component);

  const RuleSet& rules_;
  Inbox& inbox_;
  const Of whose_;
  const std::string host_;
  std::vector<ComponentId> components_;  // those with such an owner

  // Of the thread.
  SystemdBus system_{SystemdBus::Whose::kSystem, host_};
  SystemdBus user_{SystemdBus::Whose::kUser, host_};
  Engine docker_{EngineContainer::Engine::kDocker, host_};
  Engine podman_{EngineContainer::Engine::kPodman, host_};
  std::map<ComponentId, UnitState::Activity> before_;
  std::set<ComponentId> ended_here_;  // on culprit's request, and not seen to run since
  std::map<ComponentId, Elsewhere> elsewhere_;
  int failures_ = 0;          // in a row, to ask the computer
  bool is_reached_ = true;    // as it was told
  Time returned_ = kLongAgo;  // when it could be asked again, if that was not told yet
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

// All that the rules name, each owner of each computer by itself: who does not answer holds up nobody
// else.
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
