#include "knowledge/blindness.h"

#include <array>

namespace culprit {
namespace {

constexpr std::array<std::string_view, kUnseens> kUnseenWords = {
    "never_seen", "stale", "unknown", "not_covered", "unreadable", "no_result"};

// The signal that brings values: "battery" of "mean(battery, 10s)". Other inputs bring their own.
std::string source_of(const std::string& input) {
  constexpr std::array<std::string_view, 7> kOfSignals = {"changed", "frozen", "isnan", "max",
                                                          "mean",    "min",    "stddev"};
  const auto open = input.find('(');
  const auto function = std::string_view(input).substr(0, open);
  if (open == std::string::npos || std::ranges::find(kOfSignals, function) == kOfSignals.end())
    return input;
  return input.substr(open + 1, input.find_first_of(",)", open) - open - 1);
}

std::string reason(const Blind& blind) {
  switch (blind.why) {
    case Unseen::kNeverSeen:
      return blind.input + " was never seen";
    case Unseen::kStale:
      return "no new value of " + source_of(blind.input) + " comes";
    case Unseen::kUnknown:
      return blind.input + " is unknown";
    case Unseen::kNotCovered:
      return "too few samples come to cover the window of " + blind.input;
    case Unseen::kUnreadable:
      return "the values of " + blind.input + " cannot be compared (NaN, or another type)";
    case Unseen::kNoResult:
      break;
  }
  return "its trigger has no result (a division by zero, or an overflow)";
}

}  // namespace

std::string_view to_string(Unseen why) { return kUnseenWords[static_cast<std::size_t>(why)]; }

std::optional<Unseen> unseen_named(std::string_view word) {
  const auto* found = std::find(kUnseenWords.begin(), kUnseenWords.end(), word);
  if (found == kUnseenWords.end()) return std::nullopt;
  return static_cast<Unseen>(found - kUnseenWords.begin());
}

std::string describe(const Blind& blind) {
  return reason(blind) + (blind.near.empty() ? "" : "; did you mean '" + blind.near + "'?");
}

}  // namespace culprit
