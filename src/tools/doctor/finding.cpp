#include "doctor/finding.h"

#include <ctime>

#include <fmt/chrono.h>

#include "doctor/wording.h"

namespace culprit::doctor {

std::string label(Gravity gravity) { return gravity == Gravity::kError ? "error" : "warning"; }

std::string to_string(const When& when) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::time_t whole = when.clock / kSecond;
  const std::string clock = fmt::format("{:%Y-%m-%d %H:%M:%S}.{:03}", fmt::localtime(whole),
                                        when.clock % kSecond / 1'000'000);
  const std::string text = fmt::format("at {:.3f} s ({})", when.from, clock);
  if (when.until <= when.from) return text;
  return text + ", for " + duration(from_seconds(when.until - when.from));
}

}  // namespace culprit::doctor
