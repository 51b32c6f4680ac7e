// How late each rule shows a change of the value that it watches, beyond the time that its readings
// take: the delay of the node that measures or computes the value.
//
//   stated    before anything was observed: at most the least impact of the rule's strategies,
//             because the rule's author expects to see the effect of that strategy within it.
//             Presumably one cycle less (the author rounds up), and possibly not at all. How long a process
//             takes to start is no lateness: of a rule that only replaces processes nothing is presumed
//   learned   from how long after a proven repair the rule cleared: the shortest and the longest time; and
//             from how long after its effects it fired, if its repair cleared them, too. A rule that clears
//             soon may fire late, so evidence allows for what is stated, too.
//             How much longer that was than stated, at most, counts for the rules of which nothing was
//             learned yet: the same author underestimated them
//
// A statement is only an impact, and its author may not have thought of the monitor. So it is
// *unproven* until repairs, or failures that spread along the graph, show whether the monitors keep
// it. Meanwhile a rule of which nothing was learned may be later than stated (reckon_with). If the
// monitors exceed it, all such rules are taken to be as late as slow monitors of robots are.
//
// A status that carries the values of several rules comes from one monitor, which sees all of them
// at once: none of these rules is later than the others, and they have no lateness. A rule that only reports on
// a value that another one acts on does not count. Triggers on topics alone have no lateness: their thresholds say when they fire.
#pragma once

#include <vector>

#include "language/rule_set.h"

namespace culprit {

class Latencies {
 public:
  struct Range {
    Duration least{};
    Duration most{};      // >= least
    Duration presumed{};  // between them: to be compared with that of other rules

    bool operator==(const Range&) const = default;
  };
  // The shortest and the longest of `count` observed times; the presumed one is the shortest.
  struct Learned {
    static constexpr int kMost = 1'000'000'000;  // counts no further

    int count = 0;
    Range range;

    bool operator==(const Learned&) const = default;
  };

  // Do the monitors keep the lateness that the rule file states?
  enum class Statement : std::uint8_t { kUnproven, kKept, kExceeded };
  // A monitor that checks once a second, and debounces, is late by this.
  static constexpr Duration kSlowMonitor = std::chrono::seconds(3);
  // suspect() makes the patience no longer than this.
  static constexpr Duration kMostPatience = std::chrono::seconds(10);

  explicit Latencies(const RuleSet& rules);

  // Does the rule read a value of a monitor of its own? Only then it has a lateness.
  bool is_late(RuleId rule) const { return is_late_[rule.index]; }
  // The lateness that was learned for the rule; or else the one that the rule file states.
  Range lateness(RuleId rule) const;
  bool is_learned(RuleId rule) const { return learned_[rule.index].count > 0; }

  // The longest lateness that evidence about the rule has to allow for: the most of lateness(), or
  // longer while that is unproven.
  Duration reckon_with(RuleId rule) const;
  Statement statement() const { return statement_; }
  // Takes the evidence of failures that spread just now (analyze/lateness_watch.h): the logarithm of
  // how much likelier they are if the monitors exceed the statement than if they keep it. It counts
  // together with the latencies that were learned.
  void weigh(double spreading);

  // For how long after a strategy took effect the failure may still be shown: the most of lateness(), or what is
  // suspected.
  Duration patience(RuleId rule) const;
  // A strategy did not help within the patience, and helped at once when it was tried again. Its first try may
  // have helped, so long `after` it. Only stays() and cleared() show whether it was so.
  void suspect(RuleId rule, Duration after);
  // A strategy took effect so long ago, and the failure is still there.
  void stays(RuleId rule, Duration after);

  // A proven repair took effect, and the rule's trigger was false so long `after` that. Ignored for
  // rules that have no lateness.
  void cleared(RuleId rule, Duration after);
  // A failure that cleared with the rule's repair had begun so long before the rule fired, readings left out.
  // Ignored unless the lateness is learned.
  void fired(RuleId rule, Duration after);
  const Learned& learned(RuleId rule) const { return learned_[rule.index]; }
  // For what was learned in an earlier run. Ignored for the same rules: the trigger may have changed.
  void set(RuleId rule, const Learned& learned);
  // The lateness is the stated one again, and the excess that of the other rules.
  void forget(RuleId rule);

 private:
  void extend_excess(std::size_t rule);
  double repairs() const;

  std::vector<bool> is_late_;  // by rule: it reads values of a monitor of its own
  std::vector<Range> stated_;
  std::vector<Learned> learned_;
  // The patience that is tried out, by rule.
  struct Suspected {
    Duration after{};
    bool is_refuted = false;
  };
  std::vector<Suspected> suspected_;
  Duration cycle_;
  Duration excess_{};  // of what was learned over what was stated
  Statement statement_ = Statement::kUnproven;
};

}  // namespace culprit
