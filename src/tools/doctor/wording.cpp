#include "doctor/wording.h"

#include <array>
#include <cmath>

#include <fmt/core.h>

namespace culprit::doctor {

std::string count_of(std::size_t count, std::string_view what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

std::string listed(const std::vector<std::string>& names, std::size_t most) {
  std::string text;
  const std::size_t shown = names.size() <= most + 1 ? names.size() : most;
  for (std::size_t i = 0; i < shown; ++i) {
    const bool is_last = i + 1 == names.size();
    text += (i == 0 ? "" : is_last ? " and " : ", ") + names[i];
  }
  if (shown < names.size()) text += fmt::format(" and {} more", names.size() - shown);
  return text;
}

std::string duration(Duration time) {
  if (time == Duration::max()) return "none";
  const double s = seconds(time);
  constexpr double kYear = 365.25 * 86400;
  if (std::abs(s) >= 2 * kYear) return fmt::format("{:.3g} years", s / kYear);
  if (std::abs(s) >= 2 * 86400) return fmt::format("{:.3g} days", s / 86400);
  if (std::abs(s) >= 2 * 3600) return fmt::format("{:.3g} h", s / 3600);
  if (std::abs(s) >= 120) return fmt::format("{:.3g} min", s / 60);
  return fmt::format("{:.3g} s", s);
}

std::string bytes(std::int64_t count) {
  constexpr std::array kUnits = {"B", "kB", "MB", "GB", "TB"};
  auto amount = static_cast<double>(count);
  std::size_t unit = 0;
  for (; std::abs(amount) >= 1000 && unit + 1 < kUnits.size(); ++unit) amount /= 1000;
  return fmt::format("{:.3g} {}", amount, kUnits[unit]);
}

}  // namespace culprit::doctor
