// A managing system that looks at the robot at its own pace, and takes time to decide.
//
// It processes observations when its next look is due, or when an awaited answer arrives; without a
// period it processes everything at once. A decision's requests go out after the time that deciding
// takes.
#pragma once

#include <deque>
#include <memory>
#include <string_view>
#include <utility>

#include "manager/manager.h"
#include "simulation/node.h"

namespace culprit::study {

struct Pace {
  Duration period{};          // between looks; 0: whenever something is observed
  simulation::Span decision;  // how long it takes
};

// For the baselines of the SUAVE study (their headers name the sources of the figures) and of
// ReBeT. Null for another name.
const Pace* find_pace(std::string_view baseline);

class PacedManager : public ManagingSystem {
 public:
  // `seed` is of the first look and of the times of decisions.
  PacedManager(std::unique_ptr<ManagingSystem> inner, const Pace& pace, Time start,
               std::uint64_t seed);

  std::vector<Command> step(Time now, std::span<const Observation> observations) override;
  Time next_deadline() const override;
  std::span<const Event> events() const override { return events_; }

 private:
  bool is_awake() const { return pace_.period == Duration::zero(); }
  void release(Time now, std::vector<Command>& commands);

  std::unique_ptr<ManagingSystem> inner_;
  Pace pace_;
  simulation::Random random_;
  Time next_look_;
  std::vector<Observation> unseen_;
  std::deque<std::pair<Time, Command>> decided_;  // by the time that they go out
  std::vector<Event> events_;
};

}  // namespace culprit::study
