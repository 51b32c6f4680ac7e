// What a culprit that takes a robot over has to know of the one that managed it on another machine:
// what was learned, and what was tried and spent. (What people have ordered: standing_orders.h.)
//
// As text, by names, with a version: {"version": 1, "learned": ..., "past": [...]}. What belongs to
// the other machine is left out: its processes' numbers, and verdicts that nobody looked on for.
#pragma once

#include <string>
#include <vector>

#include "base/expected.h"
#include "base/time.h"
#include "journal/history.h"
#include "journal/learned.h"
#include "language/rule_set.h"

namespace culprit::journal {

struct Inheritance {
  // Events that are told; of more, the newest.
  static constexpr std::size_t kMostEvents = 1000;

  Learned learned;
  History past;
};

// Is it told to a successor?
bool is_inherited(const Event& event);

// What a manager leaves to a successor, gathered while it manages: each event becomes text once.
class Bequest {
 public:
  // `rules` must outlive it.
  explicit Bequest(const RuleSet& rules) : rules_(rules) {}

  // Whether it is told to a successor, or not.
  void add(const Event& event);
  // With what was learned. If all is too long for `most` bytes, the oldest events are left out;
  // empty if what was learned alone is too long.
  std::string text(const Learned& learned, std::size_t most) const;

 private:
  void add_row(const Event& event);

  const RuleSet& rules_;
  History past_;
  std::vector<std::string> rows_;  // of each of them
};
std::string to_text(const Inheritance& inheritance, const RuleSet& rules, std::size_t most);

// `shift`: what the clock shows here minus what it showed there; `now`: here. Leaves out what
// `rules` does not have, and takes what would be of the future for what happened now. Errors: it is
// of another version, or damaged.
Expected<Inheritance> inheritance_from_text(const std::string& text, const RuleSet& rules,
                                            Duration shift, Time now);

// What `theirs` was told to have learned replaces what was learned here; the rest stays.
void inherit(Learned& ours, const Learned& theirs);

// In the order in which it happened, and once: what was told of here (this culprit had managed
// before, and told it) is in both, at times that differ by what the way here takes.
History joined(const History& ours, const History& theirs, const RuleSet& rules);

}  // namespace culprit::journal
