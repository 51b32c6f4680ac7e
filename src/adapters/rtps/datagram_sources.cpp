#include "rtps/datagram_sources.h"

#include <algorithm>
#include <optional>

#include "rtps/speakers.h"
#include "rtps/submessage.h"

namespace culprit::rtps {
namespace {

// Where a sample has its writer (RTPS 2.3 §9.4.5.3), and which announces a participant (§9.3.1.3).
constexpr std::size_t kWriterInData = kSubmessageHeader + 8;
constexpr std::array<std::uint8_t, 4> kAnnouncesParticipant = {0x00, 0x01, 0x00, 0xc2};
constexpr std::uint8_t kOfVendor = 0x80;  // these and higher kinds are a vendor's own (§8.3.3.2)

bool announces_participant(std::span<const std::uint8_t> data) {
  return (data[1] & (kHasPayload | kHasKey)) == kHasPayload &&
         data.size() >= kWriterInData + kAnnouncesParticipant.size() &&
         std::equal(kAnnouncesParticipant.begin(), kAnnouncesParticipant.end(),
                    data.begin() + kWriterInData);
}

// The size of the submessage that `bytes` begin with, with its header; nothing: it is not whole.
std::optional<std::size_t> size_of_submessage(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kSubmessageHeader) return std::nullopt;
  const bool is_little = (bytes[1] & 1) != 0;
  const std::size_t length = std::size_t{bytes[is_little ? 3 : 2]} << 8 | bytes[is_little ? 2 : 3];
  const bool reaches_the_end = length == 0 && bytes[0] != kPad && bytes[0] != kInfoTime;
  const std::size_t size = reaches_the_end ? bytes.size() : kSubmessageHeader + length;
  return size > bytes.size() ? std::nullopt : std::optional(size);
}

}  // namespace

std::string to_text(const UdpAddress& address) {
  std::string text;
  for (const std::uint8_t part : address.ip)
    text += (text.empty() ? "" : ".") + std::to_string(part);
  return text + ":" + std::to_string(address.port);
}

void DatagramSources::heard(std::span<const std::uint8_t> datagram, const UdpAddress& from,
                            Time now) {
  if (!is_rtps(datagram)) return;
  const MutexLock lock(mutex_);
  for_each_speaker(datagram, [&](const GuidPrefix& participant)
                                 CULPRIT_REQUIRES(mutex_) { note(participant, from, now); });
}

bool DatagramSources::is_still_there(std::span<const std::uint8_t> datagram) const {
  if (!is_rtps(datagram)) return false;
  std::size_t announced = 0;
  for (auto rest = datagram.subspan(kHeader); !rest.empty();) {
    const auto size = size_of_submessage(rest);
    if (!size) return false;
    const std::uint8_t kind = rest[0];
    if (kind == kData && announces_participant(rest.first(*size))) {
      ++announced;
    } else if (kind != kPad && kind != kInfoTime && kind != kInfoDestination && kind < kOfVendor) {
      return false;
    }
    rest = rest.subspan(*size);
  }
  const GuidPrefix participant = prefix_at(datagram, kPrefixInHeader);
  const MutexLock lock(mutex_);
  const auto found = entries_.find(participant);
  const bool is_known = found != entries_.end() && found->second.is_kept;
  return announced > 0 && (is_known || self_ == participant);
}

void DatagramSources::note(const GuidPrefix& participant, const UdpAddress& from, Time now) {
  const auto [found, is_new] = entries_.try_emplace(participant);
  Entry& entry = found->second;
  entry.last = now;
  if (is_new) entry.place = others_.insert(others_.end(), participant);
  const auto& known = entry.addresses;
  if (std::find(known.begin(), known.end(), from) == known.end()) {
    if (known.size() < kMostAddresses) {
      entry.addresses.push_back(from);
    } else {
      entry.has_more = true;
    }
  }
  if (others_.size() > kMostOthers) {
    entries_.erase(others_.front());
    others_.pop_front();
  }
}

void DatagramSources::keep(const GuidPrefix& participant) {
  const MutexLock lock(mutex_);
  if (entries_.size() - others_.size() >= kMostParticipants) return;
  const auto [found, is_new] = entries_.try_emplace(participant);
  Entry& entry = found->second;
  if (entry.is_kept) return;
  entry.is_kept = true;
  if (is_new) {
    entry.has_more = true;  // what was known of it had to make room meanwhile
  } else {
    others_.erase(entry.place);
  }
}

void DatagramSources::forget(const GuidPrefix& participant) {
  const MutexLock lock(mutex_);
  const auto found = entries_.find(participant);
  if (found == entries_.end()) return;
  if (!found->second.is_kept) others_.erase(found->second.place);
  entries_.erase(found);
}

void DatagramSources::begin(const GuidPrefix& self) {
  const MutexLock lock(mutex_);
  self_ = self;
}

void DatagramSources::came_through(std::span<const std::uint8_t> datagram, std::uint16_t port,
                                   Time now) {
  if (datagram.size() < kHeader) return;
  const MutexLock lock(mutex_);
  if (self_ != prefix_at(datagram, kPrefixInHeader)) return;
  const auto found = std::find_if(ports_.begin(), ports_.end(),
                                  [&](const auto& each) { return each.first == port; });
  if (found != ports_.end()) {
    found->second = now;
  } else if (ports_.size() < kMostPorts) {
    ports_.emplace_back(port, now);
  }
}

Time DatagramSources::own_came_through() const {
  const MutexLock lock(mutex_);
  Time oldest = kNever;
  for (const auto& [port, at] : ports_) oldest = std::min(oldest, at);
  return oldest;
}

Time DatagramSources::last_of(const GuidPrefix& participant) const {
  const MutexLock lock(mutex_);
  const auto found = entries_.find(participant);
  return found == entries_.end() ? kLongAgo : found->second.last;
}

bool DatagramSources::may_speak_from(const GuidPrefix& participant, const UdpAddress& from) const {
  const MutexLock lock(mutex_);
  const auto found = entries_.find(participant);
  if (found == entries_.end() || !found->second.is_kept || found->second.has_more) return true;
  return std::ranges::find(found->second.addresses, from) != found->second.addresses.end();
}

DatagramSources::Origin DatagramSources::of(const GuidPrefix& participant) const {
  const MutexLock lock(mutex_);
  const auto found = entries_.find(participant);
  if (found == entries_.end()) return {};
  return {found->second.addresses, !found->second.has_more};
}

}  // namespace culprit::rtps
