#include "knowledge/group_health.h"

#include <algorithm>

namespace culprit {
namespace {

enum class Member : std::uint8_t { kUnknown, kUp, kChanging, kInactive, kDown };

bool hangs_in_transition(const ComponentState& state, Time now) {
  return state.lifecycle == Lifecycle::kTransition && state.changes_until <= now;
}

Member member(const ComponentState& state, Time now) {
  if (!state.alive) return Member::kUnknown;
  if (!*state.alive || hangs_in_transition(state, now)) return Member::kDown;
  switch (state.lifecycle) {
    case Lifecycle::kUnknown:
      return Member::kUnknown;
    case Lifecycle::kTransition:
      return Member::kChanging;
    case Lifecycle::kActive:
      return Member::kUp;
    case Lifecycle::kInactive:
      return Member::kInactive;
    case Lifecycle::kUnconfigured:
    case Lifecycle::kFinalized:
      return Member::kDown;
  }
  return Member::kUnknown;
}

// When the last change of a member is so long ago that nothing more is expected to follow it.
Time settled(const Group& group, const ComponentStates& components) {
  Time last = kLongAgo;
  for (const ComponentId id : group.members)
    last = std::max({last, components[id].lifecycle_since, components[id].alive_since});
  return last == kLongAgo ? kLongAgo : later(last, kGroupSettles);
}

}  // namespace

std::string_view to_string(GroupHealth health) {
  switch (health) {
    case GroupHealth::kUnknown:
      return "";
    case GroupHealth::kActive:
      return "active";
    case GroupHealth::kChanging:
      return "changing";
    case GroupHealth::kInactive:
      return "inactive";
    case GroupHealth::kDown:
      return "down";
    case GroupHealth::kHalfUp:
      return "half_up";
  }
  return "";
}

GroupHealth health_of(const Group& group, const ComponentStates& components, Time now) {
  const auto all = [&](Member wanted) {
    return std::ranges::all_of(
        group.members, [&](ComponentId id) { return member(components[id], now) == wanted; });
  };
  const auto any = [&](Member wanted) {
    return std::ranges::any_of(
        group.members, [&](ComponentId id) { return member(components[id], now) == wanted; });
  };
  if (all(Member::kUp)) return GroupHealth::kActive;
  if (any(Member::kUnknown)) return GroupHealth::kUnknown;
  // A member that ended during a pause does not end the pause.
  const bool is_paused =
      std::ranges::all_of(group.members, [&](ComponentId id) { return components[id].is_paused; });
  if (is_paused && !any(Member::kUp) && !any(Member::kChanging)) return GroupHealth::kInactive;
  if (any(Member::kChanging) || now < settled(group, components)) return GroupHealth::kChanging;
  if (all(Member::kInactive)) return GroupHealth::kInactive;
  return all(Member::kDown) ? GroupHealth::kDown : GroupHealth::kHalfUp;
}

Time settles_at(const Group& group, const ComponentStates& components, Time now) {
  Time next = settled(group, components);
  if (next <= now) next = kNever;
  for (const ComponentId id : group.members) {
    const ComponentState& state = components[id];
    if (state.lifecycle == Lifecycle::kTransition && state.changes_until > now)
      next = std::min(next, state.changes_until);
  }
  return next;
}

}  // namespace culprit
