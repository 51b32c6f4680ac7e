#include "rtps/announcement.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <string>

#include "rtps/for_each_submessage.h"
#include "rtps/submessage.h"

namespace culprit::rtps {
namespace {

enum ParameterId : std::uint16_t {
  kPidSentinel = 0x0001,
  kPidTopicName = 0x0005,
  kPidTypeName = 0x0007,
  kPidReliability = 0x001a,
  kPidLiveliness = 0x001b,
  kPidDurability = 0x001d,
  kPidOwnership = 0x001f,
  kPidDeadline = 0x0023,
  kPidPartition = 0x0029,
  kPidLifespan = 0x002b,
  kPidUserData = 0x002c,
  kPidParticipantGuid = 0x0050,
  kPidEndpointGuid = 0x005a,
  kPidKeyHash = 0x0070,
  kPidStatusInfo = 0x0071
};

// As the middleware has it, whose strings have 255 bytes.
constexpr std::size_t kLongestName = 255;

// A value: a read beyond its end gives zero, and makes it not ok().
class Announced {
 public:
  Announced(ByteView bytes, Endianness order) : bytes_(bytes), order_(order) {}

  bool ok() const { return is_ok_; }
  std::uint32_t u32() {
    const ByteView four = take(4);
    if (four.empty()) return 0;
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i)
      value = value << 8 | four[order_ == Endianness::kBig ? i : 3 - i];
    return value;
  }
  ByteView take(std::size_t count) {
    if (!is_ok_ || bytes_.size() < count) {
      is_ok_ = false;
      return {};
    }
    const ByteView taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }
  // As many bytes as the length gives, and the padding behind them.
  std::string_view counted() {
    const std::size_t size = u32();
    const ByteView bytes = take(size);
    (void)take(std::min(bytes_.size(), (4 - size % 4) % 4));
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  // With a NUL behind it, and none in it.
  std::string_view string() {
    const std::string_view text = counted();
    is_ok_ = is_ok_ && !text.empty() && text.find('\0') == text.size() - 1;
    return is_ok_ ? text.substr(0, text.size() - 1) : std::string_view();
  }
  Duration duration() {
    const std::uint32_t seconds = u32();
    const std::uint64_t fraction = u32();  // of 2^32 (§9.3.2)
    if (seconds == 0x7fff'ffff && fraction == 0xffff'ffff) return kInfinite;
    return std::chrono::seconds(static_cast<std::int32_t>(seconds)) +
           std::chrono::nanoseconds(fraction * 1'000'000'000 >> 32);
  }
  Guid guid() {
    Guid guid;
    const ByteView bytes = take(guid.bytes.size());
    if (!bytes.empty()) std::ranges::copy(bytes, guid.bytes.begin());
    return guid;
  }

 private:
  ByteView bytes_;
  const Endianness order_;
  bool is_ok_ = true;
};

struct AnnouncedList {
  ByteView bytes;
  Endianness order;

  bool is_little() const { return order == Endianness::kLittle; }
};

// Calls `each` with the number and value of every parameter until it gives false. Gives whether the list
// ended as it should, or `each` had enough.
template <class Each>
bool for_each_parameter(AnnouncedList list, Each each) {
  while (true) {
    if (list.bytes.size() < 4) return false;
    const std::uint16_t id = number_at(list.bytes, 0, list.is_little());
    const std::size_t length = number_at(list.bytes, 2, list.is_little());
    if (id == kPidSentinel) return true;
    list.bytes = list.bytes.subspan(4);
    if (list.bytes.size() < length) return false;
    if (!each(id, Announced(list.bytes.first(length), list.order))) return true;
    list.bytes = list.bytes.subspan(std::min(list.bytes.size(), (length + 3) & ~std::size_t{3}));
  }
}

// The middleware ignores the first byte (Fast DDS, ParameterList::readParameterListfromCDRMsg), and so must we.
std::optional<AnnouncedList> announced_list(ByteView payload) {
  constexpr std::uint8_t kBigEndianList = 2;
  constexpr std::uint8_t kLittleEndianList = 3;
  if (payload.size() < kEncapsulationSize) return std::nullopt;
  if (payload[1] != kBigEndianList && payload[1] != kLittleEndianList) return std::nullopt;
  return AnnouncedList{payload.subspan(kEncapsulationSize),
                       payload[1] == kBigEndianList ? Endianness::kBig : Endianness::kLittle};
}

std::string kept(std::string_view text) { return std::string(text.substr(0, kLongestSaid)); }

bool is_dds_name(std::string_view text) { return !text.empty() && text.size() <= kLongestName; }

// Gives whether the value is whole.
bool read_parameter(EndpointInfo& info, std::uint16_t id, Announced value) {
  switch (id) {
    case kPidTopicName:
      info.topic = value.string();
      return value.ok() && is_dds_name(info.topic);
    case kPidTypeName:
      info.type = value.string();
      return value.ok() && is_dds_name(info.type);
    case kPidEndpointGuid:
    case kPidKeyHash:
      info.guid = value.guid();
      return value.ok();
    case kPidUserData:
      info.user_data = kept(value.counted());
      return value.ok();
    case kPidReliability:
      info.qos.reliability = value.u32() == 2 ? Reliability::kReliable : Reliability::kBestEffort;
      return value.ok();
    case kPidDurability:
      info.qos.durability = value.u32() >= 1 ? Durability::kTransientLocal : Durability::kVolatile;
      return value.ok();
    case kPidOwnership:
      info.qos.ownership = value.u32() == 1 ? Ownership::kExclusive : Ownership::kShared;
      return value.ok();
    case kPidLiveliness:  // ROS 2 knows two kinds; by participant is manual, too
      info.qos.liveliness = value.u32() == 0 ? Liveliness::kAutomatic : Liveliness::kManualByTopic;
      info.qos.liveliness_lease = value.duration();
      return value.ok();
    case kPidDeadline:
      info.qos.deadline = value.duration();
      return value.ok();
    case kPidLifespan:
      info.qos.lifespan = value.duration();
      return value.ok();
    case kPidPartition:
      info.partitions.clear();
      for (std::uint32_t left = value.u32(); left > 0 && value.ok(); --left) {
        const std::string_view name = value.string();
        if (info.partitions.size() < kMostPartitions) info.partitions.push_back(kept(name));
      }
      return value.ok();
    default:
      return true;
  }
}

// The middleware takes the 16 bytes that follow, whatever the length says, before it finds out that a list is damaged
// (Fast DDS, ParameterList::readInstanceHandleFromCDRMsg).
void add_keys(AnnouncedList list, std::vector<Guid>& keys) {
  while (list.bytes.size() >= 4) {
    const std::uint16_t id = number_at(list.bytes, 0, list.is_little());
    const std::size_t length = number_at(list.bytes, 2, list.is_little());
    if (id == kPidSentinel) return;
    list.bytes = list.bytes.subspan(4);
    if (id == kPidParticipantGuid || id == kPidEndpointGuid || id == kPidKeyHash) {
      Announced value(list.bytes, list.order);
      const Guid said = value.guid();
      if (value.ok()) keys.push_back(said);
    }
    list.bytes = list.bytes.subspan(std::min(list.bytes.size(), (length + 3) & ~std::size_t{3}));
  }
}

}  // namespace

std::optional<std::string_view> announced_topic(ByteView payload) {
  const auto list = announced_list(payload);
  if (!list) return std::nullopt;
  std::string_view topic;
  const bool is_whole = for_each_parameter(*list, [&](std::uint16_t id, Announced value) {
    if (id == kPidTopicName) topic = value.string();
    return id != kPidTopicName;
  });
  if (!is_whole || !is_dds_name(topic)) return std::nullopt;
  return topic;
}

std::optional<EndpointInfo> read_announcement(ByteView payload, EndpointRole role) {
  const auto list = announced_list(payload);
  if (!list) return std::nullopt;
  EndpointInfo info;
  // The default where none is announced (DDS 1.4 §2.2.3): writers are reliable, readers are not.
  if (role == EndpointRole::kReader) info.qos.reliability = Reliability::kBestEffort;
  bool is_good = true;
  const bool is_whole = for_each_parameter(*list, [&](std::uint16_t id, Announced value) {
    return is_good = read_parameter(info, id, value);
  });
  const std::uint8_t kind = info.guid.bytes[15];
  const bool is_of_role =
      (kind & 0xc0) == 0 && info.guid.is_reader() == (role == EndpointRole::kReader);
  if (!is_whole || !is_good || info.topic.empty() || info.type.empty() || !is_of_role)
    return std::nullopt;
  info.qos.keys = info.guid.has_keys() ? Keys::kSome : Keys::kNone;
  return info;
}

std::optional<Guid> read_end(ByteView parameters, Endianness order, ByteView payload) {
  constexpr std::uint8_t kDisposedOrUnregistered = 0x03;  // §9.6.3.4; always in this order of bytes
  bool ends = false;
  std::optional<Guid> guid;
  const auto read_key = [&](std::uint16_t id, Announced value) {
    if (id != kPidKeyHash && id != kPidEndpointGuid) return;
    const Guid said = value.guid();
    if (value.ok()) guid = said;
  };
  if (const auto key = announced_list(payload)) {
    for_each_parameter(*key, [&](std::uint16_t id, Announced value) {
      read_key(id, value);
      return true;
    });
  }
  for_each_parameter({parameters, order}, [&](std::uint16_t id, Announced value) {
    read_key(id, value);
    if (id == kPidStatusInfo) {
      const ByteView status = value.take(4);
      ends = !status.empty() && (status[3] & kDisposedOrUnregistered) != 0;
    }
    return true;
  });
  return ends ? guid : std::nullopt;
}

std::vector<Guid> announced_keys(ByteView parameters, Endianness order, ByteView payload) {
  std::vector<Guid> keys;
  add_keys({parameters, order}, keys);
  if (const auto list = announced_list(payload)) add_keys(*list, keys);
  return keys;
}

Bytes farewell_of(const GuidPrefix& participant, std::int64_t sequence) {
  constexpr std::array<std::uint8_t, 4> kParticipant = {0, 0, 1, 0xc1};
  Bytes bytes = {'R', 'T', 'P', 'S', 2, 3, 1, 15};
  const auto append = [&](const auto& more) {
    bytes.insert(bytes.end(), more.begin(), more.end());
  };
  append(participant.bytes);
  // A sample with inline parameters, little endian, to all readers, of the writer that announces participants.
  append(Bytes{kData, 1 | kHasParameters, 0, 0, 0, 0, 16, 0, 0, 0, 0, 0, 0, 1, 0, 0xc2});
  for (const int half : {32, 0}) {
    for (const int byte : {0, 8, 16, 24})
      bytes.push_back(static_cast<std::uint8_t>(sequence >> (half + byte)));
  }
  append(Bytes{kPidKeyHash, 0, 16, 0});
  append(participant.bytes);
  append(kParticipant);
  append(Bytes{kPidStatusInfo, 0, 4, 0, 0, 0, 0, 3, kPidSentinel, 0, 0, 0});
  bytes[22] = static_cast<std::uint8_t>(bytes.size() - kHeader - kSubmessageHeader);
  return bytes;
}

}  // namespace culprit::rtps
