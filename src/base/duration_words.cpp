#include "base/duration_words.h"

#include <array>
#include <cstdio>

namespace culprit {
namespace {

using namespace std::chrono_literals;

std::string two_units(std::int64_t large, const std::string& unit, std::int64_t small,
                      const std::string& rest) {
  const std::string first = std::to_string(large) + " " + unit;
  return small == 0 ? first : first + " " + std::to_string(small) + " " + rest;
}

}  // namespace

std::string in_words(Duration d) {
  if (d < Duration::zero()) return "-" + in_words(d == Duration::min() ? Duration::max() : -d);
  if (d == Duration::zero()) return "0 s";
  if (d < 1us) return std::to_string(d.count()) + " ns";
  if (d < 1ms) return std::to_string(d / 1us) + " us";
  if (d < 1s) return std::to_string(d / 1ms) + " ms";
  if (d < 1min) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.1f s", std::chrono::duration<double>(d).count());
    return text.data();
  }
  if (d < 1h) return two_units(d / 1min, "min", d % 1min / 1s, "s");
  if (d < 48h) return two_units(d / 1h, "h", d % 1h / 1min, "min");
  return two_units(d / 24h, "days", d % 24h / 1h, "h");
}

}  // namespace culprit
