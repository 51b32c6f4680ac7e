#include "knowledge/departures.h"

#include <algorithm>
#include <utility>

namespace culprit {

Departures::Departures(const RuleSet& rules) : members_(rules.components.size()) {}

const Departures::Launch* Departures::launch_of(ComponentId component) const {
  const int launcher = members_[component.index].launcher;
  const auto found = std::ranges::find(launches_, launcher, &Launch::launcher);
  return launcher == 0 || found == launches_.end() ? nullptr : &*found;
}

Departures::Launch* Departures::launch_of(ComponentId component) {
  return const_cast<Launch*>(std::as_const(*this).launch_of(component));
}

bool Departures::was_ended(const Launch& launch, const Member& member) const {
  return launch.ended != kNever && launch.is_wish && launch.left > 1 && member.has_left;
}

void Departures::arrived(ComponentId component, Time at) {
  Member& member = members_[component.index];
  const Launch* launch = launch_of(component);
  const bool is_back = launch != nullptr && was_ended(*launch, member);
  member = {};
  if (is_back) member.back = at;
  std::erase_if(launches_, [&](const Launch& each) {
    return std::ranges::find(members_, each.launcher, &Member::launcher) == members_.end();
  });
}

void Departures::launched(ComponentId component, int launcher) {
  members_[component.index].launcher = launcher;
  members_[component.index].has_left = false;
  if (launcher == 0) return;
  // A number that was given out anew is another launcher.
  std::erase_if(launches_,
                [&](const Launch& l) { return l.launcher == launcher && l.ended != kNever; });
  if (launch_of(component) == nullptr) launches_.push_back({.launcher = launcher});
}

void Departures::launcher_ended(int launcher, Time at) {
  const auto found = std::ranges::find(launches_, launcher, &Launch::launcher);
  if (found != launches_.end() && found->ended == kNever) found->ended = at;
}

void Departures::left(ComponentId component, Time at) {
  Launch* launch = launch_of(component);
  if (launch == nullptr || std::exchange(members_[component.index].has_left, true)) return;
  const bool is_first = later(launch->left_at, kTogether) < at;
  if (is_first) {
    launch->left = 0;
    launch->is_wish = later(launch->fell_at, kTogether) < at;
  }
  ++launch->left;
  launch->left_at = at;
}

void Departures::fell(ComponentId component, Time at) {
  Launch* launch = launch_of(component);
  if (launch == nullptr || std::exchange(members_[component.index].has_left, true)) return;
  launch->fell_at = at;
}

std::optional<Departures::Departure> Departures::of(ComponentId component, Time now) const {
  const Member& member = members_[component.index];
  if (member.back != kLongAgo && now < later(member.back, kBack))
    return Departure{What::kIsBack, member.launcher, later(member.back, kBack)};
  const Launch* launch = launch_of(component);
  if (launch == nullptr || launch->left == 0) return std::nullopt;
  if (was_ended(*launch, member)) return Departure{What::kHasEnded, launch->launcher, kNever};
  const Time until = launch->ended != kNever
                         ? later(std::max(launch->left_at, launch->ended), kAlone)
                         : later(launch->left_at, launch->left > 1 ? kTogether : kAlone);
  if (until <= now) return std::nullopt;
  return Departure{What::kIsEnding, launch->launcher, until};
}

}  // namespace culprit
