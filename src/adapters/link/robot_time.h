// The time that the robot's nodes go by, and whether it passes.
//
// Nodes go by the system clock, unless use_sim_time is set: then by /clock (simulated_clock.h). With
// follow_for_all() all do. Otherwise each node says it itself (learned()), again whenever it begins or ceases to
// subscribe to /clock. While that clock stands
// still, culprit judges nothing if all nodes are known to be simulated (doubtful()); otherwise
// it judges nothing about the simulated ones (TimeHeld). A clock that never ticked stands still, too, as
// that of a simulation which begins paused.
//
// A step of the system clock is reported: timers of nodes may stand still after it.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "base/expected.h"
#include "inbox/inbox.h"
#include "link/clock_step.h"
#include "link/simulated_clock.h"
#include "ros2/context.h"
#include "ros2/timer.h"

namespace culprit::link {

// On the executor's thread, but for doubtful() and doubt(), which any thread may call.
class RobotTime {
 public:
  // `self`, `context` and `inbox` outlive it.
  RobotTime(ros2::NodeEntry& self, ros2::Context& context, Inbox& inbox)
      : self_(self), context_(context), inbox_(inbox) {}

  // Before the executor runs. An error when the middleware, or the domain's permissions, refuse.
  Expected<void> follow_for_all();
  // The node says whether its time is the simulated one.
  void learned(ComponentId component, const std::string& node, bool is_simulated);
  // Once a second: reports clocks to a person.
  void report();

  // Until when it is certain that the time of all nodes passes; in the past: it stands still.
  Time doubtful(Time now) const;
  // The doubt, once that time has come.
  std::string doubt(Time now) const { return made_.load()->doubt(now); }

 private:
  Expected<void> open();
  const SimulatedClock* clock_of_all() const;
  void look();
  bool stands_still(Time now);
  void hold(const std::string& node, bool is_held);
  void report_pause(bool is_held, Time now);
  void report_step();
  void report_clock();

  ros2::NodeEntry& self_;
  ros2::Context& context_;
  Inbox& inbox_;

  bool is_for_all_ = false;
  // Made once: with --use-sim-time, or when a node says that it is simulated.
  std::unique_ptr<SimulatedClock> clock_;
  std::atomic<const SimulatedClock*> made_ = nullptr;  // for the other threads
  // Components' nodes have real time, too: a clock that stands still is no reason to judge nothing at all.
  std::atomic<bool> is_mixed_ = false;

  struct Simulated {
    ComponentId component;
    bool is_held = false;  // as was reported
  };
  std::map<std::string, Simulated> simulated_;  // by node
  std::set<std::string> sources_;               // those of them that publish /clock, or did
  Time stood_ = kLongAgo;                       // when the clock stood still last
  std::unique_ptr<ros2::Timer> looking_;

  std::string first_;  // that said that it is simulated
  Time first_since_ = kLongAgo;
  Time runs_ = kLongAgo;  // when no node was held last
  bool told_of_pause_ = false;
  bool told_of_clock_ = false;
  bool told_of_no_clock_ = false;
  ClockStep system_clock_;
};

}  // namespace culprit::link
