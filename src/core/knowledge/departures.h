// Which components leave together, whether a person ended them, and which processes culprit started in their place.
//
// A launch is a process (a launch file, a shell) with the components that it started. Ctrl-C signals all of them, and they
// end one after the other. If culprit starts a component while its launcher runs, the new process stands in for the launch:
// it belongs to the launch, and ends with it.
//
//   event                                 culprit's answer
//   a component exits cleanly             it waits for kAlone, since the others may follow
//   a component fails as also on Ctrl-C   likewise, for kFailedAlone
//   several exit or fail so               they leave together; it waits until none has for kTogether
//   the launcher ends with them           the launch has ended, and its components stay down until a person starts one
//                                         again, or orders so (Revive)
//   a person starts a component again,    it waits for kBack while the component comes up
//   or continues its stopped process
//
// A component of an ended launch belongs to no launch any more if it runs on for kTogether, crashes later than kDoubt, or
// culprit ends it.
//
// Did a person end the launch? If it lived on for kDoubt after a crash, yes. If it ended sooner, that is in doubt: the crash
// may have ended it (on_exit=Shutdown() in a launch file). It is in doubt, too, if only one process left, with an error that
// Ctrl-C may have led to. In these cases the launch has not ended:
//
//   the launcher crashed, or only its own process ended    its nodes run on
//   all its processes had crashed                          it had nothing left to do
//   culprit ended one of its components within kDoubt      the launch ended because of that
#pragma once

#include <optional>
#include <vector>

#include "base/time.h"
#include "knowledge/stays_down.h"
#include "language/rule_set.h"
#include "robot/observation.h"

namespace culprit {

class Departures {
 public:
  static constexpr Duration kAlone = std::chrono::seconds(2);
  // One that fails as it may on Ctrl-C, too, is held back for less: most often it threw an exception.
  static constexpr Duration kFailedAlone = std::chrono::seconds(1);
  // ros2 launch asks a second time after 5 s, and kills after another 5 s.
  static constexpr Duration kTogether = std::chrono::seconds(11);
  static constexpr Duration kBack = std::chrono::seconds(10);
  static constexpr Duration kDoubt = std::chrono::seconds(2);

  explicit Departures(const RuleSet& rules);
  // A launch that ends in doubt is taken for one that broke: its components may be started again.
  void revive_in_doubt() { revives_ = true; }

  // ---- observations

  // A process of the component began: for a strategy of culprit that was under way, or not.
  enum class By : std::uint8_t { kCulprit, kOther };
  void arrived(ComponentId component, int pid, Time at, By by);
  // culprit started that process; reported before it arrives.
  void started_here(const StartedHere& seen, Time at);
  // Another process, `launcher`, which is no supervisor, started it.
  void launched(ComponentId component, int launcher);
  void launcher_ended(const LauncherSeen& seen, Time at);
  // It left: of its own or of a person's will, as it seems. Again, for what left already: nothing.
  void left(ComponentId component, Time at);
  // It left with an error, which its program also makes of a person's wish (Cause::kDoubt).
  void failed(ComponentId component, Time at);
  // It crashed.
  void fell(ComponentId component, Time at);
  // culprit ended it.
  void ended_here(ComponentId component, Time at);
  // It is gone for an unknown reason.
  void lost(ComponentId component);
  // A person had its owner end it (systemctl stop, docker stop), shut its node down, stopped or froze its process,
  // or unloaded it from its container.
  void ended_by_order(ComponentId component, StaysDown::Why why);
  // Its node is not shut down any more.
  void is_up(ComponentId component);
  // Its process runs: if a person had stopped or frozen it, it goes on.
  void goes_on(ComponentId component, Time at);
  // Its node is there again: if a person had unloaded it, somebody loaded it again.
  void loaded(ComponentId component, Time at);

  // ---- orders

  // Clears the mark "stays down" for all events until now; for one component, or for all.
  void revive(std::optional<ComponentId> component = {});
  // Every component whose process culprit started stays down.
  void end_started();

  // ---- what follows

