// The port to a managed system. Everything that drives a manager does it through this: live robots,
// simulated ones, recordings.
//
//     class Tank : public Robot {
//       Time now() const override { return now_; }
//       void observe(Time until, std::vector<Observation>& observations) override {
//         now_ = std::min(until, now_ + 100ms);    // a simulation: its clock moves
//         observations.push_back({now_, SignalRead{SignalId(0), Value(level())}});
//       }
//       void execute(const Command& command) override {
//         replies_.push_back({command.id, carry_out(command), {}, ""});    // told by observe()
//       }
//     };
//
// examples/t02 is this in full.
#pragma once

#include <vector>

#include "robot/command.h"
#include "robot/observation.h"

namespace culprit {

// One thread calls all members of a Robot but interrupt().
class Robot {
 public:
  virtual ~Robot() = default;

  virtual Time now() const = 0;

  // Up to when all that the robot said was observed: no silence is judged later than that. It is not
  // after now().
  virtual Time observed_until() const { return now(); }

  // Waits until something was observed, or until `until` (kNever: without end), or until it is
  // interrupted. Appends what came, oldest first. A simulated robot moves its clock instead of
  // waiting.
  virtual void observe(Time until, std::vector<Observation>& observations) = 0;

  // Begins to carry out `command` and returns at once; a Reply follows as an observation.
  virtual void execute(const Command& command) = 0;

  // Lets the present or the next observe() return at once. From any thread. A robot that moves its
  // clock instead of waiting has nothing to do.
  virtual void interrupt() {}
};

}  // namespace culprit
