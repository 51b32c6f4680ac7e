#include "rule_test/rule_scenario.h"

namespace culprit::rule_test {
namespace {

template <class T>
void append_all(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

void Scenario::append(const Scenario& other) {
  append_all(courses, other.courses);
  append_all(endpoints, other.endpoints);
  append_all(needs, other.needs);
  append_all(origins, other.origins);
  append_all(states, other.states);
  append_all(incidents, other.incidents);
  append_all(goals, other.goals);
  append_all(logs, other.logs);
  append_all(answers, other.answers);
  append_all(cures, other.cures);
}

}  // namespace culprit::rule_test