  // The launches that were found to have ended.
  struct Settled {
    std::vector<StaysDown> down;  // the components that stay down from now on
    std::vector<int>
        broken;  // launchers that ended with one component, so that the others start again
  };
  Settled settle(Time now);
  Time next_settling() const { return settles_at_; }
  // A StaysDown event of an earlier run.
  void remember(const StaysDown& told);

  enum class What : std::uint8_t {
    kIsEnding,   // the launch that the component belongs to
    kStaysDown,  // it has ended
    kIsBack      // it was started again a moment ago
  };
  struct Departure {
    What what = What::kIsEnding;
    int launcher = 0;
    Time until = kNever;
    StaysDown::Why why = StaysDown::Why::kPerson;  // kStaysDown
  };
  // Empty: it may be adapted.
  std::optional<Departure> of(ComponentId component, Time now) const;
  bool stays_down(ComponentId component) const {
    return members_[component.index].down.has_value();
  }

  // When somebody else started it again, after its process had ended; kLongAgo: that did not happen last.
  Time returned(ComponentId component) const { return members_[component.index].returned; }

  // A process that culprit started and that runs.
  struct Started {
    ComponentId component;
    int pid = 0;
    int launcher = 0;  // of the launch that it stands in for; 0: of none
    Time since{};
  };
  std::vector<Started> started() const;
  // The process of the component that culprit started and that is to end, since the component stays
  // down; 0: there is none.
  int to_end(ComponentId component) const;

 private:
  // On a launch whose launcher has ended.
  struct Verdict {
    enum class What : std::uint8_t {
      kOpen,    // until then, or until more is seen
      kGoesOn,  // it is no launch any more, and its remaining members are as any others
      kBroken,  // as above, and it ended because one of its components had
      kEnded
    } what = What::kOpen;
    Time until = kNever;
    StaysDown::Why why = StaysDown::Why::kPerson;
    std::optional<ComponentId> fell{};  // kDoubt
    Duration after{};                   // likewise
  };
  struct Launch {
    int launcher = 0;
    int left = 0;                         // how many, since none had left for kTogether
    Time left_first = kNever;             // of them
    Time left_at = kLongAgo;              // the last one of them
    std::optional<ComponentId> failed{};  // one of them, with an error; the last such one
    Time failed_at = kLongAgo;            // when it left
    Time fell_at = kLongAgo;              // the last crash before they began to leave
    std::optional<ComponentId> fell{};
    Time fell_before = kLongAgo;    // the crash before that one
    Time ended_here_at = kLongAgo;  // culprit ended one
    Time ended = kNever;            // the launcher
    bool has_crashed = false;       // it did
    bool ran_others = false;        // when a component's process ended
    bool was_seen = false;          // to run
    Verdict verdict{};
  };
  struct Member {
    int launcher = 0;  // 0: none is known
    bool is_there = false;
    bool has_left = false;
    bool has_crashed = false;  // that was how it left
    bool has_owner = false;    // UNIT, CONTAINER, IN
    int started_pid = 0;       // that culprit started last
    Time since{};              // when it did
    bool is_ours = false;      // the process that is there, or was last
    Time back = kLongAgo;      // after it had stayed down
    Time returned = kLongAgo;  // after its process had ended, by somebody else
    Time owner_is_asked_until = kLongAgo;
    std::optional<StaysDown::Why> down{};
    bool is_told = false;  // that it stays down
  };

  Launch* launch_of(ComponentId component);
  const Launch* launch_of(ComponentId component) const;
  bool is_original_left(const Launch& launch) const;
  bool has_stand_in(const Launch& launch) const;
  bool is_any_orphan() const;
  // Has what crashes `at` that time outlived its launch?
  static bool has_outlived(const Launch& launch, Time at);
  Verdict verdict(const Launch& launch, Time now) const;
  void dissolve(const Launch& launch);
  void take_down(const Launch& launch, Time now);
  void forget_unused_launches();

  std::vector<Member> members_;  // by component
  std::vector<Launch> launches_;
  bool revives_ = false;
  bool has_changed_ = false;
  Time settles_at_ = kNever;
};

}  // namespace culprit
