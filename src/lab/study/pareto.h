// Which of several choices are on the Pareto front: those that no other beats. One beats another if
// it is at least as good in everything, and better in something.
#pragma once

#include <vector>

namespace culprit::study {

// `costs`: of each choice equally many, all better if lower.
std::vector<bool> pareto_front(const std::vector<std::vector<double>>& costs);

}  // namespace culprit::study
