// The knowledge that a culprit needs when it takes a robot over from one on another machine: what
// that one has learned, tried and spent. (Orders of people: standing_orders.h.)
//
// As text, by names, with a version: {"version": 1, "learned": ..., "past": [...]}. It leaves out
// what belongs to the other machine: the PIDs of its processes, and verdicts whose time passed
// while no culprit ran.
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
  // Events for the successor; of more, the newest.
  static constexpr std::size_t kMostEvents = 1000;

  Learned learned;
  History past;
};

// Does a successor need it?
bool is_inherited(const Event& event);

// The events and beliefs that a manager leaves to a successor, gathered while it manages: each
// event becomes text once.
class Bequest {
 public:
  // `rules` must outlive it.
  explicit Bequest(const RuleSet& rules) : rules_(rules) {}

  // Keeps the event if a successor needs it.
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

// `shift`: this machine's clock minus the other one's; `now`: here. Leaves out what `rules` does
// not have, and takes what would be of the future for what happened now. Errors: it is of another
// version, or damaged.
Expected<Inheritance> inheritance_from_text(const std::string& text, const RuleSet& rules,
                                            Duration shift, Time now);

// Each part that `theirs` has replaces the same part of `ours`; the rest stays.
void inherit(Learned& ours, const Learned& theirs);

// Joins both in the order of time, each event once. An event that this culprit sent earlier, when
// it managed, is in both; its times differ by the delay of the way back.
History joined(const History& ours, const History& theirs, const RuleSet& rules);

}  // namespace culprit::journal
