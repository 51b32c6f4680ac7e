#include "bag_doctor/habit.h"

#include <algorithm>

namespace culprit::bag_doctor {
namespace {

constexpr std::size_t kMostGaps = 3;
constexpr std::size_t kWindow = 20;  // pauses

Duration at_share(std::vector<Duration>& pauses, double share) {
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(pauses.size() - 1));
  std::nth_element(pauses.begin(), pauses.begin() + place, pauses.end());
  return pauses[static_cast<std::size_t>(place)];
}

std::vector<Stretch> gaps_in(std::span<const std::int64_t> times, Habit& habit) {
  std::vector<Stretch> all;
  for (std::size_t i = 1; i < times.size(); ++i) all.push_back({times[i - 1], times[i]});
  std::ranges::stable_sort(all, std::greater{}, &Stretch::length);
  const Duration rest = all[std::min(kMostGaps, all.size() - 1)].length();
  const Duration stands_out(
      static_cast<std::int64_t>(kStandsOut * static_cast<double>(rest.count())));
  const Duration least = std::max({kGap * habit.usual, kShortestGap, stands_out});
  std::vector<Stretch> gaps;
  for (const Stretch& each : all) {
    if (gaps.size() < kMostGaps && each.length() > least) {
      gaps.push_back(each);
    } else {
      habit.longest = each.length();
      break;
    }
  }
  // Three of nearly one length are the rhythm of bursts.
  if (gaps.size() == kMostGaps && 2 * gaps.front().length() < 3 * gaps.back().length()) {
    habit.longest = gaps.front().length();
    habit.is_steady = false;
    return {};
  }
  std::ranges::sort(gaps, {}, &Stretch::from);
  return gaps;
}

// Windows that touch a gap say nothing of the pace.
bool is_in_gap(const Stretch& window, const std::vector<Stretch>& gaps) {
  return std::ranges::any_of(
      gaps, [&](const Stretch& gap) { return window.from <= gap.from && gap.to <= window.to; });
}

void find_pace(std::span<const std::int64_t> times, Habit& habit) {
  if (times.size() < 3 * kWindow) return;
  std::vector<Stretch> windows;
  std::vector<Duration> means;
  for (std::size_t i = kWindow; i < times.size(); ++i) {
    const Stretch window{times[i - kWindow], times[i]};
    if (is_in_gap(window, habit.gaps)) continue;
    windows.push_back(window);
    means.push_back(window.length() / kWindow);
  }
  if (means.size() < kWindow) return;
  std::vector<Duration> sorted = means;
  habit.fast = at_share(sorted, 0.2);
  const Duration slow(static_cast<std::int64_t>(static_cast<double>(habit.fast.count()) / kSlow));
  for (std::size_t i = 0; i < windows.size();) {
    if (means[i] <= slow) {
      ++i;
      continue;
    }
    Stretch stretch = windows[i];
    Duration sum{};
    std::size_t count = 0;
    for (; i < windows.size() && means[i] > slow; ++i, ++count) {
      stretch.to = windows[i].to;
      sum += means[i];
    }
    // At its edges a window is only partly slow.
    habit.slow.push_back({stretch, sum / static_cast<int>(count)});
  }
  const Duration shortest = std::max<Duration>(std::chrono::seconds(3), 40 * habit.fast);
  std::erase_if(habit.slow,
                [&](const Habit::Slow& each) { return each.stretch.length() < shortest; });
  if (habit.slow.size() > kMostGaps) habit.slow.clear();  // so it is by habit
  // Windows overlap, so that stretches may, too.
  for (std::size_t i = 1; i < habit.slow.size();) {
    Habit::Slow& before = habit.slow[i - 1];
    const Habit::Slow& each = habit.slow[i];
    if (each.stretch.from > before.stretch.to) {
      ++i;
      continue;
    }
    before = {{before.stretch.from, each.stretch.to}, std::max(before.pause, each.pause)};
    habit.slow.erase(habit.slow.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

}  // namespace

Duration Habit::patience() const {
  return std::max({kGap * usual, 2 * longest, Duration(std::chrono::seconds(1))});
}

Habit habit_of(std::span<const std::int64_t> times) {
  Habit habit;
  habit.messages = times.size();
  if (times.size() < kFewestMessages) return habit;
  std::vector<Duration> pauses;
  for (std::size_t i = 1; i < times.size(); ++i) pauses.emplace_back(times[i] - times[i - 1]);
  std::vector<Duration> sorted = pauses;
  habit.usual = std::max(at_share(sorted, 0.5), Duration(1));
  const auto fitting = std::ranges::count_if(
      pauses, [&](Duration p) { return 4 * p >= habit.usual && p <= 4 * habit.usual; });
  habit.is_steady = 10 * fitting >= 9 * std::ssize(pauses);
  habit.gaps = gaps_in(times, habit);
  if (habit.is_steady) find_pace(times, habit);
  return habit;
}

}  // namespace culprit::bag_doctor
