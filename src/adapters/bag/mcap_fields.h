// The fields of an MCAP record: numbers with their lowest byte first, texts and bytes after their
// size. After the first thing that does not fit, is_good() is false and all is 0 or empty.
#pragma once

#include <cstdint>
#include <string_view>

namespace culprit::bag {

class McapFields {
 public:
  explicit McapFields(std::string_view in) : in_(in) {}

  bool is_good() const { return is_good_; }
  std::string_view rest() const { return in_; }

  std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
  std::uint64_t u64() { return number(8); }
  std::string_view text() { return bytes(u32()); }

  std::string_view bytes(std::uint64_t size) {
    if (!is_good_ || size > in_.size()) {
      is_good_ = false;
      return {};
    }
    const std::string_view taken = in_.substr(0, size);
    in_.remove_prefix(size);
    return taken;
  }

 private:
  std::uint64_t number(std::size_t size) {
    std::uint64_t value = 0;
    int shift = 0;
    for (const char each : bytes(size)) {
      value |= std::uint64_t{static_cast<unsigned char>(each)} << shift;
      shift += 8;
    }
    return value;
  }

  std::string_view in_;
  bool is_good_ = true;
};

}  // namespace culprit::bag
