#include "base/goal_status.h"

#include <algorithm>
#include <array>

namespace culprit {
namespace {

constexpr std::array<std::string_view, 7> kStatuses = {
    "unknown", "accepted", "executing", "canceling", "succeeded", "canceled", "aborted"};
constexpr std::array kCounted = {GoalStatus::kAccepted, GoalStatus::kSucceeded,
                                 GoalStatus::kCanceled, GoalStatus::kAborted};

}  // namespace

std::string_view to_string(GoalStatus status) {
  return kStatuses[static_cast<std::size_t>(status)];
}

std::vector<std::string_view> counted_outcomes() {
  std::vector<std::string_view> words;
  for (const GoalStatus status : kCounted) words.push_back(to_string(status));
  return words;
}

std::optional<GoalStatus> counted_outcome(std::string_view word) {
  const auto found =
      std::ranges::find_if(kCounted, [&](GoalStatus status) { return to_string(status) == word; });
  return found == kCounted.end() ? std::nullopt : std::optional(*found);
}

}  // namespace culprit
