// For tests: RTPS messages byte by byte, right ones and such as no participant sends.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <utility>

#include "rtps/cdr.h"
#include "rtps/guid.h"

namespace culprit::rtps {

// Little endian. Each member function adds a submessage.
class TestDatagram {
 public:
  // From the participant of `source`.
  explicit TestDatagram(const GuidPrefix& source) {
    bytes_ = {'R', 'T', 'P', 'S', 2, 3, 1, 15};
    append(source.bytes);
  }

  TestDatagram& heartbeat(const Guid& writer, std::int64_t first, std::int64_t last,
                          std::uint32_t count = 1) {
    return begin(0x07).readers().entity(writer).sequence(first).sequence(last).u32(count).end();
  }
  // The gap from `first` to `base` - 1, and a bitmap of so many bits, which is not there.
  TestDatagram& gap(const Guid& writer, std::int64_t first, std::int64_t base,
                    std::uint32_t bits = 0) {
    return begin(0x08).readers().entity(writer).sequence(first).sequence(base).u32(bits).end();
  }
  // It acknowledges all before `base`, and announces a bitmap of so many bits, which is not there.
  TestDatagram& acknowledgement(const Guid& reader, const Guid& writer, std::int64_t base,
                                std::uint32_t bits = 0) {
    return begin(0x06).entity(reader).entity(writer).sequence(base).u32(bits).u32(1).end();
  }
  TestDatagram& data(const Guid& writer, std::int64_t sequence) {
    begin(0x15, 4).u16(0).u16(16).readers().entity(writer).sequence(sequence);
    return u32(0x0000'0100).u32(7).end();
  }
  TestDatagram& sample(const Guid& writer, std::int64_t sequence, const Bytes& payload) {
    begin(0x15, 4).u16(0).u16(16).readers().entity(writer).sequence(sequence);
    append(payload);
    return end();
  }
  // The fragment `number`, from 1 on, of `size` bytes each, of a sample of `whole` bytes.
  TestDatagram& fragment(const Guid& writer, std::int64_t sequence, std::uint32_t number,
                         std::uint16_t size, std::uint32_t whole) {
    begin(0x16).u16(0).u16(28).readers().entity(writer).sequence(sequence).u32(number);
    u16(1).u16(size).u32(whole);
    const std::size_t begin = std::size_t{number - 1} * size;
    bytes_.resize(bytes_.size() + (begin < whole ? std::min<std::size_t>(size, whole - begin) : 0));
    return end();
  }
  // The same with the content of this sample.
  TestDatagram& part(const Guid& writer, std::int64_t sequence, std::uint32_t number,
                     std::uint16_t size, const Bytes& whole) {
    begin(0x16).u16(0).u16(28).readers().entity(writer).sequence(sequence).u32(number);
    u16(1).u16(size).u32(static_cast<std::uint32_t>(whole.size()));
    const std::size_t first = std::size_t{number - 1} * size;
    append(ByteView(whole).subspan(first, std::min<std::size_t>(size, whole.size() - first)));
    return end();
  }
  // By the participant's announcer of readers or of writers (kAnnouncesReaders, kAnnouncesWriters).
  TestDatagram& announcement(const Guid& announcer, std::int64_t sequence,
                             const Bytes& parameters) {
    begin(0x15, 4).u16(0).u16(16).readers().entity(announcer).sequence(sequence);
    append(Bytes{0, 3, 0, 0});
    append(parameters);
    return end();
  }
  // The end of the endpoint, or the participant, as Fast DDS announces it: all of it in inline
  // parameters.
  TestDatagram& farewell(const Guid& announcer, std::int64_t sequence, const Guid& endpoint) {
    begin(0x15, 2).u16(0).u16(16).readers().entity(announcer).sequence(sequence);
    u16(0x70).u16(16);
    append(endpoint.bytes);
    u16(0x71).u16(4);
    append(Bytes{0, 0, 0, 3});
    return u16(1).u16(0).end();
  }
  // The same with other inline parameters, which begin `at` bytes after the reader, and a payload; kKey: it is one.
  enum class Content : std::uint8_t { kNone = 0, kPayload = 4, kKey = 8 };
  TestDatagram& end_of(const Guid& announcer, std::int64_t sequence, const Bytes& parameters,
                       Content content, const Bytes& payload, std::uint16_t at = 16) {
    begin(0x15, static_cast<std::uint8_t>(2 | static_cast<int>(content))).u16(0).u16(at);
    readers().entity(announcer).sequence(sequence);
    append(parameters);
    append(payload);
    return end();
  }
  // Anything.
  TestDatagram& submessage(std::uint8_t kind, std::uint8_t flags, const Bytes& body) {
    begin(kind, flags);
    append(body);
    return end();
  }

  const Bytes& bytes() const { return bytes_; }

 private:
  TestDatagram& begin(std::uint8_t kind, std::uint8_t flags = 0) {
    start_ = bytes_.size();
    append(Bytes{kind, static_cast<std::uint8_t>(flags | 1), 0, 0});
    return *this;
  }
  TestDatagram& end() {
    while (bytes_.size() % 4 != 0) bytes_.push_back(0);
    const std::size_t length = bytes_.size() - start_ - 4;
    bytes_[start_ + 2] = static_cast<std::uint8_t>(length);
    bytes_[start_ + 3] = static_cast<std::uint8_t>(length >> 8);
    return *this;
  }
  TestDatagram& readers() { return u32(0); }  // all readers of the writer
  TestDatagram& entity(const Guid& guid) {
    bytes_.insert(bytes_.end(), guid.bytes.begin() + 12, guid.bytes.end());
    return *this;
  }
  TestDatagram& sequence(std::int64_t number) {
    const auto bits = static_cast<std::uint64_t>(number);
    return u32(static_cast<std::uint32_t>(bits >> 32)).u32(static_cast<std::uint32_t>(bits));
  }
  TestDatagram& u16(std::uint16_t value) {
    append(Bytes{static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value >> 8)});
    return *this;
  }
  TestDatagram& u32(std::uint32_t value) {
    return u16(static_cast<std::uint16_t>(value)).u16(static_cast<std::uint16_t>(value >> 16));
  }
  template <class Range>
  void append(const Range& range) {
    bytes_.insert(bytes_.end(), range.begin(), range.end());
  }

  Bytes bytes_;
  std::size_t start_ = 0;
};

// The announcement of an endpoint, little endian and without its encapsulation.
class TestParameters {
 public:
  TestParameters& add(std::uint16_t id, Bytes value) {
    while (value.size() % 4 != 0) value.push_back(0);
    for (const std::size_t number : {std::size_t{id}, value.size()}) {
      bytes_.push_back(static_cast<std::uint8_t>(number));
      bytes_.push_back(static_cast<std::uint8_t>(number >> 8));
    }
    bytes_.insert(bytes_.end(), value.begin(), value.end());
    return *this;
  }
  TestParameters& add(std::uint16_t id, std::string_view text) {
    Bytes value{static_cast<std::uint8_t>(text.size() + 1), 0, 0, 0};
    value.insert(value.end(), text.begin(), text.end());
    value.push_back(0);
    return add(id, std::move(value));
  }
  TestParameters& endpoint(const Guid& guid) {
    return add(0x5a, Bytes(guid.bytes.begin(), guid.bytes.end()));
  }
  Bytes end() {
    Bytes all = bytes_;
    all.insert(all.end(), {1, 0, 0, 0});
    return all;
  }

 private:
  Bytes bytes_;
};

}  // namespace culprit::rtps
