// Rules on a recorded bag: what they detect, and at the end what became of each.
//
//     BagReplay replay(rules, planner, reading, listener);
//     while (bag.next(message)) replay.step(message);
//     for (const RuleOutcome& outcome : replay.outcomes()) ...
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bag/bag_reading.h"
#include "manager/manager.h"

namespace culprit::replay {

struct RuleOutcome {
  RuleId rule;
  std::uint64_t times = 0;                    // it was detected
  std::optional<Time> first{};                // then it was detected first, as BagMessage::at
  std::optional<std::int64_t> first_clock{};  // ns since 1970, as recorded
  Duration longest{};                         // that it was there
  Duration total{};
  bool is_on = false;      // when the recording ended, its trigger was true or unknown
  Duration known{};        // how long its trigger was true or false
  bool was_known = false;  // it was, once at least
  // Why its trigger had no value: what the bag does not have. Empty if it has all.
  std::vector<std::string> why_unknown{};
};

// The part of a recording that is reported and counted.
struct BagStretch {
  Time from = kLongAgo;  // as BagMessage::at; what was before is known
};

class BagReplay {
 public:
  struct Listener {
    // Each event but those that say nothing about a recording. `clock`: ns since 1970, as recorded.
    std::function<void(const Event&, std::int64_t clock)> on_event{};
    // The copy lacks messages in between; nothing that is missing there counts.
    std::function<void(Time from, Time until, std::int64_t clock)> on_hole{};
    // A rule can be judged from now on, or no longer: its trigger got a value, or lost it.
    std::function<void(RuleId, bool is_known, std::int64_t clock)> on_judged{};
    // Each observation from a message, with the recorder's time of it.
    std::function<void(const Observation&, std::int64_t clock)> on_observation{};
  };

  // `rules` and `reading` must outlive the replay.
  BagReplay(const RuleSet& rules, std::unique_ptr<const Planner> planner, bag::BagReading& reading,
            Listener listener, BagStretch stretch = {});

  void step(const bag::BagMessage& message);

  // By rule. A failure that is still there counts until the last message.
  std::vector<RuleOutcome> outcomes() const;

  std::uint64_t messages() const { return messages_; }
  std::uint64_t decisions() const { return decisions_; }  // strategies that were chosen
  std::optional<Time> start() const { return start_; }
  std::int64_t start_clock() const { return start_clock_; }
  Time end() const { return now_; }

 private:
  struct State {
    RuleOutcome outcome;
    bool is_on = false;               // it is there
    std::optional<Time> on_since;     // it is there, and its trigger is known
    Duration lasted{};                // before that
    std::optional<Time> known_since;  // its trigger is known
  };

  void begin(const bag::BagMessage& message);
  void advance(Time now, std::span<const Observation> observations);
  void take_events();
  void note_triggers();
  void end_failure(RuleId rule, Time at);
  std::optional<Time> trigger_over(RuleId rule) const;
  void pause(State& state, Time at);
  void go_on(State& state, Time at);
  Duration counted(Time from, Time until) const;

  const RuleSet& rules_;
  bag::BagReading& reading_;
  Listener listener_;
  BagStretch stretch_;
  std::unique_ptr<const Planner> planner_;
  std::optional<Manager> manager_;
  std::vector<State> states_;
  std::vector<Observation> observations_;
  std::vector<bool> was_known_;  // by rule, before a hole
  std::optional<Time> start_;
  std::int64_t start_clock_ = 0;
  std::int64_t clock_offset_ = 0;  // from BagMessage::at to the clock of the recorder
  Time now_{};
  std::uint64_t messages_ = 0;
  std::uint64_t decisions_ = 0;
};

}  // namespace culprit::replay
