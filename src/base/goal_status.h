// How far a goal of an action is.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace culprit {

// As action_msgs/msg/GoalStatus numbers them.
enum class GoalStatus : std::uint8_t {
  kUnknown,
  kAccepted,
  kExecuting,
  kCanceling,
  kSucceeded,
  kCanceled,
  kAborted
};
inline bool is_over(GoalStatus status) { return status >= GoalStatus::kSucceeded; }

// "aborted"
std::string_view to_string(GoalStatus status);

// The words that rules count goals by: accepted, succeeded, canceled, aborted.
std::vector<std::string_view> counted_outcomes();
// Empty for any other word.
std::optional<GoalStatus> counted_outcome(std::string_view word);

// The topic on which the server of an action says how far its goals are, behind the action's name.
inline constexpr std::string_view kStatusOfAction = "/_action/status";

}  // namespace culprit
