#include "knowledge/departures.h"

#include <algorithm>
#include <utility>

#include "base/invariant.h"

namespace culprit {
namespace {

// A crash, and the good-bye on the wire that shows it to be an orderly end after all.
constexpr Duration kOneEnd = std::chrono::milliseconds(100);

}  // namespace

Departures::Departures(const RuleSet& rules) : members_(rules.components.size()) {
  for (std::size_t c = 0; c < rules.components.size(); ++c)
    members_[c].has_owner = rules.components[c].has_owner() || rules.components[c].composed;
}

const Departures::Launch* Departures::launch_of(ComponentId component) const {
  const int launcher = members_[component.index].launcher;
  const auto found = std::ranges::find(launches_, launcher, &Launch::launcher);
  return launcher == 0 || found == launches_.end() ? nullptr : &*found;
}

Departures::Launch* Departures::launch_of(ComponentId component) {
  return const_cast<Launch*>(std::as_const(*this).launch_of(component));
}

// ---- what is seen

void Departures::arrived(ComponentId component, int pid, Time at, By by) {
  Member& member = members_[component.index];
  has_changed_ = true;
  if (pid != 0 && member.started_pid == pid) {
    member.is_there = true;
    member.has_left = false;
    return;
  }
  // A launch whose end was not seen may have a successor that has run for long.
  const bool is_back = member.down && member.down != StaysDown::Why::kUnseen;
  const bool is_returned = member.has_left && by == By::kOther;
  const Member before = std::exchange(member, {.is_there = true, .has_owner = member.has_owner});
  // It may be the same process, found by a new culprit, or once its computer is in reach again. Its state tells (is_up()).
  if (before.down == StaysDown::Why::kShutDown) {
    member.down = before.down;
    member.is_told = before.is_told;
  }
  if (is_back) member.back = at;
  if (is_returned) member.returned = at;
  forget_unused_launches();
}

void Departures::started_here(const StartedHere& seen, Time at) {
  Member& member = members_[seen.component.index];
  has_changed_ = true;
  member.started_pid = seen.pid;
  member.since = at - seen.runs_for;
  member.is_ours = true;
  member.returned = kLongAgo;
  member.launcher = seen.launcher;
  if (seen.launcher != 0 && launch_of(seen.component) == nullptr)
    launches_.push_back({.launcher = seen.launcher});
  forget_unused_launches();
}

void Departures::launched(ComponentId component, int launcher) {
  Member& member = members_[component.index];
  has_changed_ = true;
  if (!member.is_ours || member.launcher != launcher) {
    member.launcher = launcher;
    member.is_ours = false;
    member.has_left = false;
    if (launcher == 0) return;
    // PIDs are reused: another launcher has the number of one that ended.
    std::erase_if(launches_,
                  [&](const Launch& l) { return l.launcher == launcher && l.ended != kNever; });
    if (launch_of(component) == nullptr) launches_.push_back({.launcher = launcher});
  }
  if (Launch* launch = launch_of(component)) launch->was_seen = true;
}

void Departures::launcher_ended(const LauncherSeen& seen, Time at) {
  const auto found = std::ranges::find(launches_, seen.pid, &Launch::launcher);
  if (found == launches_.end()) return;
  has_changed_ = true;
  // Each component reports what ran when its own process had ended; for the last one nothing did.
  found->ran_others = seen.ran_others && (found->ended == kNever || found->ran_others);
  if (found->ended != kNever) return;
  found->ended = at;
  found->has_crashed = seen.has_crashed;
}

void Departures::left(ComponentId component, Time at) {
  Member& member = members_[component.index];
  Launch* launch = launch_of(component);
  const bool was_crash = member.has_left && member.has_crashed && launch != nullptr &&
                         launch->fell == component && at <= later(launch->fell_at, kOneEnd);
  if (was_crash) {
    launch->fell_at = std::exchange(launch->fell_before, kLongAgo);
    launch->fell.reset();
    member.has_crashed = false;
  } else if (std::exchange(member.has_left, true)) {
    return;
  }
  has_changed_ = true;
  if (member.has_owner) member.owner_is_asked_until = later(at, kAlone);
  if (launch == nullptr) return;
  if (launch->left == 0 || later(launch->left_at, kTogether) < at) {
    launch->left = 0;
    launch->left_first = at;
    launch->failed.reset();
  }
  ++launch->left;
  launch->left_at = at;
}

// It may have left already: it said good-bye. Two that fail one after the other do not leave together.
void Departures::failed(ComponentId component, Time at) {
  left(component, at);
  Launch* launch = launch_of(component);
  if (launch == nullptr) return;
  const bool is_second = launch->left == 2 && launch->failed;
  if (is_second && later(launch->failed_at, kFailedAlone) < launch->left_at) {
    launch->left = 1;
    launch->left_first = launch->left_at;
  }
  launch->failed = component;
  launch->failed_at = launch->left_at;
}

void Departures::fell(ComponentId component, Time at) {
  Member& member = members_[component.index];
  if (std::exchange(member.has_left, true)) return;
  has_changed_ = true;
  member.has_crashed = true;
  Launch* launch = launch_of(component);
  if (launch == nullptr) return;
  // A launcher that kills ends only after that.
  if (has_outlived(*launch, at)) {
    member.launcher = 0;
    return;
  }
  const bool are_leaving = launch->left > 0 && later(launch->left_at, kTogether) >= at;
  if (are_leaving || launch->ended != kNever) return;
  launch->fell_before = std::exchange(launch->fell_at, at);
  launch->fell = component;
}

void Departures::ended_here(ComponentId component, Time at) {
  if (std::exchange(members_[component.index].has_left, true)) return;
  has_changed_ = true;
  Launch* launch = launch_of(component);
  if (launch == nullptr) return;
  launch->ended_here_at = at;
  // It had outlived its launcher.
  if (launch->ended != kNever) members_[component.index].launcher = 0;
}

void Departures::lost(ComponentId component) {
  has_changed_ |= !std::exchange(members_[component.index].has_left, true);
}

void Departures::ended_by_order(ComponentId component, StaysDown::Why why) {
  Member& member = members_[component.index];
  if (member.down) return;
  has_changed_ = true;
  member.down = why;
  member.is_told = false;
}

void Departures::is_up(ComponentId component) {
  Member& member = members_[component.index];
  if (member.down == StaysDown::Why::kShutDown) member.down.reset();
}

void Departures::goes_on(ComponentId component, Time at) {
  Member& member = members_[component.index];
  if (member.down != StaysDown::Why::kStopped && member.down != StaysDown::Why::kFrozen) return;
  member.down.reset();
  member.back = at;
}

// Its process is the same, and so is its launch.
void Departures::loaded(ComponentId component, Time at) {
  Member& member = members_[component.index];
  if (member.down != StaysDown::Why::kUnloaded) return;
  member.down.reset();
  member.has_left = false;
  member.back = at;
}

// ---- what people order

void Departures::revive(std::optional<ComponentId> component) {
  for (std::size_t c = 0; c < members_.size(); ++c) {
    if (component && component->index != c) continue;
    Member& member = members_[c];
    if (!std::exchange(member.down, std::nullopt)) continue;
    member.launcher = 0;
    member.owner_is_asked_until = kLongAgo;
  }
  forget_unused_launches();
}

void Departures::end_started() {
  for (Member& member : members_) {
    if (!member.is_ours || !member.is_there || member.has_left || member.down) continue;
    member.down = StaysDown::Why::kOrder;
    member.is_told = false;
    has_changed_ = true;
  }
}

// ---- what follows

bool Departures::is_original_left(const Launch& launch) const {
  return std::ranges::any_of(members_, [&](const Member& m) {
    return m.launcher == launch.launcher && !m.is_ours && !m.has_left;
  });
}

bool Departures::has_stand_in(const Launch& launch) const {
  return std::ranges::any_of(
      members_, [&](const Member& m) { return m.launcher == launch.launcher && m.is_ours; });
}

bool Departures::is_any_orphan() const {
  return std::ranges::any_of(members_, [](const Member& m) {
    return m.is_there && !m.is_ours && !m.has_left && m.launcher == 0;
  });
}

Departures::Verdict Departures::verdict(const Launch& launch, Time now) const {
  CULPRIT_ASSERT(launch.ended != kNever);
  const bool are_leaving = launch.left > 0 && launch.left_first <= later(launch.ended, kTogether) &&
                           launch.ended <= later(launch.left_at, kTogether);
  // The exit code of ros2 launch is 1 after an error of its own shutdown, too.
  const bool took_all_along = are_leaving && (launch.left > 1 || !is_original_left(launch));
  if (launch.has_crashed && !took_all_along) return {Verdict::What::kGoesOn};
  const bool is_over = (are_leaving && launch.left > 1) || !is_original_left(launch);
  if (!is_over) {
    const Time until = later(launch.ended, kTogether);
    return now < until ? Verdict{Verdict::What::kOpen, until} : Verdict{Verdict::What::kGoesOn};
  }
  // culprit did not run when the launcher ended, so it may have crashed: then others run on.
  if (!launch.was_seen) {
    const Time until = later(launch.ended, kAlone);
    if (now < until) return {Verdict::What::kOpen, until};
    if (is_any_orphan()) return {Verdict::What::kGoesOn};
    return {Verdict::What::kEnded, kNever, StaysDown::Why::kUnseen};
  }
  if (!are_leaving && !launch.ran_others && !has_stand_in(launch)) return {Verdict::What::kGoesOn};
  const Time began = are_leaving ? std::min(launch.left_first, launch.ended) : launch.ended;
  const auto is_soon_after = [&](Time at, Duration soon = kDoubt) {
    return at != kLongAgo && at <= began && began <= later(at, soon);
  };
  // Its last process crashed, or culprit ended that. On a busy computer it takes seconds to end.
  const bool had_nothing_left = !are_leaving && !launch.ran_others;
  if (had_nothing_left && is_soon_after(std::max(launch.fell_at, launch.ended_here_at), kTogether))
    return {Verdict::What::kGoesOn};
  if (is_soon_after(launch.ended_here_at)) return {Verdict::What::kBroken};
  const bool has_failed = are_leaving && launch.left == 1 && launch.failed;
  if (!is_soon_after(launch.fell_at) && !has_failed)
    return {Verdict::What::kEnded, kNever, StaysDown::Why::kPerson};
  if (revives_) return {Verdict::What::kBroken};
  const Duration after = has_failed ? launch.ended - began : began - launch.fell_at;
  return {Verdict::What::kEnded, kNever, StaysDown::Why::kDoubt,
          has_failed ? launch.failed : launch.fell, after};
}

bool Departures::has_outlived(const Launch& launch, Time at) {
  return launch.verdict.what == Verdict::What::kEnded && later(launch.ended, kDoubt) < at;
}

// Its components are of no launch from now on.
void Departures::dissolve(const Launch& launch) {
  const int launcher = launch.launcher;
  CULPRIT_ASSERT(launcher != 0);
  for (Member& member : members_) {
    if (member.launcher == launcher) member.launcher = 0;
  }
}

// A component that ends while the launch still ends its components stays down with it. One that
// runs on after that is of no launch.
void Departures::take_down(const Launch& launch, Time now) {
  CULPRIT_ASSERT(launch.launcher != 0);  // all that are of no launch would be ended, and stay down
  CULPRIT_ASSERT(launch.verdict.what == Verdict::What::kEnded);
  const Time over = later(launch.ended, kTogether);
  for (Member& member : members_) {
    if (member.launcher != launch.launcher || member.down) continue;
    const bool runs = !member.is_ours && !member.has_left;
    if (!runs) {
      member.down = launch.verdict.why;
      member.is_told = false;
    } else if (now >= over) {
      member.launcher = 0;
    } else {
      settles_at_ = std::min(settles_at_, over);
    }
  }
}

Departures::Settled Departures::settle(Time now) {
  Settled settled;
  if (!has_changed_ && now < settles_at_) return settled;
  has_changed_ = false;
  settles_at_ = kNever;
  for (Launch& launch : launches_) {
    if (launch.ended == kNever) continue;
    if (launch.verdict.what == Verdict::What::kOpen) launch.verdict = verdict(launch, now);
    switch (launch.verdict.what) {
      case Verdict::What::kOpen:
        settles_at_ = std::min(settles_at_, launch.verdict.until);
        break;
      case Verdict::What::kBroken:
        settled.broken.push_back(launch.launcher);
        dissolve(launch);
        break;
      case Verdict::What::kGoesOn:
        dissolve(launch);
        break;
      case Verdict::What::kEnded:
        take_down(launch, now);
        break;
    }
  }
  for (std::size_t c = 0; c < members_.size(); ++c) {
    Member& member = members_[c];
    if (!member.down || std::exchange(member.is_told, true)) continue;
    StaysDown down{{ComponentId(c)}, *member.down};
    const Launch* launch = launch_of(ComponentId(c));
    if (launch != nullptr && launch->verdict.what == Verdict::What::kEnded) {
      down.launcher = launch->launcher;
      if (down.why == StaysDown::Why::kDoubt) {
        down.fell = launch->verdict.fell;
        down.after = launch->verdict.after;
      }
    }
    const auto same = std::ranges::find_if(settled.down, [&](const StaysDown& each) {
      return each.why == down.why && each.launcher == down.launcher;
    });
    if (same == settled.down.end()) {
      settled.down.push_back(std::move(down));
    } else {
      same->components.emplace_back(c);
    }
  }
  forget_unused_launches();
  return settled;
}

void Departures::remember(const StaysDown& told) {
  for (const ComponentId component : told.components) {
    Member& member = members_[component.index];
    member.down = told.why;
    member.is_told = true;
    member.has_left = true;
  }
}

void Departures::forget_unused_launches() {
  std::erase_if(launches_, [&](const Launch& each) {
    return std::ranges::find(members_, each.launcher, &Member::launcher) == members_.end();
  });
}

std::optional<Departures::Departure> Departures::of(ComponentId component, Time now) const {
  const Member& member = members_[component.index];
  if (member.back != kLongAgo && now < later(member.back, kBack))
    return Departure{What::kIsBack, member.launcher, later(member.back, kBack)};
  if (member.down) return Departure{What::kStaysDown, member.launcher, kNever, *member.down};
  if (now < member.owner_is_asked_until)
    return Departure{What::kIsEnding, 0, member.owner_is_asked_until};
  const Launch* launch = launch_of(component);
  if (launch == nullptr || launch->left == 0) return std::nullopt;
  const bool together = launch->left > 1 || (has_stand_in(*launch) && !is_original_left(*launch));
  const Duration alone = launch->failed ? kFailedAlone : kAlone;
  const Time until = launch->ended != kNever
                         ? later(std::max(launch->left_at, launch->ended), kAlone)
                         : later(launch->left_at, together ? kTogether : alone);
  if (until <= now) return std::nullopt;
  return Departure{What::kIsEnding, launch->launcher, until};
}

int Departures::to_end(ComponentId component) const {
  const Member& member = members_[component.index];
  return member.down && member.is_ours && member.is_there && !member.has_left ? member.started_pid
                                                                              : 0;
}

std::vector<Departures::Started> Departures::started() const {
  std::vector<Started> all;
  for (std::size_t c = 0; c < members_.size(); ++c) {
    const Member& member = members_[c];
    if (member.is_ours && member.is_there && !member.has_left)
      all.push_back({ComponentId(c), member.started_pid, member.launcher, member.since});
  }
  return all;
}

}  // namespace culprit
