#include "rtps/stuck_requests.h"

#include <algorithm>
#include <array>
#include <optional>

#include "base/invariant.h"
#include "rtps/for_each_submessage.h"

namespace culprit::rtps {
namespace {

// The parts of an acknowledgement (RTPS 2.3 §9.4.5.2), from its header on: the entities of its reader and its writer, the
// first number, the size of its bitmap, the bitmap, its count.
constexpr std::size_t kWriterAt = 8;
constexpr std::size_t kFirst = 12;
constexpr std::size_t kBits = 20;
constexpr std::size_t kBitmap = 24;
constexpr std::uint8_t kIsFinal = 0x02;

constexpr std::array<std::array<std::uint8_t, 4>, 2> kEndpointAnnouncers = {
    {{0x00, 0x00, 0x03, 0xc2}, {0x00, 0x00, 0x04, 0xc2}}};  // of writers and of readers (§9.3.1.3)

std::uint32_t word_at(ByteView bytes, std::size_t at, bool is_little) {
  const std::uint32_t first = number_at(bytes, at, is_little);
  const std::uint32_t second = number_at(bytes, at + 2, is_little);
  return is_little ? second << 16 | first : first << 16 | second;
}

struct Missing {
  Guid writer;
  std::uint64_t first = 0;
  std::size_t bitmap = 0;  // bytes
};

// Nothing: it asks for nothing, or not an announcer of Fast DDS.
std::optional<Missing> missing_in(ByteView request, const GuidPrefix& destination) {
  const bool is_fast_dds = destination.bytes[0] == 1 && destination.bytes[1] == 15;
  if (request[0] != kAckNack || !is_fast_dds || request.size() < kBitmap) return std::nullopt;
  const auto writer = request.subspan(kWriterAt, 4);
  const bool is_announcer = std::ranges::any_of(
      kEndpointAnnouncers, [&](const auto& each) { return std::ranges::equal(each, writer); });
  const bool is_little = (request[1] & 1) != 0;
  const std::size_t bits = word_at(request, kBits, is_little);
  Missing missing;
  missing.first = std::uint64_t{word_at(request, kFirst, is_little)} << 32 |
                  word_at(request, kFirst + 4, is_little);
  missing.bitmap = (bits + 31) / 32 * 4;
  if (!is_announcer || bits < 1 || bits > 256 || missing.first < 1 ||
      request.size() != kBitmap + missing.bitmap + 4)
    return std::nullopt;
  std::ranges::copy(destination.bytes, missing.writer.bytes.begin());
  std::ranges::copy(writer, missing.writer.bytes.begin() + 12);
  return missing;
}

// With the number 0 and without a bitmap; padding takes its place.
void ask_for_all(std::span<std::uint8_t> request, std::size_t bitmap) {
  CULPRIT_ASSERT(bitmap >= kSubmessageHeader && request.size() == kBitmap + bitmap + 4);
  const bool is_little = (request[1] & 1) != 0;
  const auto write_length = [&](std::size_t header, std::size_t length) {
    request[header + (is_little ? 2 : 3)] = static_cast<std::uint8_t>(length);
    request[header + (is_little ? 3 : 2)] = static_cast<std::uint8_t>(length >> 8);
  };
  request[1] &= static_cast<std::uint8_t>(~kIsFinal);
  write_length(0, kBitmap);
  std::ranges::fill(request.subspan(kFirst, kBitmap - kFirst), std::uint8_t{0});
  std::copy_n(request.begin() + static_cast<std::ptrdiff_t>(kBitmap + bitmap), 4,
              request.begin() + kBitmap);
  constexpr std::size_t kEnd = kBitmap + 4;
  request[kEnd] = kPad;
  request[kEnd + 1] = is_little ? 1 : 0;
  write_length(kEnd, bitmap - kSubmessageHeader);
}

}  // namespace

void StuckRequests::begin() {
  const MutexLock lock(mutex_);
  has_begun_ = true;
}

bool StuckRequests::is_stuck(const Guid& writer, std::uint64_t first) {
  if (requests_.size() >= kMostWriters && !requests_.contains(writer)) requests_.clear();
  Request& request = requests_[writer];
  if (request.first != first) request = {first, 0};
  return ++request.times % kTimes == 0;
}

Bytes StuckRequests::mended(ByteView datagram) {
  Bytes mended;
  GuidPrefix destination{};
  const MutexLock lock(mutex_);
  if (!has_begun_) return mended;
  for_each_submessage(datagram, [&](ByteView each) CULPRIT_REQUIRES(mutex_) {
    if (each[0] == kInfoDestination && each.size() >= kSubmessageHeader + destination.bytes.size())
      destination = prefix_at(each, kSubmessageHeader);
    const auto missing = missing_in(each, destination);
    if (!missing || !is_stuck(missing->writer, missing->first)) return;
    if (mended.empty()) mended.assign(datagram.begin(), datagram.end());
    const auto at = static_cast<std::size_t>(each.data() - datagram.data());
    ask_for_all(std::span(mended).subspan(at, each.size()), missing->bitmap);
  });
  return mended;
}

}  // namespace culprit::rtps
