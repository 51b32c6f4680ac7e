#include "json/json_writer.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "json/json.h"

namespace culprit {
namespace {

bool is_plain(char c) { return c >= ' ' && c <= '~' && c != '"' && c != '\\'; }

}  // namespace

void JsonWriter::separate() {
  if (!is_first_) out_ += ',';
  is_first_ = false;
}

void JsonWriter::begin(char bracket) {
  separate();
  out_ += bracket;
  is_first_ = true;
}

void JsonWriter::end(char bracket) {
  out_ += bracket;
  is_first_ = false;
}

void JsonWriter::key(std::string_view name) {
  value(name);
  out_ += ':';
  is_first_ = true;
}

void JsonWriter::null() {
  separate();
  out_ += "null";
}

void JsonWriter::write(bool value) {
  separate();
  out_ += value ? "true" : "false";
}

void JsonWriter::write(std::uint64_t value) {
  separate();
  const fmt::format_int digits(value);
  out_.append(digits.data(), digits.size());
}

void JsonWriter::write(std::int64_t value) {
  separate();
  const fmt::format_int digits(value);
  out_.append(digits.data(), digits.size());
}

// The library formats other numbers, for rows of journals are compared by their bytes. The format
// of whole numbers is known, and many costs and probabilities are whole.
void JsonWriter::write(double value) {
  separate();
  constexpr double kMost = 1e9;
  if (value >= 0 && value < kMost && !std::signbit(value) && value == std::floor(value)) {
    const fmt::format_int digits(static_cast<std::uint64_t>(value));
    out_.append(digits.data(), digits.size());
    out_ += ".0";
    return;
  }
  out_ += to_line(Json(value));
}

void JsonWriter::write(std::string_view text) {
  separate();
  if (!std::all_of(text.begin(), text.end(), is_plain)) {
    out_ += to_line(Json(text));
    return;
  }
  out_ += '"';
  out_ += text;
  out_ += '"';
}

}  // namespace culprit
