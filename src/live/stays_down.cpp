#include "live/stays_down.h"

#include <algorithm>

namespace culprit::live {
namespace {

// Those that `is_forgotten` stay down no more.
template <class IsForgotten>
void forget_if(History& past, IsForgotten is_forgotten) {
  for (Event& event : past) {
    if (auto* down = std::get_if<StaysDown>(&event.what))
      std::erase_if(down->components, is_forgotten);
  }
  std::erase_if(past, [](const Event& event) {
    const auto* down = std::get_if<StaysDown>(&event.what);
    return down != nullptr && down->components.empty();
  });
}

bool is_renamed(const Component& declared, const KnownRobot& known) {
  bool was_another = false;
  for (const KnownRobot::Part& part : known.parts) {
    if (part.component != declared.name) continue;
    if (declared.node.empty() || declared.node == part.node) return false;
    was_another = true;
  }
  return was_another;
}

}  // namespace

std::set<ComponentId> that_stay_down(const History& past) {
  std::set<ComponentId> all;
  for (const Event& event : past) {
    if (const auto* down = std::get_if<StaysDown>(&event.what))
      all.insert(down->components.begin(), down->components.end());
  }
  return all;
}

void forget_the_renamed(const KnownRobot& known, const RuleSet& rules, History& past) {
  const auto renamed = [&](ComponentId component) { return is_renamed(rules[component], known); };
  forget_if(past, renamed);
  std::erase_if(past, [&](const Event& event) {
    const auto* found = std::get_if<ComponentFound>(&event.what);
    return found != nullptr && renamed(found->component);
  });
}

void forget_that_stay_down(const std::vector<KnownRobot::Part>& launched, const RuleSet& rules,
                           History& past) {
  forget_if(past, [&](ComponentId component) {
    return std::ranges::find(launched, rules[component].name, &KnownRobot::Part::component) !=
           launched.end();
  });
}

}  // namespace culprit::live
