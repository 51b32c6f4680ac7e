// Failures that clear by themselves: how often, and after how long.
//
// Some monitors report a failure that is over a few seconds later, although nothing was repaired. A
// repair of such a failure is useless, and takes down what works. So the planner waits for it first
// (plan/bayes/planning_step.cpp), as soon as that was seen to happen on this robot. Symbols:
//
//     n_r   how often the failure of rule r cleared by itself: without a repair that can have helped, and
//           not with a trouble upstream. It then stayed away for as long as it had lasted.
//     m_r   how often it did not clear, although it was left alone for long enough, or came back sooner.
//     s_r   the share that clears by itself: (n_r + 2 s) / (n_r + m_r + 2). s = n / (n + m + 1) is that of
//           all rules that repair something; n = 0 while they do not count.
//     T_r   the longest time until it cleared by itself. While n_r < 3, all rules count, once n >= 3 and of two rules:
//           one failure of another component says nothing.
//
// The longest of few is short of what may come. So the planner leaves the failure alone for at most this
// time, with n in place of n_r where all rules count:
//
//     min(T_r (1 + 2 / n_r), kLongest)
//
// While n = 0, the planner waits for no failure to clear.
#pragma once

#include <vector>

#include "base/time.h"
#include "language/rule_set.h"

namespace culprit {

class Transients {
 public:
  // A failure that lasted longer did not clear by itself, and none is left alone for longer.
  static constexpr Duration kLongest = std::chrono::seconds(10);

  struct Seen {
    static constexpr int kMost = 1'000'000'000;  // counts no further

    int cleared = 0;     // n_r
    int stayed = 0;      // m_r
    Duration longest{};  // T_r

    bool operator==(const Seen&) const = default;
  };

  explicit Transients(const RuleSet& rules) : seen_(rules.rules.size()) {}

  // The failure was there from `detected` to `gone`, and nothing was done that can have cleared it.
  void cleared(RuleId rule, Time detected, Time gone);
  // It is there again.
  void came_back(RuleId rule);
  // It did not clear by itself.
  void stayed(RuleId rule);
  // Counts those that stayed away for long enough. Once a step, before came_back().
  void advance(Time now);
  // culprit did not watch for a while: it is unknown whether those stayed away.
  void restart() { open_.clear(); }

  // s_r
  double share(RuleId rule) const;
  // T_r; zero: none was seen to clear by itself.
  Duration longest(RuleId rule) const;
  // How long a failure of the rule is left alone at most.
  Duration patience(RuleId rule) const;

  const Seen& seen(RuleId rule) const { return seen_[rule.index]; }
  // For what was learned in an earlier run, which may come in parts.
  void add(RuleId rule, const Seen& seen);
  void forget(RuleId rule);

 private:
  // It cleared, and counts unless it is back by `due`.
  struct Open {
    RuleId rule;
    Duration lasted{};
    Time due{};
  };

  // The rule's own counts, or those of all rules while the rule has too few.
  const Seen& basis(RuleId rule) const;
  void set(RuleId rule, const Seen& seen);

  std::vector<Seen> seen_;  // by rule
  Seen pooled_;             // of all
  std::vector<Open> open_;
};

}  // namespace culprit
