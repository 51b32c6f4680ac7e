#include "rtps/datagram_filter.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>

#include "base/invariant.h"
#include "rtps/announcement.h"
#include "rtps/for_each_submessage.h"
#include "rtps/submessage.h"
#include "rtps/submessage_reader.h"

namespace culprit::rtps {
namespace {

constexpr std::size_t kMostFragments = 1 << 16;
constexpr std::size_t kKey = 16;  // bytes

// The size of a gap without a bitmap, with its header.
constexpr std::size_t kGapSize = 32;

bool is_header(ByteView datagram) {
  return datagram.size() >= kHeader && std::memcmp(datagram.data(), "RTPS", 4) == 0 &&
         datagram[4] == 2;
}

bool is_builtin(const Guid& writer) { return (writer.bytes[15] & 0xc0) == 0xc0; }
// Whether Fast DDS has a reader for it (EntityId_t.hpp). The filter keeps no state of the others: anybody can make up millions.
bool is_read_builtin(const Guid& writer) {
  constexpr std::array<std::uint32_t, 13> kAll = {
      0x000100c2, 0x000002c2, 0x000003c2, 0x000004c2,
      0x000200c2,  // participants, topics, endpoints, liveliness
      0xff0101c2, 0xff0003c2, 0xff0004c2, 0xff0200c2,  // the same, secured
      0x000201c3, 0xff0202c3,                          // handshakes, keys
      0x000300c3, 0x000301c3};                         // types
  std::uint32_t entity = 0;
  for (std::size_t i = 12; i < writer.bytes.size(); ++i) entity = entity << 8 | writer.bytes[i];
  return std::ranges::find(kAll, entity) != kAll.end();
}
// True for a writer of a program, false for one of the middleware's own (RTPS 2.3 §9.3.1.2).
bool is_of_user(const Guid& writer) { return (writer.bytes[15] & 0xc0) == 0; }

struct Extent {
  std::size_t length = 0;  // without the header
  bool is_last = false;
  const char* objection = nullptr;
};
// The submessage is at the beginning of `rest`, the rest of its datagram.
Extent extent_of(ByteView rest) {
  if (rest.size() < kSubmessageHeader) return {0, true, "a submessage is cut"};
  const std::size_t room = rest.size() - kSubmessageHeader;
  const std::size_t length =
      (rest[1] & 1) != 0 ? rest[2] | (rest[3] << 8) : (rest[2] << 8) | rest[3];
  if (length == 0 && rest[0] != kPad && rest[0] != kInfoTime) return {room, true};
  if (length > room) return {length, true, "a submessage is longer than its datagram"};
  return {length};
}

}  // namespace

ByteView DatagramFilter::pass(std::span<std::uint8_t> datagram, Clock::time_point now,
                              SystemTime received) {
  std::vector<OnUnheard> unheard;
  std::vector<Handed> handed;
  std::vector<EndpointNews> news;
  std::shared_ptr<const Discovery> discovery;
  ByteView passed;
  {
    const MutexLock lock(mutex_);
    passed = look_at(datagram, now, received);
    unheard.swap(unheard_);
    handed.swap(handed_);
    news.swap(news_);
    if (!news.empty()) discovery = discovery_;
  }
  for (const EndpointNews& each : news) discovery->on_news(each);
  for (const Handed& each : handed) (*each.to)(each.sample);
  for (const OnUnheard& each : unheard) (*each)();
  return passed;
}

// An INFO submessage says from whom, to whom and when the submessages after it are.
void DatagramFilter::follow(std::span<std::uint8_t> submessage, ByteView body, Course& course) {
  if (submessage[0] == kInfoSource) {
    CULPRIT_ASSERT(body.size() >= 8 + course.source.bytes.size());
    std::copy_n(body.data() + 8, course.source.bytes.size(), course.source.bytes.begin());
    course.sent.reset();
  }
  if (submessage[0] == kInfoDestination) {
    CULPRIT_ASSERT(body.size() >= course.destination.bytes.size());
    std::copy_n(body.data(), course.destination.bytes.size(), course.destination.bytes.begin());
  }
  if (submessage[0] == kInfoTime)
    course.sent = SubmessageReader(submessage, body, course.source).read_time();
}

ByteView DatagramFilter::look_at(std::span<std::uint8_t> datagram, Clock::time_point now,
                                 SystemTime received) {
  if (!is_header(datagram)) {
    refused_ = {refused_.count + 1, "it is no RTPS message"};
    return {};
  }
  Course course{};
  course.received = received;
  std::copy_n(datagram.data() + 8, course.source.bytes.size(), course.source.bytes.begin());
  const bool addresses = addresses_ && changes_ == 0;
  bool has_unwanted = false;  // something of it
  bool has_wanted = false;
  Gap gap{};
  std::size_t end = datagram.size();
  for (std::size_t at = kHeader; at < end;) {
    const std::span<std::uint8_t> rest = datagram.subspan(at, end - at);
    auto [length, is_last, objection] = extent_of(rest);
    if (objection == nullptr) {
      const ByteView body = rest.subspan(kSubmessageHeader, length);
      objection = this->objection(SubmessageReader(rest, body, course.source), now);
      if (objection == nullptr) follow(rest, body, course);
    }
    if (objection != nullptr) refused_ = {refused_.count + 1, objection};
    const std::size_t size = kSubmessageHeader + length;
    Announcement announcement = Announcement::kOfMiddleware;
    if (objection == nullptr && discovery_ != nullptr && rest[0] == kData)
      announcement = take(rest.first(size), course, gap);
    const bool is_passed = objection == nullptr && announcement != Announcement::kInGapBefore &&
                           (!addresses || address(rest.first(size), course, now));
    has_wanted = has_wanted || (is_passed && !is_about_others(rest[0]));
    has_unwanted = has_unwanted || (objection == nullptr && !is_passed);
    if (!is_passed) {
      // A submessage without a length of its own, or with a false one, is cut off; the rest becomes
      // padding.
      if (is_last) {
        end = at;
        break;
      }
      rest[0] = kPad;
    }
    const std::size_t next = at + kSubmessageHeader + ((length + 3) & ~std::size_t{3});
    if (announcement == Announcement::kGap) {
      // It is shorter than what was there.
      if (is_last || next >= end) {
        end = at + kGapSize;
        break;
      }
      pad(rest.subspan(kGapSize, next - at - kGapSize));
    }
    at = next;
  }
  if (end <= kHeader && datagram.size() > kHeader) return {};
  if (has_unwanted && !has_wanted) return {};
  CULPRIT_ASSERT(end <= datagram.size());
  return datagram.first(end);
}

// ---- endpoints that this participant never meets

void DatagramFilter::discover(const GuidPrefix& self, NeverMeets never_meets,
                              std::function<void(const EndpointNews&)> on_news) {
  const MutexLock lock(mutex_);
  discovery_ = std::make_shared<const Discovery>(
      Discovery{self, std::move(never_meets), std::move(on_news)});
}

// It passed all checks: its lengths fit. For the middleware a gap takes its place, or the previous
// gap becomes longer.
DatagramFilter::Announcement DatagramFilter::take(std::span<std::uint8_t> submessage,
                                                  const Course& course, Gap& last) {
  const bool is_for_us =
      course.destination == GuidPrefix{} || course.destination == discovery_->self;
  if (!is_for_us || course.source == discovery_->self || !participants_.contains(course.source) ||
      submessage.size() < kGapSize + 2 * kSubmessageHeader)
    return Announcement::kOfMiddleware;
  SubmessageReader body(submessage, submessage.subspan(kSubmessageHeader), course.source);
  if (!tell_of_announcement(body)) return Announcement::kOfMiddleware;
  const SubmessageReader::Sample sample = body.read_sample();
  CULPRIT_ASSERT(body.ok());  // a gap with another number would hide what was never received
  const bool is_little = body.order() == Endianness::kLittle;
  const auto write = [](std::span<std::uint8_t> to, std::int64_t sequence, bool little) {
    const auto bits = static_cast<std::uint64_t>(sequence);
    const std::uint64_t high_first = bits << 32 | bits >> 32;  // two halves, the high one first
    for (std::size_t i = 0; i < 8; ++i)
      to[i] = static_cast<std::uint8_t>(little ? high_first >> (8 * i) : bits >> (8 * (7 - i)));
  };
  if (sample.writer == last.writer && sample.sequence == last.next) {
    write(last.base, ++last.next, last.is_little);
    return Announcement::kInGapBefore;
  }
  // Its reader and writer move to the front; then the beginning of the gap, the number that follows
  // it, and an empty bitmap.
  std::copy_n(submessage.begin() + 8, 8, submessage.begin() + 4);
  submessage[0] = kGap;
  submessage[1] &= 1;
  submessage[is_little ? 2 : 3] = kGapSize - kSubmessageHeader;
  submessage[is_little ? 3 : 2] = 0;
  write(submessage.subspan(12, 8), sample.sequence, is_little);
  write(submessage.subspan(20, 8), sample.sequence + 1, is_little);
  std::ranges::fill(submessage.subspan(28, 4), std::uint8_t{0});
  last = {submessage.subspan(20, 8), sample.writer, sample.sequence + 1, is_little};
  return Announcement::kGap;
}

// Gives whether the middleware need not see it.
bool DatagramFilter::tell_of_announcement(const SubmessageReader& submessage) {
  constexpr std::array<std::uint8_t, 4> kOfWriters = {0, 0, 3, 0xc2};  // RTPS 2.3 §9.3.1.3
  constexpr std::array<std::uint8_t, 4> kOfReaders = {0, 0, 4, 0xc2};
  SubmessageReader body = submessage;
  const SubmessageReader::Sample sample = body.read_sample();
  const std::span<const std::uint8_t> announcer(sample.writer.bytes.data() + 12, 4);
  const bool is_of_writers = std::ranges::equal(announcer, kOfWriters);
  if (!is_of_writers && !std::ranges::equal(announcer, kOfReaders)) return false;
  if ((body.flags & kHasPayload) == 0) {
    const auto ended = read_end(sample.parameters, body.order(), body.rest());
    if (!ended) return false;
    const auto known = announced_.find(*ended);
    if (known == announced_.end() || known->second >= sample.sequence) return false;
    known->second = sample.sequence;
    news_.push_back(EndpointGone{*ended});
    return false;
  }
  const EndpointRole role = is_of_writers ? EndpointRole::kWriter : EndpointRole::kReader;
  const auto topic = announced_topic(body.rest());
  if (!topic || !discovery_->never_meets(*topic, role)) return false;
  auto info = read_announcement(body.rest(), role);
  if (!info || info->guid.prefix() != sample.writer.prefix()) return false;
  const auto known = announced_.find(info->guid);
  if (known != announced_.end() && known->second >= sample.sequence) return true;
  if (known == announced_.end() && announced_.size() >= kMostAnnounced) return false;
  announced_.insert_or_assign(info->guid, sample.sequence);
  news_.push_back(std::move(*info));
  return true;
}

// ---- which reader receives which writer

// Addresses it to the one reader of its writer, if it is addressed to all. Gives whether the
// middleware has a reader for it.
bool DatagramFilter::address(std::span<std::uint8_t> submessage, const Course& course,
                             Clock::time_point now) {
  const std::uint8_t kind = submessage[0];
  const bool is_sample = kind == kData || kind == kDataFragment;
  const bool is_of_writer =
      is_sample || kind == kHeartbeat || kind == kGap || kind == kHeartbeatFragment;
  if (!is_of_writer) return true;
  const std::size_t reader = kSubmessageHeader + (is_sample ? 4 : 0);
  CULPRIT_ASSERT(submessage.size() >= reader + 8);  // it passed all checks
  const std::span<std::uint8_t, 4> to{submessage.data() + reader, 4};
  const bool is_addressed = std::ranges::any_of(to, [](std::uint8_t byte) { return byte != 0; });
  if (is_addressed && kind != kData) return true;
  Guid writer;
  std::ranges::copy(course.source.bytes, writer.bytes.begin());
  std::copy_n(to.data() + 4, 4, writer.bytes.begin() + 12);
  if (!is_of_user(writer)) return true;
  const auto found = readers_.find(writer);
  if (found == readers_.end()) return is_addressed || tries(writer, now);
  Readers::Reader* only = nullptr;
  for (Readers::Reader& each : found->second.all) {
    if (!is_sample && each.how == Reading::kBestEffort) continue;  // to which they mean nothing
    if (is_addressed && !std::equal(to.begin(), to.end(), each.guid.bytes.begin() + 12)) continue;
    if (only != nullptr) return true;
    only = &each;
  }
  if (only == nullptr) return is_addressed;
  std::copy_n(only->guid.bytes.begin() + 12, 4, to.begin());
  if (kind != kData) return true;
  const std::size_t before = handed_.size();
  if (!hand_over(*only, submessage, course)) return true;
  if (handed_.size() > before) found->second.unheard = 0;
  return false;
}

// Hands over a sample that the middleware would deliver as it is. Other samples are left to the
// middleware: those with inline parameters, those that dispose of a key, those without a source
// timestamp.
bool DatagramFilter::hand_over(Readers::Reader& reader, std::span<const std::uint8_t> submessage,
                               const Course& course) {
  constexpr std::uint8_t kMeaning = 0x1e;  // of the flags: all but the order of bytes
  if (!reader.on_whole || !course.sent || (submessage[1] & kMeaning) != kHasPayload) return false;
  if (course.destination != GuidPrefix{} && course.destination != reader.guid.prefix())
    return false;
  SubmessageReader body(submessage, submessage.subspan(kSubmessageHeader), course.source);
  const SubmessageReader::Sample sample = body.read_sample();
  CULPRIT_ASSERT(body.ok());                        // it passed all checks: its lengths fit
  if (sample.sequence <= reader.last) return true;  // best effort readers pass over what is older
  reader.last = sample.sequence;
  handed_.push_back({reader.on_whole,
                     {sample.writer, sample.sequence, *course.sent, course.received, body.rest()}});
  return true;
}

bool DatagramFilter::tries(const Guid& stranger, Clock::time_point now) {
  constexpr std::size_t kMost = 1024;  // the network decides how many there are
  if (strangers_.size() >= kMost && !strangers_.contains(stranger)) strangers_.clear();
  Stranger& known = strangers_[stranger];
  if (now - known.since >= std::chrono::seconds(1)) known = {now, 0};
  return known.tries++ < kTries;
}

const char* DatagramFilter::objection(const SubmessageReader& submessage, Clock::time_point now) {
  SubmessageReader body = submessage;
  switch (submessage.kind) {
    case kData:
      return objection_to_data(submessage, now);
    case kDataFragment:
      return objection_to_fragment(submessage, now);
    case kHeartbeat:
      return objection_to_heartbeat(submessage, now);
    case kGap:
      return objection_to_gap(submessage, now);
    case kAckNack:
    case kNackFragment: {
      body.skip(8);
      const std::int64_t base = body.read_sequence();
      // The fragments of a sample have shorter numbers.
      if (submessage.kind == kNackFragment) body.skip(4);
      if (base < 0 || base > kFirst) return "an acknowledgement of data that was never written";
      if (!body.skip_bitmap() || body.left() < 4) return "a damaged acknowledgement";
      return nullptr;
    }
    case kHeartbeatFragment:
      body.skip(24);
      return body.ok() ? nullptr : "a damaged heartbeat";
    case kInfoSource:
      return submessage.size() == 20 ? nullptr : "a damaged source";
    case kInfoDestination:
      return submessage.size() >= 12 ? nullptr : "a damaged destination";
    case kInfoTime:
      return (submessage.flags & 2) != 0 || submessage.size() >= 8 ? nullptr : "a damaged time";
    default:
      return nullptr;
  }
}

const char* DatagramFilter::objection_to_data(const SubmessageReader& submessage,
                                              Clock::time_point now) {
  constexpr const char* kDamaged = "a damaged sample";
  SubmessageReader body = submessage;
  const SubmessageReader::Sample sample = body.read_sample();
  const bool has_payload = (body.flags & kHasPayload) != 0;
  const bool has_key = (body.flags & kHasKey) != 0;
  if (!body.ok() || (has_payload && has_key)) return kDamaged;
  if ((has_payload || has_key) && body.left() < kEncapsulationSize) return kDamaged;
  // Fast DDS takes so few bytes as the key itself: those of another participant, which nobody has compared. Participants
  // write a list.
  if (has_key && is_builtin(sample.writer) && body.left() <= kKey) return "a key without a list";
  if (sample.sequence < 1 || is_far(sample.writer, sample.sequence, now))
    return "a sample with an absurd number";
  learn(sample.writer, sample.sequence, now);
  came_by(sample.writer, sample.sequence);
  return nullptr;
}

const char* DatagramFilter::objection_to_fragment(const SubmessageReader& submessage,
                                                  Clock::time_point now) {
  constexpr const char* kDamaged = "a damaged fragment";
  SubmessageReader body = submessage;
  const SubmessageReader::Sample sample = body.read_sample();
  if (!body.ok() || sample.first < 1 || sample.count < 1 || sample.fragment_size < 1 ||
      sample.size < 1)
    return kDamaged;
  const std::size_t size = sample.size;
  const std::size_t all = (size + sample.fragment_size - 1) / sample.fragment_size;
  const std::size_t before = std::size_t{sample.first} - 1;
  const std::size_t last = before + sample.count;
  if (all > kMostFragments || last > all) return kDamaged;
  const std::size_t bytes =
      std::min(size, last * sample.fragment_size) - before * sample.fragment_size;
  // No more than was announced, but for the padding of the last one.
  if (body.left() < bytes || body.left() > bytes + 3) return kDamaged;
  if (sample.sequence < 1 || is_far(sample.writer, sample.sequence, now))
    return "a fragment with an absurd number";
  came_by(sample.writer, sample.sequence);
  if (is_heard(sample.writer)) {
    const auto how = is_reliable(sample.writer) ? Reading::kReliable : Reading::kBestEffort;
    const char* reason = writers_.reserve(
        sample.writer, how,
        {sample.sequence, size, sample.fragment_size, sample.first, sample.count, all});
    if (reason != nullptr) return reason;
  }
  learn(sample.writer, sample.sequence, now);
  return nullptr;
}

const char* DatagramFilter::objection_to_heartbeat(const SubmessageReader& submessage,
                                                   Clock::time_point now) {
  SubmessageReader body = submessage;
  body.skip(4);
  const Guid guid = body.read_writer();
  const std::int64_t first = body.read_sequence();
  const std::int64_t last = body.read_sequence();
  body.skip(4);
  if (!body.ok()) return "a damaged heartbeat";
  // Best effort readers ignore it, and a reliable one counts up to it.
  if (first < 1 || last < first - 1 || is_far(guid, last, now) ||
      (is_reliable(guid) && is_far(guid, first, now)))
    return "a heartbeat with an absurd number";
  learn(guid, last, now);
  if (is_reliable(guid)) writers_.has_none_before(guid, first);
  return nullptr;
}

// A new reader may first receive the gap for all earlier samples of a writer. So a gap may be as
// far ahead as a heartbeat.
const char* DatagramFilter::objection_to_gap(const SubmessageReader& submessage,
                                             Clock::time_point now) {
  SubmessageReader body = submessage;
  body.skip(4);
  const Guid guid = body.read_writer();
  const std::int64_t first = body.read_sequence();
  const std::int64_t base = body.read_sequence();
  if (!body.skip_bitmap()) return "a damaged gap";
  if (!is_heard(guid)) return nullptr;
  if (first < 1 || base < first || is_far(guid, base - 1, now))
    return "a gap with an absurd number";
  return nullptr;
}

// ---- what is known of writers

bool DatagramFilter::is_heard(const Guid& writer) const {
  if (!is_builtin(writer)) return readers_.contains(writer);
  return is_read_builtin(writer) && participants_.contains(writer.prefix());
}

bool DatagramFilter::is_reliable(const Guid& writer) const {
  if (is_builtin(writer)) return true;
  const auto readers = readers_.find(writer);
  return readers != readers_.end() && readers->second.is_reliable();
}

bool DatagramFilter::is_far(const Guid& writer, std::int64_t sequence,
                            Clock::time_point now) const {
  if (const auto furthest = writers_.furthest(writer, now)) return sequence > *furthest;
  return sequence > (is_heard(writer) && is_reliable(writer) ? kFirstReliable : kFirst);
}

void DatagramFilter::learn(const Guid& writer, std::int64_t sequence, Clock::time_point now) {
  if (is_heard(writer)) writers_.wrote(writer, sequence, now);
}

void DatagramFilter::came_by(const Guid& writer, std::int64_t sequence) {
  const auto found = readers_.find(writer);
  if (found == readers_.end() || !found->second.on_unheard || found->second.sample == sequence)
    return;
  found->second.sample = sequence;
  if (++found->second.unheard > kUnheard) unheard_.push_back(found->second.on_unheard);
}

void DatagramFilter::delivered(const Guid& writer) {
  const MutexLock lock(mutex_);
  const auto found = readers_.find(writer);
  if (found != readers_.end()) found->second.unheard = 0;
}

void DatagramFilter::begin_hearing(const Guid& writer, const Guid& reader, Reading how,
                                   OnUnheard on_unheard, OnWhole on_whole) {
  const MutexLock lock(mutex_);
  if (how == Reading::kReliable && !is_reliable(writer)) writers_.forget(writer);
  Readers& readers = readers_[writer];
  readers.all.push_back({reader, how, std::move(on_whole)});
  strangers_.erase(writer);
  if (on_unheard) readers.on_unheard = std::move(on_unheard);
}

void DatagramFilter::end_hearing(const Guid& writer, const Guid& reader) {
  const MutexLock lock(mutex_);
  const auto found = readers_.find(writer);
  if (found == readers_.end()) return;
  Readers readers = found->second;
  std::erase_if(readers.all, [&](const Readers::Reader& each) { return each.guid == reader; });
  // The reservations were counted for the previous kind of reader.
  if (readers.all.empty() || readers.is_reliable() != found->second.is_reliable())
    writers_.forget(writer);
  if (readers.all.empty()) {
    readers_.erase(found);
  } else {
    found->second = std::move(readers);
  }
}

void DatagramFilter::begin_to_address() {
  const MutexLock lock(mutex_);
  addresses_ = true;
}

void DatagramFilter::know(const GuidPrefix& participant) {
  const MutexLock lock(mutex_);
  participants_.insert(participant);
}

void DatagramFilter::forget(const GuidPrefix& participant) {
  const MutexLock lock(mutex_);
  writers_.forget(participant);
  std::erase_if(readers_, [&](const auto& each) { return each.first.prefix() == participant; });
  std::erase_if(announced_, [&](const auto& each) { return each.first.prefix() == participant; });
  participants_.erase(participant);
}

bool DatagramFilter::knows(const GuidPrefix& participant) const {
  const MutexLock lock(mutex_);
  return participants_.contains(participant);
}

std::size_t DatagramFilter::known_writers() const {
  const MutexLock lock(mutex_);
  return writers_.size();
}

void DatagramFilter::note_refused(const char* why) {
  const MutexLock lock(mutex_);
  refused_ = {refused_.count + 1, why};
}

DatagramFilter::Refused DatagramFilter::refused() const {
  const MutexLock lock(mutex_);
  return refused_;
}

}  // namespace culprit::rtps
