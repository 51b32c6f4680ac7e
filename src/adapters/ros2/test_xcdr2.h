// Messages in XCDR2, which culprit only reads.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "rtps/cdr.h"

namespace culprit::ros2 {

enum class Xcdr2 : std::uint8_t { kPlain = 0x06, kDelimited = 0x08, kMembers = 0x0a };

class Xcdr2Writer {
 public:
  Xcdr2Writer(Xcdr2 form, rtps::Endianness endianness)
      : form_(form),
        endianness_(endianness),
        bytes_{0,
               static_cast<std::uint8_t>(static_cast<unsigned>(form) |
                                         static_cast<unsigned>(endianness)),
               0, 0} {}

  template <class... T>
  void operator()(const T&... fields) {
    std::uint32_t number = 0;
    (write_field(number++, fields), ...);
  }
  template <class T>
  void write(const T& value) {
    if constexpr (std::is_arithmetic_v<T>) {
      const std::size_t alignment = sizeof(T) < 4 ? sizeof(T) : 4;
      while (bytes_.size() % alignment != 0) bytes_.push_back(0);
      auto bytes = std::bit_cast<std::array<std::uint8_t, sizeof(T)>>(value);
      if (endianness_ == rtps::Endianness::kBig) bytes = rtps::detail::swapped<T>(bytes);
      bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    } else if constexpr (std::same_as<T, std::string>) {
      write(static_cast<std::uint32_t>(value.size() + 1));
      bytes_.insert(bytes_.end(), value.begin(), value.end());
      bytes_.push_back(0);
    } else {
      const std::size_t header = form_ == Xcdr2::kPlain ? 0 : begin();
      T::visit(value, *this);
      if (header > 0) end(header);
    }
  }
  template <class T>
  void write(const std::vector<T>& elements) {
    const std::size_t header = std::is_arithmetic_v<T> ? 0 : begin();
    write(static_cast<std::uint32_t>(elements.size()));
    for (const T& element : elements) write(element);
    if (header > 0) end(header);
  }
  rtps::Bytes take() { return std::move(bytes_); }

 private:
  template <class T>
  void write_field(std::uint32_t number, const T& value) {
    if (form_ != Xcdr2::kMembers) return write(value);
    constexpr std::uint32_t kFour = 4, kShared = 5;
    // The field begins with its own length: that stands for the one of the header.
    const bool is_shared = std::same_as<T, std::string>;
    write(number | (is_shared ? kShared : kFour) << 28);
    const std::size_t header = is_shared ? 0 : begin();
    write(value);
    if (header > 0) end(header);
  }
  std::size_t begin() {
    write(std::uint32_t{0});
    return bytes_.size();
  }
  void end(std::size_t header) {
    auto length = std::bit_cast<std::array<std::uint8_t, 4>>(
        static_cast<std::uint32_t>(bytes_.size() - header));
    if (endianness_ == rtps::Endianness::kBig)
      length = rtps::detail::swapped<std::uint32_t>(length);
    std::ranges::copy(length, bytes_.begin() + static_cast<std::ptrdiff_t>(header) - 4);
  }

  Xcdr2 form_;
  rtps::Endianness endianness_;
  rtps::Bytes bytes_;
};

template <class Message>
rtps::Bytes encode_xcdr2(const Message& message, Xcdr2 form, rtps::Endianness endianness) {
  Xcdr2Writer writer(form, endianness);
  writer.write(message);
  return writer.take();
}

}  // namespace culprit::ros2
