#include "rtps/claims.h"

#include <algorithm>
#include <array>
#include <optional>

#include "rtps/announcement.h"
#include "rtps/for_each_submessage.h"
#include "rtps/speakers.h"
#include "rtps/submessage.h"

namespace culprit::rtps {
namespace {

using Entity = std::array<std::uint8_t, 4>;

// Those that announce participants, writers and readers, in plain and secured (RTPS 2.3 §9.3.1.3; DDS Security 1.1
// §7.4.7.1).
constexpr std::array<Entity, 6> kAnnouncers = {
    Entity{0x00, 0x01, 0x00, 0xc2}, Entity{0x00, 0x00, 0x03, 0xc2}, Entity{0x00, 0x00, 0x04, 0xc2},
    Entity{0xff, 0x01, 0x01, 0xc2}, Entity{0xff, 0x00, 0x03, 0xc2}, Entity{0xff, 0x00, 0x04, 0xc2}};
constexpr std::size_t kToParameters = 6;  // the place of that offset
constexpr std::size_t kWriter = 12;
constexpr std::size_t kLeast = 24;  // bytes of a sample with its header

void add_keys(ByteView sample, const GuidPrefix& sender, std::vector<GuidPrefix>& others) {
  if (sample.size() < kLeast) return;
  const bool announces = std::ranges::any_of(kAnnouncers, [&](const Entity& each) {
    return std::equal(each.begin(), each.end(), sample.begin() + kWriter);
  });
  if (!announces) return;
  const bool is_little = (sample[1] & 1) != 0;
  const std::size_t begin = kToParameters + 2 + number_at(sample, kToParameters, is_little);
  if (begin > sample.size()) return;
  ByteView rest = sample.subspan(begin);
  ByteView parameters;
  if ((sample[1] & kHasParameters) != 0) {
    parameters = rest.first(size_of_parameters(rest, is_little));
    rest = rest.subspan(parameters.size());
  }
  const auto order = is_little ? Endianness::kLittle : Endianness::kBig;
  for (const Guid& key : announced_keys(parameters, order, rest)) {
    const GuidPrefix owner = key.prefix();
    if (others.size() > kMostOthers) return;  // thousands fit into a datagram
    if (owner != sender && std::ranges::find(others, owner) == others.end())
      others.push_back(owner);
  }
}

}  // namespace

std::vector<GuidPrefix> others_announced(std::span<const std::uint8_t> datagram) {
  constexpr std::size_t kPrefixInInfoSource = kSubmessageHeader + 8;
  std::vector<GuidPrefix> others;
  std::optional<GuidPrefix> sender;
  for_each_submessage(datagram, [&](ByteView each) {
    if (!sender) sender = prefix_at(datagram, kPrefixInHeader);
    if (each[0] == kInfoSource && each.size() >= kPrefixInInfoSource + sender->bytes.size())
      sender = prefix_at(each, kPrefixInInfoSource);
    if (each[0] == kData || each[0] == kDataFragment) add_keys(each, *sender, others);
  });
  return others;
}

bool has_too_many_submessages(std::span<const std::uint8_t> datagram) {
  int count = 0;
  for_each_submessage(datagram, [&](ByteView) { ++count; });
  return count > kMostSubmessages;
}

bool has_too_many_speakers(std::span<const std::uint8_t> datagram) {
  if (!is_rtps(datagram)) return false;
  int count = 0;
  for_each_speaker(datagram, [&](const GuidPrefix&) { ++count; });
  return count > kMostSpeakers;
}

bool introduces(std::span<const std::uint8_t> datagram) {
  bool does = false;
  for_each_submessage(datagram, [&](ByteView each) {
    if ((each[0] != kData && each[0] != kDataFragment) || each.size() < kLeast) return;
    const auto is_writer = [&](const Entity& entity) {
      return std::equal(entity.begin(), entity.end(), each.begin() + kWriter);
    };
    does = does || is_writer(kAnnouncers[0]) || is_writer(kAnnouncers[3]);
  });
  return does;
}

bool acknowledges(std::span<const std::uint8_t> datagram, const GuidPrefix& self) {
  bool is_for_self = false;
  bool does = false;
  for_each_submessage(datagram, [&](ByteView each) {
    if (each[0] == kInfoDestination)
      is_for_self = each.size() >= kSubmessageHeader + self.bytes.size() &&
                    prefix_at(each, kSubmessageHeader) == self;
    does = does || (is_for_self && each[0] == kAckNack);
  });
  return does;
}

}  // namespace culprit::rtps
