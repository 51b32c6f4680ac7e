// A finding about a robot, in the form of `culprit check`'s diagnostics: the subject, the
// observation, its effect, and the remedy.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace culprit::doctor {

enum class Gravity : std::uint8_t {
  kWarning,  // works for now, or for some
  kError,    // something does not work
};

// "warning", "error".
std::string label(Gravity gravity);

// When it was there, in a recording.
struct When {
  double from = 0;         // seconds since the recording's beginning
  double until = 0;        // likewise
  std::int64_t clock = 0;  // of `from`, nanoseconds since 1970
  bool operator==(const When&) const = default;
};

struct Finding {
  std::string code;  // "D001": finding_explanations.h has a page for each
  Gravity gravity = Gravity::kError;
  std::string subject;               // "/scan: /lidar_driver → /slam"
  std::string seen;                  // what was seen
  std::string matters;               // what follows from it
  std::string remedy;                // what to do
  std::vector<std::string> nodes{};  // concerned, by their full names
  std::string topic{};               // or service, concerned; empty: none
  std::optional<When> when{};        // of recordings only
  bool operator==(const Finding&) const = default;
};

// "at 12.4 s (2026-11-28 16:50:22.400), for 3.2 s", in the time zone of this machine.
std::string to_string(const When& when);

}  // namespace culprit::doctor
