// The fields of an MCAP record: numbers with their lowest byte first, texts and bytes after their
// size.
//
//     const auto channel = Fields(body).read<Channel>();     // from bytes
//     append_fields(body, Channel{1, 1, "/chatter", "cdr"});  // to bytes
#pragma once

#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>

namespace culprit::mcap {

// After the first thing that does not fit, is_good() is false and all is 0 or empty.
class Fields {
 public:
  explicit Fields(std::string_view in) : in_(in) {}

  bool is_good() const { return is_good_; }
  std::string_view rest() const { return in_; }

  std::uint16_t u16() { return number<std::uint16_t>(); }
  std::uint32_t u32() { return number<std::uint32_t>(); }
  std::uint64_t u64() { return number<std::uint64_t>(); }
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

  // A record of record.h, whose texts point into the bytes.
  template <class Record>
  Record read() {
    Record record;
    Record::visit(record, [this](auto&... fields) { (this->take(fields), ...); });
    return record;
  }

 private:
  template <std::unsigned_integral Number>
  Number number() {
    std::uint64_t value = 0;
    int shift = 0;
    for (const char each : bytes(sizeof(Number))) {
      value |= std::uint64_t{static_cast<unsigned char>(each)} << shift;
      shift += 8;
    }
    return static_cast<Number>(value);
  }
  template <std::unsigned_integral Number>
  void take(Number& field) {
    field = number<Number>();
  }
  void take(std::string_view& field) { field = text(); }

  std::string_view in_;
  bool is_good_ = true;
};

// With the width of its type.
template <std::unsigned_integral Number>
void append(std::string& out, Number number) {
  for (std::size_t i = 0; i < sizeof number; ++i)
    out += static_cast<char>((std::uint64_t{number} >> (8 * i)) & 0xff);
}
inline void append(std::string& out, std::string_view text) {
  append(out, static_cast<std::uint32_t>(text.size()));
  out += text;
}
template <class First, class Second, class... More>
void append(std::string& out, const First& first, const Second& second, const More&... more) {
  append(out, first);
  append(out, second);
  (append(out, more), ...);
}
template <class Record>
void append_fields(std::string& out, const Record& record) {
  Record::visit(record, [&out](const auto&... fields) { append(out, fields...); });
}

}  // namespace culprit::mcap
