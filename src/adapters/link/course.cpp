#include "link/course.h"

#include <algorithm>
#include <cmath>

namespace culprit::link {
namespace {

double number_in(const Value& value) {
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
  if (const auto* number = std::get_if<double>(&value)) return *number;
  return NAN;
}

}  // namespace

void ValueCourse::note(const Value& value) {
  const double number = number_in(value);
  if (!std::isfinite(number)) {
    ++others;
    note_text(value);
    return;
  }
  if (numbers++ == 0) least = most = last = number;
  if (number == last) {
    longest_row = std::max(longest_row, ++row);
  } else {
    const bool rises = number > last;
    if (changes++ > 0 && rises != is_rising) ++turns;
    is_rising = rises;
    row = 1;
  }
  rose |= number > last;
  fell |= number < last;
  least = std::min(least, number);
  most = std::max(most, number);
  last = number;
}

void ValueCourse::note_text(const Value& value) {
  const auto* now = std::get_if<std::string>(&value);
  if (now == nullptr) return;
  if (texts++ > 0 && *now != text) texts_differ = true;
  text = *now;
}

}  // namespace culprit::link
