#include "language/reserved_words.h"

#include <algorithm>
#include <array>

namespace culprit {
namespace {

constexpr std::array<std::string_view, 51> kReservedWords = {
    "ROBOT",     "CYCLE",      "CONST",    "COMPONENT", "DEPENDENCY", "IGNORE",  "SIGNAL",
    "RULE",      "POLICIES",   "TRIGGER",  "STRATEGY",  "NODE",       "LAUNCH",  "ON",
    "TOPIC",     "FIELD",      "STALE",    "RANGE",     "KEY",        "FOR",     "DIAGNOSTIC",
    "PARAMETER", "HOLD",       "COOLDOWN", "ATTEMPTS",  "ON_CHANGE",  "WHEN",    "ADAPTATION",
    "INTERLOCK", "LASTRESORT", "REQUIRED", "LIFECYCLE", "RESPAWNED",  "UNIT",    "USER",
    "ENV",       "SETUP",      "CWD",      "IN",        "PLUGIN",     "PACKAGE", "PARAMETERS",
    "REMAP",     "CONTAINER",  "HOST",     "WITHIN",    "READY",      "GROUP",   "MANAGER",
    "ABORT",     "DRILL"};

}  // namespace

std::span<const std::string_view> reserved_words() { return kReservedWords; }

bool is_word_of_reuse(std::string_view word) {
  return word == "THEN" || word == "INCLUDE" || word == "TEMPLATE" || word == "USE" ||
         word == "END";
}

bool is_reserved(std::string_view word) {
  // Most names have something else in them.
  if (word.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ_") != std::string_view::npos) return false;
  return std::find(kReservedWords.begin(), kReservedWords.end(), word) != kReservedWords.end();
}

bool is_word_of_language(std::string_view word) {
  return is_reserved(word) || word == "true" || word == "false";
}

}  // namespace culprit
