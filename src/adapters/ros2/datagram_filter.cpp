#include "ros2/datagram_filter.h"

#include <algorithm>
#include <cstring>
#include <optional>

#include "ros2/rtps_submessage.h"

namespace culprit::ros2 {
namespace {

constexpr std::uint16_t kSentinel = 1;  // of a list of parameters
constexpr std::size_t kMostFragments = 1 << 16;

bool is_header(ByteView datagram) {
  return datagram.size() >= rtps::kHeader && std::memcmp(datagram.data(), "RTPS", 4) == 0 &&
         datagram[4] == 2;
}

bool is_builtin(const Guid& writer) { return (writer.bytes[15] & 0xc0) == 0xc0; }
// What a program made, and no middleware for itself (RTPS 2.3 §9.3.1.2).
bool is_of_user(const Guid& writer) { return (writer.bytes[15] & 0xc0) == 0; }

}  // namespace

// One submessage: a cursor over its body. What is read beyond the end is zero, and makes it not
// ok().
class DatagramFilter::Submessage {
 public:
  Submessage(ByteView header, ByteView body, const GuidPrefix& source)
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
  // Nothing: what was sent before does not count, and no other time is said.
  std::optional<std::chrono::sys_time<std::chrono::nanoseconds>> read_time() {
    if ((flags & 2) != 0) return std::nullopt;
    const auto seconds = read<std::uint32_t>();
    const std::uint64_t fraction = read<std::uint32_t>();  // of 2^32 (RTPS 2.3 §9.3.2)
    const auto ns = (fraction * 1'000'000'000 + (std::uint64_t{1} << 31)) >> 32;
    return std::chrono::sys_time<std::chrono::nanoseconds>(
        std::chrono::seconds(seconds) + std::chrono::nanoseconds(static_cast<std::int64_t>(ns)));
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
  // Whether a list of parameters follows that ends within the body.
  bool skip_parameters() {
    while (is_ok_) {
      const auto id = read<std::uint16_t>();
      const auto length = read<std::uint16_t>();
      if (id == kSentinel) return ok();
      skip((length + 3u) & ~3u);
    }
    return false;
  }

 private:
  const ByteView body_;
  const GuidPrefix& source_;
  std::size_t at_ = 0;
  bool is_ok_ = true;
};

ByteView DatagramFilter::pass(std::span<std::uint8_t> datagram, Clock::time_point now) {
  std::vector<OnUnheard> unheard;
  std::vector<Handed> handed;
  ByteView passed;
  {
    const MutexLock lock(mutex_);
    passed = look_at(datagram, now);
    unheard.swap(unheard_);
    handed.swap(handed_);
  }
  for (const Handed& each : handed) (*each.to)(each.sample);
  for (const OnUnheard& each : unheard) (*each)();
  return passed;
}

ByteView DatagramFilter::look_at(std::span<std::uint8_t> datagram, Clock::time_point now) {
  if (!is_header(datagram)) {
    refused_ = {refused_.count + 1, "it is no RTPS message"};
    return {};
  }
  Course course{};
  GuidPrefix& source = course.source;
  std::copy_n(datagram.data() + 8, source.bytes.size(), source.bytes.begin());
  const bool addresses = addresses_ && changes_ == 0;
  bool is_for_nobody = false;  // something of it
  bool is_for_somebody = false;
  std::size_t end = datagram.size();
  for (std::size_t at = rtps::kHeader; at < end;) {
    const std::span<std::uint8_t> rest = datagram.subspan(at, end - at);
    const char* objection = nullptr;
    std::size_t length = 0;
    bool is_last = false;
    if (rest.size() < rtps::kSubmessageHeader) {
      objection = "a submessage is cut";
      is_last = true;
    } else {
      length = (rest[1] & 1) != 0 ? rest[2] | (rest[3] << 8) : (rest[2] << 8) | rest[3];
      is_last = length == 0 && rest[0] != rtps::kPad && rest[0] != rtps::kInfoTime;
      if (is_last) length = rest.size() - rtps::kSubmessageHeader;
      if (length > rest.size() - rtps::kSubmessageHeader) {
        objection = "a submessage is longer than its datagram";
        is_last = true;
      } else {
        const ByteView body = rest.subspan(rtps::kSubmessageHeader, length);
        objection = this->objection(Submessage(rest, body, source), now);
        if (rest[0] == rtps::kInfoSource && objection == nullptr) {
          std::copy_n(body.data() + 8, source.bytes.size(), source.bytes.begin());
          course.sent.reset();
        }
        if (rest[0] == rtps::kInfoDestination && objection == nullptr)
          std::copy_n(body.data(), course.destination.bytes.size(),
                      course.destination.bytes.begin());
        if (rest[0] == rtps::kInfoTime && objection == nullptr)
          course.sent = Submessage(rest, body, source).read_time();
      }
    }
    if (objection != nullptr) refused_ = {refused_.count + 1, objection};
    const bool is_passed =
        objection == nullptr &&
        (!addresses || address(rest.first(rtps::kSubmessageHeader + length), course, now));
    is_for_somebody = is_for_somebody || (is_passed && !rtps::is_about_others(rest[0]));
    is_for_nobody = is_for_nobody || (objection == nullptr && !is_passed);
    if (!is_passed) {
      // What has no length of its own, or a false one, is cut off; the rest becomes padding.
      if (is_last) {
        end = at;
        break;
      }
      rest[0] = rtps::kPad;
    }
    at += rtps::kSubmessageHeader + ((length + 3) & ~std::size_t{3});
  }
  if (end <= rtps::kHeader && datagram.size() > rtps::kHeader) return {};
  if (is_for_nobody && !is_for_somebody) return {};
  return datagram.first(end);
}

// To the one reader that hears its writer, if it is addressed to all. Gives whether the middleware has a
// reader for it.
bool DatagramFilter::address(std::span<std::uint8_t> submessage, const Course& course,
                             Clock::time_point now) {
  const std::uint8_t kind = submessage[0];
  const bool is_sample = kind == rtps::kData || kind == rtps::kDataFragment;
  const bool is_of_writer = is_sample || kind == rtps::kHeartbeat || kind == rtps::kGap ||
                            kind == rtps::kHeartbeatFragment;
  if (!is_of_writer) return true;
  // Nothing was objected to it: it is long enough.
  const std::span<std::uint8_t, 4> to{
      submessage.data() + rtps::kSubmessageHeader + (is_sample ? 4 : 0), 4};
  const bool is_addressed = std::ranges::any_of(to, [](std::uint8_t byte) { return byte != 0; });
  if (is_addressed && kind != rtps::kData) return true;
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
  if (kind != rtps::kData) return true;
  const std::size_t before = handed_.size();
  if (!hand_over(*only, submessage, course)) return true;
  if (handed_.size() > before) found->second.unheard = 0;
  return false;
}

// What the middleware would deliver as it is. Whatever is not plain is left to it: what has inline
// parameters, what disposes of a key, what does not say when it was sent.
bool DatagramFilter::hand_over(Readers::Reader& reader, std::span<const std::uint8_t> submessage,
                               const Course& course) {
  constexpr std::uint8_t kMeaning = 0x1e;  // of the flags: all but the order of bytes
  constexpr std::uint8_t kPayloadOnly = 0x04;
  if (!reader.on_whole || !course.sent || (submessage[1] & kMeaning) != kPayloadOnly) return false;
  if (course.destination != GuidPrefix{} && course.destination != reader.guid.prefix())
    return false;
  // Nothing was objected to it: its lengths fit.
  Submessage body(submessage, submessage.subspan(rtps::kSubmessageHeader), course.source);
  body.skip(2);
  const auto to_parameters = body.read<std::uint16_t>();
  const std::size_t counted_from = body.at();
  body.skip(4);
  const Guid writer = body.read_writer();
  const std::int64_t sequence = body.read_sequence();
  body.skip(to_parameters - (body.at() - counted_from));
  if (sequence <= reader.last) return true;  // best effort readers pass over what is older
  reader.last = sequence;
  handed_.push_back(
      {reader.on_whole, {writer, sequence, *course.sent, submessage.last(body.left())}});
  return true;
}

bool DatagramFilter::tries(const Guid& stranger, Clock::time_point now) {
  constexpr std::size_t kMost = 1024;  // the network decides how many there are
  if (strangers_.size() >= kMost && !strangers_.contains(stranger)) strangers_.clear();
  Stranger& known = strangers_[stranger];
  if (now - known.since >= std::chrono::seconds(1)) known = {now, 0};
  return known.tries++ < kTries;
}

const char* DatagramFilter::objection(const Submessage& submessage, Clock::time_point now) {
  Submessage body = submessage;
  switch (submessage.kind) {
    case rtps::kData:
      return objection_to_data(submessage, now);
    case rtps::kDataFragment:
      return objection_to_fragment(submessage, now);
    case rtps::kHeartbeat:
      return objection_to_heartbeat(submessage, now);
    case rtps::kGap:
      return objection_to_gap(submessage, now);
    case rtps::kAckNack:
    case rtps::kNackFragment: {
      body.skip(8);
      const std::int64_t base = body.read_sequence();
      // The fragments of a sample have shorter numbers.
      if (submessage.kind == rtps::kNackFragment) body.skip(4);
      if (base < 0 || base > kFirst) return "an acknowledgement of what nobody wrote";
      if (!body.skip_bitmap() || body.left() < 4) return "a damaged acknowledgement";
      return nullptr;
    }
    case rtps::kHeartbeatFragment:
      body.skip(24);
      return body.ok() ? nullptr : "a damaged heartbeat";
    case rtps::kInfoSource:
      return submessage.size() == 20 ? nullptr : "a damaged source";
    case rtps::kInfoDestination:
      return submessage.size() >= 12 ? nullptr : "a damaged destination";
    case rtps::kInfoTime:
      return (submessage.flags & 2) != 0 || submessage.size() >= 8 ? nullptr : "a damaged time";
    default:
      return nullptr;
  }
}

const char* DatagramFilter::objection_to_data(const Submessage& submessage, Clock::time_point now) {
  constexpr const char* kDamaged = "a damaged sample";
  Submessage body = submessage;
  body.skip(2);
  const auto to_parameters = body.read<std::uint16_t>();
  const std::size_t counted_from = body.at();
  body.skip(4);
  const Guid writer = body.read_writer();
  const std::int64_t sequence = body.read_sequence();
  if (!body.ok() || to_parameters < body.at() - counted_from) return kDamaged;
  body.skip(to_parameters - (body.at() - counted_from));
  if ((body.flags & 2) != 0 && !body.skip_parameters()) return kDamaged;
  const bool has_payload = (body.flags & 4) != 0;
  const bool has_key = (body.flags & 8) != 0;
  if (!body.ok() || (has_payload && has_key)) return kDamaged;
  if ((has_payload || has_key) && body.left() < kEncapsulationSize) return kDamaged;
  if (sequence < 1 || is_far(writer, sequence, now)) return "a sample with an absurd number";
  learn(writer, sequence, now);
  came_by(writer, sequence);
  return nullptr;
}

const char* DatagramFilter::objection_to_fragment(const Submessage& submessage,
                                                  Clock::time_point now) {
  constexpr const char* kDamaged = "a damaged fragment";
  Submessage body = submessage;
  body.skip(2);
  const auto to_parameters = body.read<std::uint16_t>();
  const std::size_t counted_from = body.at();
  body.skip(4);
  const Guid writer = body.read_writer();
  const std::int64_t sequence = body.read_sequence();
  const auto first = body.read<std::uint32_t>();
  const std::uint32_t count = body.read<std::uint16_t>();
  Assembly assembly;
  assembly.fragment_size = body.read<std::uint16_t>();
  assembly.size = body.read<std::uint32_t>();
  if (!body.ok() || to_parameters < body.at() - counted_from) return kDamaged;
  body.skip(to_parameters - (body.at() - counted_from));
  if ((body.flags & 2) != 0 && !body.skip_parameters()) return kDamaged;
  if (!body.ok() || first < 1 || count < 1 || assembly.fragment_size < 1 || assembly.size < 1)
    return kDamaged;
  const std::size_t all = (assembly.size + assembly.fragment_size - 1) / assembly.fragment_size;
  const std::size_t last = std::size_t{first} - 1 + count;
  if (all > kMostFragments || last > all) return kDamaged;
  const std::size_t bytes = std::min(assembly.size, last * assembly.fragment_size) -
                            (std::size_t{first} - 1) * assembly.fragment_size;
  // No more than was announced, but for the padding of the last one.
  if (body.left() < bytes || body.left() > bytes + 3) return kDamaged;
  if (sequence < 1 || is_far(writer, sequence, now)) return "a fragment with an absurd number";
  came_by(writer, sequence);
  assembly.missing = all;
  if (const char* reason = reserve(writer, sequence, assembly, first, count)) return reason;
  learn(writer, sequence, now);
  return nullptr;
}

// A reliable reader keeps what it has of each sample; one that is best effort what it has of the
// newest, and its memory for the next.
const char* DatagramFilter::reserve(const Guid& guid, std::int64_t sequence, const Assembly& wanted,
                                    std::uint32_t first, std::uint32_t count) {
  constexpr const char* kTooMuch = "fragments of more than fits the memory";
  if (!is_heard(guid)) return nullptr;
  const bool keeps_all = is_reliable(guid);
  Writer& writer = writers_[guid];
  auto found = writer.assemblies.find(sequence);
  if (found == writer.assemblies.end()) {
    const std::size_t of_one = keeps_all ? kReliableOfOne : kLargest;
    const std::size_t of_all = keeps_all ? kReliableOfAll : kLargestOfAll;
    if (!keeps_all && !writer.assemblies.empty() && writer.assemblies.begin()->first > sequence)
      return nullptr;  // of an older sample, which the reader passes over
    const std::size_t reserved =
        keeps_all ? writer.reserved + wanted.size : std::max(writer.reserved, wanted.size);
    if (reserved > of_one || total(guid) - writer.reserved + reserved > of_all) return kTooMuch;
    total(guid) += reserved - writer.reserved;
    writer.reserved = reserved;
    if (!keeps_all) writer.assemblies.clear();
    found = writer.assemblies.emplace(sequence, wanted).first;
    if (keeps_all) found->second.seen.resize(wanted.missing);
  }
  Assembly& assembly = found->second;
  if (assembly.size != wanted.size || assembly.fragment_size != wanted.fragment_size)
    return "fragments that contradict one another";
  if (!keeps_all || assembly.seen.empty()) return nullptr;
  for (std::size_t i = first - 1; i < std::size_t{first} - 1 + count; ++i) {
    if (assembly.seen[i]) continue;
    assembly.seen[i] = true;
    --assembly.missing;
  }
  if (assembly.missing == 0) release(guid, writer, found);
  return nullptr;
}

const char* DatagramFilter::objection_to_heartbeat(const Submessage& submessage,
                                                   Clock::time_point now) {
  Submessage body = submessage;
  body.skip(4);
  const Guid guid = body.read_writer();
  const std::int64_t first = body.read_sequence();
  const std::int64_t last = body.read_sequence();
  body.skip(4);
  if (!body.ok()) return "a damaged heartbeat";
  // Best effort readers do not hear it, and a reliable one counts up to it.
  if (first < 1 || last < first - 1 || is_far(guid, last, now) ||
      (is_reliable(guid) && is_far(guid, first, now)))
    return "a heartbeat with an absurd number";
  learn(guid, last, now);
  const auto known = writers_.find(guid);
  if (known == writers_.end() || !is_reliable(guid)) return nullptr;
  auto& assemblies = known->second.assemblies;
  while (!assemblies.empty() && assemblies.begin()->first < first)
    release(guid, known->second, assemblies.begin());
  return nullptr;
}

// The first that a new reader hears of a writer may be the gap of what was before, so a gap may be
// as far ahead as a heartbeat.
const char* DatagramFilter::objection_to_gap(const Submessage& submessage, Clock::time_point now) {
  Submessage body = submessage;
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
  return is_builtin(writer) ? participants_.contains(writer.prefix()) : readers_.contains(writer);
}

bool DatagramFilter::is_reliable(const Guid& writer) const {
  if (is_builtin(writer)) return true;
  const auto readers = readers_.find(writer);
  return readers != readers_.end() && readers->second.is_reliable();
}

bool DatagramFilter::is_far(const Guid& guid, std::int64_t sequence, Clock::time_point now) const {
  const auto known = writers_.find(guid);
  if (known == writers_.end() || known->second.last == 0)
    return sequence > (is_heard(guid) && is_reliable(guid) ? kFirstReliable : kFirst);
  const auto silence = std::chrono::duration<double>(now - known->second.heard).count();
  const auto ahead = static_cast<std::int64_t>(std::clamp(silence, 0.0, 1e6) * kPerSecond);
  return sequence > known->second.last + kAhead + ahead;
}

void DatagramFilter::learn(const Guid& guid, std::int64_t sequence, Clock::time_point now) {
  if (!is_heard(guid)) return;
  Writer& writer = writers_[guid];
  writer.last = std::max(writer.last, sequence);
  writer.heard = now;
}

std::size_t& DatagramFilter::total(const Guid& writer) {
  return is_reliable(writer) ? reserved_reliable_ : reserved_best_effort_;
}

void DatagramFilter::release(const Guid& guid, Writer& writer,
                             std::map<std::int64_t, Assembly>::iterator which) {
  total(guid) -= which->second.size;
  writer.reserved -= which->second.size;
  writer.assemblies.erase(which);
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

// What was reserved of the writer is free again, and nothing is known of it.
void DatagramFilter::drop(const Guid& guid) {
  const auto known = writers_.find(guid);
  if (known == writers_.end()) return;
  total(guid) -= known->second.reserved;
  writers_.erase(known);
}

void DatagramFilter::begin_hearing(const Guid& writer, const Guid& reader, Reading how,
                                   OnUnheard on_unheard, OnWhole on_whole) {
  const MutexLock lock(mutex_);
  if (how == Reading::kReliable && !is_reliable(writer)) drop(writer);
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
  // What was reserved was counted as what it was then.
  if (readers.all.empty() || readers.is_reliable() != found->second.is_reliable()) drop(writer);
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
  std::erase_if(writers_, [&](const auto& each) CULPRIT_REQUIRES(mutex_) {
    if (each.first.prefix() != participant) return false;
    total(each.first) -= each.second.reserved;
    return true;
  });
  std::erase_if(readers_, [&](const auto& each) { return each.first.prefix() == participant; });
  participants_.erase(participant);
}

DatagramFilter::Refused DatagramFilter::refused() const {
  const MutexLock lock(mutex_);
  return refused_;
}

}  // namespace culprit::ros2
