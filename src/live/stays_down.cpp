#include "live/stays_down.h"

#include <algorithm>

namespace culprit::live {

std::set<ComponentId> that_stay_down(const History& past) {
  std::set<ComponentId> all;
  for (const Event& event : past) {
    if (const auto* down = std::get_if<StaysDown>(&event.what))
      all.insert(down->components.begin(), down->components.end());
  }
  return all;
}

void forget_that_stay_down(const std::vector<KnownRobot::Part>& launched, const RuleSet& rules,
                           History& past) {
  for (Event& event : past) {
    auto* down = std::get_if<StaysDown>(&event.what);
    if (down == nullptr) continue;
    std::erase_if(down->components, [&](ComponentId component) {
      return std::ranges::find(launched, rules[component].name, &KnownRobot::Part::component) !=
             launched.end();
    });
  }
  std::erase_if(past, [](const Event& event) {
    const auto* down = std::get_if<StaysDown>(&event.what);
    return down != nullptr && down->components.empty();
  });
}

}  // namespace culprit::live
