// For tests: a process of its own that sends datagrams in the name of others, again and again.
#pragma once

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <iterator>
#include <limits>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>
#include <vector>

#include "rtps/datagram_sources.h"
#include "rtps/submessage.h"
#include "rtps/test_datagram.h"
#include "rtps/test_sockets.h"

namespace culprit::rtps {

// A stranger's lies that remove a participant. Reliable readers take a number only if it is the next one, so some after it
// are tried, too.
inline Guid builtin_of(Guid participant, std::uint8_t kind, std::uint8_t number) {
  participant.bytes[12] = 0, participant.bytes[13] = kind, participant.bytes[14] = number;
  participant.bytes[15] = 0xc2;
  return participant;
}
// Its endpoints have ended.
inline std::vector<Bytes> farewells_of_endpoints(const Guid& participant,
                                                 const std::vector<Guid>& endpoints) {
  std::vector<Bytes> all;
  for (const Guid& each : endpoints) {
    const auto announced = std::ranges::count_if(
        endpoints, [&](const Guid& other) { return other.is_reader() == each.is_reader(); });
    const Guid announcer = builtin_of(participant, 0, each.is_reader() ? 4 : 3);
    for (std::int64_t i = announced + 1; i <= announced + 4; ++i)
      all.push_back(TestDatagram(participant.prefix()).farewell(announcer, i, each).bytes());
  }
  return all;
}
// `info` is what its ros_discovery_info says, as a payload; `writer` writes that.
inline std::vector<Bytes> forged_info(const Guid& participant, const Guid& writer,
                                      const Bytes& info) {
  std::vector<Bytes> all;
  for (std::int64_t i = 2; i < 40; ++i)
    all.push_back(TestDatagram(participant.prefix()).sample(writer, i, info).bytes());
  return all;
}
// It has left.
inline Bytes farewell_of(const Guid& participant) {
  return TestDatagram(participant.prefix())
      .farewell(builtin_of(participant, 1, 0), 1000, participant)
      .bytes();
}
// All of them. `no_nodes`: it holds no node.
inline std::vector<Bytes> farewells(const Guid& participant, const std::vector<Guid>& endpoints,
                                    const Guid& info_writer, const Bytes& no_nodes) {
  std::vector<Bytes> all = farewells_of_endpoints(participant, endpoints);
  std::ranges::copy(forged_info(participant, info_writer, no_nodes), std::back_inserter(all));
  all.push_back(farewell_of(participant));
  return all;
}

// It has left, as `liar` announces it in its own name, each time in another form.
inline std::vector<Bytes> disguised_farewells(const Guid& participant, const GuidPrefix& liar) {
  using Content = TestDatagram::Content;
  const Guid announcer = builtin_of(participant, 1, 0);
  const Bytes key(participant.bytes.begin(), participant.bytes.end());
  const auto list = [&](std::uint8_t first, std::uint8_t length) {
    Bytes bytes{first, 3, 0, 0, 0x50, 0, length, 0};
    bytes.insert(bytes.end(), key.begin(), key.end());
    bytes.insert(bytes.end(), {1, 0, 0, 0});
    return bytes;
  };
  const Bytes ends = TestParameters().add(0x71, Bytes{0, 0, 0, 3}).end();
  constexpr std::uint16_t kNegative = 0x8000;
  Bytes far = TestParameters().add(0x70, key).add(0x71, Bytes{0, 0, 0, 3}).end();
  far.resize(kNegative, 0);
  far.insert(far.end(), {1, 0, 0, 0});
  const auto from = [&] { return TestDatagram(liar); };
  return {
      from().end_of(announcer, 100, ends, Content::kKey, key).bytes(),
      from().end_of(announcer, 101, ends, Content::kPayload, list(9, 16)).bytes(),
      from().end_of(announcer, 102, ends, Content::kPayload, list(0, 4)).bytes(),
      from().end_of(announcer, 103, far, Content::kNone, {}, kNegative).bytes(),
  };
}

// The same in the body of another submessage, or behind one whose length can be read in two ways: in the name of `liar`, and
// in that of the participant.
inline std::vector<Bytes> smuggled_farewells(const Guid& participant, const GuidPrefix& liar) {
  const auto append = [](Bytes& to, const Bytes& more) {
    to.insert(to.end(), more.begin(), more.end());
  };
  const auto submessages = [](const TestDatagram& datagram) {
    return Bytes(datagram.bytes().begin() + kHeader, datagram.bytes().end());
  };
  Guid writer;
  std::ranges::copy(liar.bytes, writer.bytes.begin());
  writer.bytes[14] = 7, writer.bytes[15] = 3;
  const Guid announcer = builtin_of(participant, 1, 0);
  Bytes source = {0, 0, 0, 0, 2, 3, 1, 15};
  append(source, Bytes(participant.bytes.begin(), participant.bytes.begin() + 12));
  constexpr std::uint8_t kOfVendor = 0x80;
  const std::vector<Bytes> before = {
      {kOfVendor, 1, 0, 0},              // to the end of the datagram, or of nothing
      {0x15, 1, 0, 0},                   // likewise
      {0x01, 1, 0, 0},                   // of nothing
      {kOfVendor, 1, 1, 0, 0},           // the next one begins behind it, or at a multiple of four
      {kOfVendor, 1, 3, 0, 0, 0, 0, 0},  // likewise
      {kOfVendor, 0, 4, 0, 0, 0, 0, 0}   // of 1024 bytes, or of four
  };
  std::vector<Bytes> all;
  for (const Bytes& farewell :
       {submessages(TestDatagram(liar).farewell(announcer, 104, participant)),
        submessages(TestDatagram(liar)
                        .submessage(0x0c, 0, source)
                        .farewell(announcer, 105, participant))}) {
    all.push_back(TestDatagram(liar).sample(writer, 1, farewell).bytes());
    all.push_back(TestDatagram(liar).submessage(kOfVendor, 0, farewell).bytes());
    for (const Bytes& each : before) {
      Bytes whole = TestDatagram(liar).bytes();
      append(whole, each);
      append(whole, farewell);
      all.push_back(std::move(whole));
    }
  }
  return all;
}

// Ranges of numbers that end before they begin, or have more of them than can be counted; bitmaps that are not there. In the
// name of `writer`, and of a reader beside it.
inline std::vector<Bytes> absurd_ranges(const Guid& writer) {
  using Range = std::pair<std::int64_t, std::int64_t>;
  constexpr std::int64_t kLowest = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kHighest = std::numeric_limits<std::int64_t>::max();
  constexpr std::uint32_t kMost = std::numeric_limits<std::uint32_t>::max();
  const TestDatagram from(writer.prefix());
  Guid reader = writer;
  reader.bytes[15] = 0xc7;
  std::vector<Bytes> all;
  for (const auto& [first, last] :
       {Range{1, kLowest}, Range{kHighest, kLowest}, Range{kLowest, kHighest},
        Range{kHighest, kHighest}, Range{0, 0}, Range{-1, 1}, Range{100, 1}, Range{1, 0}}) {
    for (const std::uint32_t bits : {0u, 256u, 257u, kMost}) {
      all.push_back(TestDatagram(from).gap(writer, first, last, bits).bytes());
      all.push_back(TestDatagram(from).acknowledgement(reader, writer, last, bits).bytes());
    }
    all.push_back(TestDatagram(from).heartbeat(writer, first, last).bytes());
    all.push_back(TestDatagram(from).fragment(writer, last, kMost, 1, kMost).bytes());
    all.push_back(TestDatagram(from).fragment(writer, last, 0, 0xffff, kMost).bytes());
  }
  return all;
}

// A participant that does not exist.
inline Guid made_up(std::uint16_t number) {
  Guid guid;
  guid.bytes = {1, 15, 0x5a, 0x5a};
  guid.bytes[10] = static_cast<std::uint8_t>(number >> 8);
  guid.bytes[11] = static_cast<std::uint8_t>(number);
  guid.bytes[14] = 1;
  guid.bytes[15] = 0xc1;
  return guid;
}
// One of its writers: (1, 0) announces it, (0, 3) its writers, (0, 4) its readers.
inline Guid made_up(std::uint16_t number, std::uint8_t kind, std::uint8_t writer) {
  return builtin_of(made_up(number), kind, writer);
}

// Its announcement (RTPS 2.3 §8.5.4.2, §9.6.2.2).
inline Bytes announcement_of(std::uint16_t number) {
  const Guid guid = made_up(number);
  TestParameters said;
  said.add(0x15, Bytes{2, 3}).add(0x16, Bytes{1, 15});
  said.add(0x50, Bytes(guid.bytes.begin(), guid.bytes.end()));
  Bytes locator{1, 0, 0, 0, 0x39, 0x30, 0, 0};
  locator.resize(20);
  locator.insert(locator.end(), {127, 0, 0, 1});
  said.add(0x32, locator).add(0x31, locator);
  said.add(0x58, Bytes{0x3f, 0, 0, 0}).add(0x02, Bytes{100, 0, 0, 0, 0, 0, 0, 0});
  return TestDatagram(guid.prefix()).announcement(made_up(number, 1, 0), 1, said.end()).bytes();
}

class HostileProcess {
 public:
  // It sends all to each address, and then waits for `pause`.
  HostileProcess(const std::vector<Bytes>& datagrams, const std::vector<UdpAddress>& to,
                 std::chrono::milliseconds pause)
      : pid_(fork_or_abort()) {
    if (pid_ == 0) attack(datagrams, to, pause);
  }
  ~HostileProcess() {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  HostileProcess(const HostileProcess&) = delete;
  HostileProcess& operator=(const HostileProcess&) = delete;

 private:
  // After a fork of a process with threads: system calls only.
  [[noreturn]] static void attack(const std::vector<Bytes>& datagrams,
                                  const std::vector<UdpAddress>& to,
                                  std::chrono::milliseconds pause) {
    const int descriptor = socket(AF_INET, SOCK_DGRAM, 0);
    const timespec rest{pause.count() / 1000, pause.count() % 1000 * 1'000'000};
    for (;;) {
      for (const Bytes& each : datagrams) {
        for (const UdpAddress& address : to) {
          sockaddr_in there{};
          there.sin_family = AF_INET;
          std::memcpy(&there.sin_addr, address.ip.data(), address.ip.size());
          there.sin_port = htons(address.port);
          sendto(descriptor, each.data(), each.size(), 0, reinterpret_cast<sockaddr*>(&there),
                 sizeof there);
        }
      }
      nanosleep(&rest, nullptr);
    }
  }

  pid_t pid_;
};

}  // namespace culprit::rtps
