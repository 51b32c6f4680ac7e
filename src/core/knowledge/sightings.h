// What of the robot was seen at all: in this run, or in an earlier one on the same robot.
//
// Absent is not dead. What was never seen may be a name that no robot has, or a node that comes
// later: what triggers read of it is unknown, so nothing is done about it.
//
//   a component  was seen once its node was in the graph
//   a topic      once a node published it, or a message came on it
#pragma once

#include <optional>
#include <vector>

#include "base/time.h"
#include "language/rule_set.h"

namespace culprit {

class Sightings {
 public:
  explicit Sightings(const RuleSet& rules)
      : components_(rules.components.size()), topics_(rules.topics.size()) {}

  // Since when it is known. Of what an earlier run saw: since this one began.
  std::optional<Time> first(ComponentId id) const { return components_[id.index]; }
  std::optional<Time> first(TopicId id) const { return topics_[id.index]; }
  bool has(ComponentId id) const { return components_[id.index].has_value(); }
  bool has(TopicId id) const { return topics_[id.index].has_value(); }

  // Gives whether it was seen for the first time.
  bool note(ComponentId id, Time at) { return note(components_[id.index], at); }
  bool note(TopicId id, Time at) { return note(topics_[id.index], at); }

  // Another number whenever something was seen for the first time.
  std::size_t count() const { return count_; }

 private:
  bool note(std::optional<Time>& first, Time at) {
    if (first) return false;
    first = at;
    ++count_;
    return true;
  }

  std::vector<std::optional<Time>> components_;
  std::vector<std::optional<Time>> topics_;
  std::size_t count_ = 0;
};

}  // namespace culprit
