// Numbers and texts as few bytes, for what is written a thousand times a second.
//
// Whole numbers are in groups of seven bits, lowest first, the high bit set on all but the last;
// signed ones in zigzag order. Reading never trusts a length: after the first thing that does not
// fit, is_good() is false and every read gives zero or nothing.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace culprit::journal {

class ByteWriter {
 public:
  explicit ByteWriter(std::string& out) : out_(out) {}

  void byte(std::uint8_t value) { out_ += static_cast<char>(value); }
  void natural(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) byte(static_cast<std::uint8_t>(value | 0x80));
    byte(static_cast<std::uint8_t>(value));
  }
  void integer(std::int64_t value) {
    const auto bits = static_cast<std::uint64_t>(value);
    natural(bits << 1 ^ (value < 0 ? ~std::uint64_t{0} : 0));
  }
  void real(double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    for (int shift = 0; shift < 64; shift += 8) byte(static_cast<std::uint8_t>(bits >> shift));
  }
  void text(std::string_view value) {
    natural(value.size());
    out_ += value;
  }

 private:
  std::string& out_;
};

class ByteReader {
 public:
  explicit ByteReader(std::string_view in) : in_(in) {}

  bool is_good() const { return is_good_; }
  bool is_at_end() const { return in_.empty(); }
  void fail() { is_good_ = false; }

  std::uint8_t byte() {
    if (!is_good_ || in_.empty()) {
      is_good_ = false;
      return 0;
    }
    const auto value = static_cast<std::uint8_t>(in_.front());
    in_.remove_prefix(1);
    return value;
  }
  std::uint64_t natural() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      const std::uint8_t part = byte();
      value |= std::uint64_t{part & 0x7fu} << shift;
      if ((part & 0x80) == 0) return is_good_ ? value : 0;
    }
    is_good_ = false;
    return 0;
  }
  std::int64_t integer() {
    const std::uint64_t bits = natural();
    return static_cast<std::int64_t>(bits >> 1 ^ ((bits & 1) != 0 ? ~std::uint64_t{0} : 0));
  }
  double real() {
    std::uint64_t bits = 0;
    for (int shift = 0; shift < 64; shift += 8) bits |= std::uint64_t{byte()} << shift;
    double value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return is_good_ ? value : 0;
  }
  std::string text() {
    const std::uint64_t size = natural();
    if (!is_good_ || size > in_.size()) {
      is_good_ = false;
      return {};
    }
    std::string value(in_.substr(0, size));
    in_.remove_prefix(size);
    return value;
  }

 private:
  std::string_view in_;
  bool is_good_ = true;
};

}  // namespace culprit::journal
