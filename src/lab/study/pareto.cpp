#include "study/pareto.h"

#include <algorithm>
#include <functional>

namespace culprit::study {
namespace {

bool beats(const std::vector<double>& a, const std::vector<double>& b) {
  return a != b && std::equal(a.begin(), a.end(), b.begin(), std::less_equal<>());
}

}  // namespace

std::vector<bool> pareto_front(const std::vector<std::vector<double>>& costs) {
  std::vector<bool> front;
  for (const auto& own : costs) {
    front.push_back(std::none_of(costs.begin(), costs.end(),
                                 [&](const auto& other) { return beats(other, own); }));
  }
  return front;
}

}  // namespace culprit::study
