// Plays a recording to the rules of a test instead of a scripted robot.
#pragma once

#include <memory>
#include <vector>

#include "rule_test/runner.h"

namespace culprit::rule_test {

// `test` has a bag, at a path that can be opened as it is. Times of events count from its first message. The manager only
// advises, since nothing can be done in a recording. If the bag cannot be read, that is a disappointment.
Result run_bag_test(const RuleSet& rules, const Test& test, std::unique_ptr<const Planner> planner);

// The events by which a test of a bag is judged if it expects that a component is blamed. A preferred strategy that could
// not begin counts as chosen, for a recording seldom shows that its component was there.
std::vector<Event> with_preferred(const std::vector<Event>& events);

}  // namespace culprit::rule_test
