#include "rtps/announcement_fragments.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/invariant.h"
#include "rtps/for_each_submessage.h"
#include "rtps/submessage.h"

namespace culprit::rtps {
namespace {

// Where a fragment has its fields, with its header (RTPS 2.3 §9.4.5.4).
namespace field {
constexpr std::size_t kToParameters = 6;  // that offset, which counts from kReader on
constexpr std::size_t kReader = 8;
constexpr std::size_t kWriter = 12;
constexpr std::size_t kSequence = 16;
constexpr std::size_t kFirst = 24;
constexpr std::size_t kCount = 28;
constexpr std::size_t kFragmentSize = 30;
constexpr std::size_t kSize = 32;
constexpr std::size_t kEnd = 36;
}  // namespace field
constexpr std::uint8_t kKeyOnly = 0x04;  // of its flags

// In the header of a datagram, and in INFO_SRC: version, vendor and participant (§9.4.4, §9.4.5.9).
constexpr std::size_t kSourceInHeader = 4;
constexpr std::size_t kSourceInInfo = 8;
constexpr std::size_t kSourceSize = 16;
constexpr std::size_t kPrefixSize = 12;

// Before the content of a sample: the header, INFO_DST, and the head of a DATA.
constexpr std::size_t kInfoSize = kSubmessageHeader + kPrefixSize;
constexpr std::size_t kDataHead = 24;
constexpr std::size_t kPreamble = kHeader + kInfoSize + kDataHead;

std::uint32_t long_at(ByteView bytes, std::size_t at, bool is_little) {
  const std::uint32_t one = number_at(bytes, at, is_little);
  const std::uint32_t other = number_at(bytes, at + 2, is_little);
  return is_little ? other << 16 | one : one << 16 | other;
}

bool is_announcement(ByteView fragment) {
  using Entity = std::array<std::uint8_t, 4>;
  constexpr std::array<Entity, 3> kAnnouncers = {Entity{0, 1, 0, 0xc2}, Entity{0, 0, 3, 0xc2},
                                                 Entity{0, 0, 4, 0xc2}};  // §9.3.1.3
  return fragment.size() >= field::kEnd &&
         std::ranges::any_of(kAnnouncers, [&](const Entity& each) {
           return std::equal(each.begin(), each.end(), fragment.begin() + field::kWriter);
         });
}

void append(Bytes& bytes, ByteView more) { bytes.insert(bytes.end(), more.begin(), more.end()); }

// All that stands before the content of the sample, as one datagram, little endian.
Bytes preamble_of(ByteView fragment, ByteView source, ByteView destination, std::uint32_t size) {
  const bool is_little = (fragment[1] & 1) != 0;
  const std::size_t length = kDataHead - kSubmessageHeader + size;
  Bytes bytes{'R', 'T', 'P', 'S'};
  append(bytes, source);
  append(bytes, Bytes{kInfoDestination, 1, kPrefixSize, 0});
  append(bytes, destination);
  append(bytes, Bytes{kData, 1 | kHasPayload, static_cast<std::uint8_t>(length),
                      static_cast<std::uint8_t>(length >> 8), 0, 0, 16, 0});
  append(bytes, fragment.subspan(field::kReader, field::kSequence - field::kReader));
  for (const std::size_t half : {field::kSequence, field::kSequence + 4}) {
    const std::uint32_t word = long_at(fragment, half, is_little);
    for (const int shift : {0, 8, 16, 24})
      bytes.push_back(static_cast<std::uint8_t>(word >> shift));
  }
  CULPRIT_ASSERT(bytes.size() == kPreamble);
  return bytes;
}

}  // namespace

void AnnouncementFragments::begin() {
  const MutexLock lock(mutex_);
  has_begun_ = true;
}

std::vector<Bytes> AnnouncementFragments::take(std::span<std::uint8_t> datagram,
                                               const UdpAddress& from) {
  std::vector<Bytes> whole;
  const MutexLock lock(mutex_);
  if (!has_begun_ || !is_rtps(datagram)) return whole;
  constexpr std::array<std::uint8_t, kPrefixSize> kAll{};
  ByteView source = ByteView(datagram).subspan(kSourceInHeader, kSourceSize);
  ByteView destination = kAll;
  for_each_submessage(datagram, [&](ByteView each) CULPRIT_REQUIRES(mutex_) {
    if (each[0] == kInfoSource && each.size() >= kSourceInInfo + kSourceSize)
      source = each.subspan(kSourceInInfo, kSourceSize);
    if (each[0] == kInfoDestination && each.size() >= kInfoSize)
      destination = each.subspan(kSubmessageHeader, kPrefixSize);
    if (each[0] != kDataFragment || !is_announcement(each)) return;
    if (const auto head = read_head(each)) {
      auto sample = add(preamble_of(each, source, destination, head->size), *head, from);
      if (sample) whole.push_back(std::move(*sample));
    }
    pad(datagram.subspan(static_cast<std::size_t>(each.data() - datagram.data()), each.size()));
  });
  return whole;
}

// Nothing: it is damaged, larger than announcements are, or a key alone, which the middleware ignores.
std::optional<AnnouncementFragments::Head> AnnouncementFragments::read_head(ByteView fragment) {
  const bool is_little = (fragment[1] & 1) != 0;
  Head head{.first = long_at(fragment, field::kFirst, is_little),
            .count = number_at(fragment, field::kCount, is_little),
            .fragment_size = number_at(fragment, field::kFragmentSize, is_little),
            .size = long_at(fragment, field::kSize, is_little)};
  const std::size_t begin = field::kReader + number_at(fragment, field::kToParameters, is_little);
  if ((fragment[1] & kKeyOnly) != 0 || begin < field::kEnd || begin > fragment.size() ||
      head.first == 0 || head.count == 0 || head.fragment_size == 0 || head.size == 0 ||
      head.size > kLargest)
    return std::nullopt;
  ByteView rest = fragment.subspan(begin);
  if ((fragment[1] & kHasParameters) != 0) rest = rest.subspan(size_of_parameters(rest, is_little));
  const std::size_t end = std::min<std::size_t>(
      head.size, (std::size_t{head.first} - 1 + head.count) * head.fragment_size);
  const std::size_t all = (head.size + head.fragment_size - 1) / head.fragment_size;
  if (std::size_t{head.first} - 1 + head.count > all || rest.size() < end - head.begin())
    return std::nullopt;
  head.content = rest.first(end - head.begin());
  return head;
}

std::optional<Bytes> AnnouncementFragments::add(Bytes preamble, const Head& head,
                                                const UdpAddress& from) {
  Sample& sample = sample_of(std::move(preamble), head, from);
  std::ranges::copy(head.content, sample.datagram.begin() +
                                      static_cast<std::ptrdiff_t>(kPreamble + head.begin()));
  for (std::size_t i = head.first - 1; i < std::size_t{head.first} - 1 + head.count; ++i) {
    if (sample.seen[i]) continue;
    sample.seen[i] = true;
    --sample.missing;
  }
  if (sample.missing > 0) return std::nullopt;
  Bytes whole = std::move(sample.datagram);
  std::erase_if(samples_, [](const Sample& each) { return each.missing == 0; });
  return whole;
}

AnnouncementFragments::Sample& AnnouncementFragments::sample_of(Bytes preamble, const Head& head,
                                                                const UdpAddress& from) {
  const auto known = std::ranges::find_if(samples_, [&](const Sample& each) {
    return each.fragment_size == head.fragment_size &&
           std::equal(preamble.begin(), preamble.end(), each.datagram.begin());
  });
  if (known != samples_.end()) return *known;
  const auto is_of_socket = [&](const Sample& each) { return each.from == from; };
  if (std::ranges::count_if(samples_, is_of_socket) >= static_cast<std::ptrdiff_t>(kMostOfSocket)) {
    samples_.erase(std::ranges::find_if(samples_, is_of_socket));
  } else if (samples_.size() >= kMost) {
    samples_.pop_front();
  }
  const std::size_t all = (head.size + head.fragment_size - 1) / head.fragment_size;
  preamble.resize(kPreamble + head.size);
  return samples_.emplace_back(
      Sample{from, std::move(preamble), head.fragment_size, std::vector<bool>(all), all});
}

}  // namespace culprit::rtps
