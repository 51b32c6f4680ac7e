// Reads what a submessage says (RTPS 2.3 §9.4.5), and believes none of its lengths.
//
//     SubmessageReader body(header, rest_of_it, source);
//     const SubmessageReader::Sample sample = body.read_sample();
//     if (!body.ok()) refuse();
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "rtps/cdr.h"
#include "rtps/guid.h"
#include "rtps/submessage.h"
#include "rtps/system_time.h"

namespace culprit::rtps {

// One submessage: a cursor over its body. A read beyond the end gives zero, and makes it not ok().
class SubmessageReader {
 public:
  SubmessageReader(ByteView header, ByteView body, const GuidPrefix& source)
      : kind(header[0]), flags(header[1]), body_(body), source_(source) {}

  const std::uint8_t kind;
  const std::uint8_t flags;

  bool ok() const { return is_ok_; }
  std::size_t left() const { return is_ok_ ? body_.size() - at_ : 0; }
  std::size_t size() const { return body_.size(); }
  std::size_t at() const { return at_; }
  void skip(std::size_t bytes) {
    is_ok_ = is_ok_ && bytes <= body_.size() - at_;
    if (is_ok_) at_ += bytes;
  }
  template <class T>
  T read() {
    if (left() < sizeof(T)) {
      is_ok_ = false;
      return {};
    }
    T value{};
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      const std::size_t place = (flags & 1) != 0 ? sizeof(T) - 1 - i : i;
      value = static_cast<T>((static_cast<std::uint64_t>(value) << 8) | body_[at_ + place]);
    }
    at_ += sizeof(T);
    return value;
  }
  std::int64_t read_sequence() {
    const auto high = read<std::uint32_t>();
    const auto low = read<std::uint32_t>();
    return static_cast<std::int64_t>((std::uint64_t{high} << 32) | low);
  }
  // Nothing: an earlier timestamp does not count, and there is no other.
  std::optional<SystemTime> read_time() {
    if ((flags & 2) != 0) return std::nullopt;
    const auto seconds = read<std::uint32_t>();
    const std::uint64_t fraction = read<std::uint32_t>();  // of 2^32 (RTPS 2.3 §9.3.2)
    const auto ns = (fraction * 1'000'000'000 + (std::uint64_t{1} << 31)) >> 32;
    return SystemTime(std::chrono::seconds(seconds) +
                      std::chrono::nanoseconds(static_cast<std::int64_t>(ns)));
  }
  // A writer of the participant that sent the datagram.
  Guid read_writer() {
    Guid guid;
    std::copy(source_.bytes.begin(), source_.bytes.end(), guid.bytes.begin());
    if (left() >= 4) std::copy_n(body_.data() + at_, 4, guid.bytes.data() + 12);
    skip(4);
    return guid;
  }
  // Whether a bitmap follows that its own length and the body hold.
  bool skip_bitmap() {
    const auto bits = read<std::uint32_t>();
    if (bits > 256) return false;
    skip((bits + 31) / 32 * 4);
    return ok();
  }
  // The head of a sample, or of fragments of one (RTPS 2.3 §9.4.5.3, §9.4.5.4), from the beginning of the body
  // on. The payload follows.
  struct Sample {
    Guid writer;
    std::int64_t sequence = 0;
    std::uint32_t first = 0;  // of the fragments, from 1 on
    std::uint32_t count = 0;
    std::uint16_t fragment_size = 0;  // bytes
    std::uint32_t size = 0;           // of all of them
    ByteView parameters{};            // inline
  };
  Sample read_sample() {
    Sample sample;
    skip(2);
    const auto to_parameters = read<std::uint16_t>();
    const std::size_t counted_from = at_;
    skip(4);
    sample.writer = read_writer();
    sample.sequence = read_sequence();
    if (kind == kDataFragment) {
      sample.first = read<std::uint32_t>();
      sample.count = read<std::uint16_t>();
      sample.fragment_size = read<std::uint16_t>();
      sample.size = read<std::uint32_t>();
    }
    // Fast DDS reads a signed number there: beyond this, it would find other parameters than we do.
    constexpr std::uint16_t kFarthest = 0x7fff;
    is_ok_ = is_ok_ && to_parameters >= at_ - counted_from && to_parameters <= kFarthest;
    if (is_ok_) skip(to_parameters - (at_ - counted_from));
    const std::size_t begin = at_;
    if ((flags & kHasParameters) != 0) skip_parameters();
    if (is_ok_) sample.parameters = body_.subspan(begin, at_ - begin);
    return sample;
  }
  ByteView rest() const { return is_ok_ ? body_.subspan(at_) : ByteView(); }
  Endianness order() const { return (flags & 1) != 0 ? Endianness::kLittle : Endianness::kBig; }

 private:
  static constexpr std::uint16_t kSentinel = 1;  // of a list of parameters

  // A list of parameters that has to end within the body.
  void skip_parameters() {
    while (is_ok_) {
      const auto id = read<std::uint16_t>();
      const auto length = read<std::uint16_t>();
      if (id == kSentinel) return;
      skip((length + 3u) & ~3u);
    }
  }

  const ByteView body_;
  const GuidPrefix& source_;
  std::size_t at_ = 0;
  bool is_ok_ = true;
};

}  // namespace culprit::rtps
