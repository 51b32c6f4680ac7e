#include "plan/bayes/side_by_side.h"

#include <algorithm>
#include <functional>
#include <map>

#include "plan/ties.h"

namespace culprit::plan {

std::vector<std::size_t> side_by_side(std::span<const Timed> options,
                                      std::vector<std::size_t> chosen) {
  if (chosen.size() < 2) return chosen;
  std::vector<double> longest;  // the two longest
  for (const std::size_t c : chosen) longest.push_back(options[c].time);
  std::partial_sort(longest.begin(), longest.begin() + 2, longest.end(), std::greater<>());
  std::multimap<std::size_t, std::size_t> of_failure;
  for (std::size_t o = 0; o < options.size(); ++o) of_failure.emplace(options[o].failure, o);

  for (std::size_t& best : chosen) {
    const Timed& first = options[best];
    const double meanwhile = first.time == longest[0] ? longest[1] : longest[0];
    const auto beyond = [&](const Timed& option) {
      return parts(option.cost - std::min(option.time, meanwhile));
    };
    const auto [begin, end] = of_failure.equal_range(first.failure);
    for (auto other = begin; other != end; ++other) {
      const Timed& option = options[other->second];
      const bool takes_the_same = std::equal(option.takes.begin(), option.takes.end(),
                                             first.takes.begin(), first.takes.end());
      if (takes_the_same && beyond(option) < beyond(options[best])) best = other->second;
    }
  }
  return chosen;
}

}  // namespace culprit::plan
