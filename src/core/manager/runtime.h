// Drives a managing system over a robot: waits, steps, carries out.
//
// The only loop there is. It steps the managing system as soon as something was observed or one of
// its deadlines has passed; there is no period. A simulated robot runs through the same loop in
// virtual time.
//
//     Runtime runtime(manager, robot);
//     runtime.on_events = [&](std::span<const Event> events) { print(events); };
//     runtime.run(stop);    // elsewhere: stop = true; robot.interrupt();
// A host that drives the managing system by itself (examples/t02_robot_behind_the_port) has the same
// duties:
//
//  1. Time does not go back. `now` of a step is at least that of the step before, and at least the
//     time of each observation in it.
//  2. Step at once when something was observed, when an order came, and when next_deadline() has passed.
//  3. Carry out the commands of a step in their order, each exactly once, and none of an earlier process
//     of the manager. Reads may be repeated on the wire.
//  4. Give each command one Reply with its number, kTimedOut after its timeout at the latest.
//  5. Write what has to survive before the commands go out (before_commands): after a crash the journal
//     must not know less than the robot has seen.
//  6. Say when nothing could be heard: Overslept after a step that came more than kLate after its time,
//     HearingLost and HearingRegained around deafness. Else silence counts as the robot's.
//  7. Report the end of a process only with proof, by the operating system or by the whole time of a
//     lease.
//  8. Never drop an observation of a process or of the graph. Samples may be thinned; the newest stays.
//  9. One thread at a time calls the managing system.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <vector>

#include "base/mutex.h"
#include "manager/managing_system.h"
#include "robot/robot.h"

namespace culprit {

class Runtime {
 public:
  // If the host loop comes this much later than it was asked to, the process was suspended or did
  // not get the processor, and the manager is told so (Overslept). Less is within the times that
  // rules can be written for.
  static constexpr Duration kLate = std::chrono::milliseconds(50);
  // As the manager is told of it; nothing: it was in time.
  static std::optional<Observation> lateness(Time due, Time now);

  // Both must outlive the runtime.
  Runtime(ManagingSystem& manager, Robot& robot) : manager_(manager), robot_(robot) {}

  struct Step {
    Time now;
    Duration took;  // by the robot's clock
    std::vector<Observation>& observations;
    std::span<const Command> commands;
    std::span<const Event> events;
  };

  // Called after a step that has commands, before they go out, on the thread of run(): the robot
  // waits for whatever is done here.
  std::function<void(const Step&)> before_commands;

  // Called after every step, when its commands have gone out, on the thread of run(). It may take
  // the observations.
  std::function<void(const Step&)> on_step;

  // When a step is wanted though the manager has no reason for one; null: never. Called on the
  // thread of run().
  std::function<Time()> next_look;

  // Called after every step in which something happened, on the thread of run(). It must not block.
  std::function<void(std::span<const Event>)> on_events;

  // Runs until `stop` is set, or the robot's clock has come to `end`. The thread that sets `stop`
  // also has to interrupt the robot's waiting.
  void run(const std::atomic<bool>& stop, Time end = kNever);

  // One step, with observations from another source.
  void step(std::vector<Observation>& observations);

  // Gives the managing system an order, with its next step, which comes at once. From any thread,
  // as long as the runtime lives; orders that are submitted while run() does not run wait for it.
  void submit(Order order);

 private:
  Time next_deadline() const;
  void take_orders(std::vector<Observation>& observations);

  ManagingSystem& manager_;
  Robot& robot_;
  Time stepped_ = kLongAgo;  // when the last step began
  Mutex mutex_;
  std::vector<Order> orders_ CULPRIT_GUARDED_BY(mutex_);
};

}  // namespace culprit
