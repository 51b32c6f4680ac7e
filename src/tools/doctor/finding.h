// A finding about a robot, in the form of `culprit check`'s diagnostics: the subject, the
// observation, its effect, and the remedy.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace culprit::doctor {

enum class Gravity : std::uint8_t {
  kWarning,  // works for now, or for some
  kError,    // something does not work
};

// "warning", "error".
std::string label(Gravity gravity);

struct Finding {
  std::string code;  // "D001": explanations.h has a page for each
  Gravity gravity = Gravity::kError;
  std::string who;                   // "/scan: /lidar_driver → /slam"
  std::string seen;                  // what was seen
  std::string matters;               // what follows from it
  std::string remedy;                // what to do
  std::vector<std::string> nodes{};  // concerned, by their full names
  std::string topic{};               // or service, concerned; empty: none
  bool operator==(const Finding&) const = default;
};

}  // namespace culprit::doctor
