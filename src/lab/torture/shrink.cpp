#include <algorithm>
#include <cstdio>
#include <utility>

#include "base/invariant.h"
#include "torture/torture.h"

namespace culprit::torture {
namespace {

bool is_violated(const Scenario& scenario) { return run(scenario).violation.has_value(); }

// Leaves out what can be left out of `items`, and gives whether anything was.
template <class Items>
bool leave_out(Scenario& scenario, Items Scenario::*items) {
  bool is_smaller = false;
  for (std::size_t i = (scenario.*items).size(); i-- > 0;) {
    Scenario smaller = scenario;
    (smaller.*items).erase((smaller.*items).begin() + static_cast<std::ptrdiff_t>(i));
    if (!is_violated(smaller)) continue;
    scenario = std::move(smaller);
    is_smaller = true;
  }
  return is_smaller;
}

template <class Change>
bool simplify(Scenario& scenario, const Change& change) {
  Scenario simpler = scenario;
  if (!change(simpler) || !is_violated(simpler)) return false;
  scenario = std::move(simpler);
  return true;
}

template <class T>
bool clear(T& part) {
  return std::exchange(part, T{}) != T{};
}

}  // namespace

Scenario shrink(Scenario scenario) {
  CULPRIT_ASSERT(run(scenario).violation);
  while (true) {
    bool is_smaller = leave_out(scenario, &Scenario::mishaps);
    // No other part needs the last one.
    is_smaller |= simplify(scenario, [](Scenario& s) {
      const std::size_t last = s.parts.size() - 1;
      const bool is_used = std::any_of(s.mishaps.begin(), s.mishaps.end(),
                                       [&](const Mishap& m) { return m.part == last; });
      if (last == 0 || is_used) return false;
      s.parts.pop_back();
      return true;
    });
    is_smaller |= simplify(scenario, [](Scenario& s) { return clear(s.noise.loss); });
    is_smaller |= simplify(scenario, [](Scenario& s) { return clear(s.noise.duplication); });
    is_smaller |= simplify(scenario, [](Scenario& s) { return clear(s.noise.lateness); });
    is_smaller |= simplify(scenario, [](Scenario& s) { return clear(s.noise.lost_reply); });
    is_smaller |= simplify(scenario, [](Scenario& s) { return clear(s.noise.false_success); });
    is_smaller |= simplify(scenario, [](Scenario& s) { return clear(s.noise.false_failure); });
    for (std::size_t i = 0; i < scenario.parts.size(); ++i)
      is_smaller |= simplify(scenario, [&](Scenario& s) { return clear(s.parts[i].needs); });
    if (!is_smaller) return scenario;
  }
}

std::string report(const Scenario& smallest) {
  const RunOutcome outcome = run(smallest);
  std::string text;
  for (const std::string& line : outcome.timeline) text += line + "\n";
  char at[32];
  std::snprintf(at, sizeof at, "%.3f", seconds(outcome.violation->at.time_since_epoch()));
  return text + "seed " + std::to_string(smallest.seed) + ": " + outcome.violation->what + ", at " +
         at + " s\n";
}

}  // namespace culprit::torture
