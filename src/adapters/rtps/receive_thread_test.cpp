#include "rtps/receive_thread.h"

#include <algorithm>
#include <arpa/inet.h>
#include <atomic>
#include <semaphore>
#include <set>
#include <string>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "rtps/test_event_log.h"

namespace culprit::rtps {
namespace {

using ::testing::ElementsAre;
using ::testing::SizeIs;

const in_addr kThisMachine{htonl(INADDR_LOOPBACK)};

// Sends from a port of its own.
class Voice {
 public:
  Voice() {
    address_.sin_family = AF_INET;
    address_.sin_addr = kThisMachine;
    socklen_t size = sizeof address_;
    EXPECT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&address_), size), 0);
    EXPECT_EQ(getsockname(socket_, reinterpret_cast<sockaddr*>(&address_), &size), 0);
  }
  ~Voice() { close(socket_); }
  Voice(const Voice&) = delete;

  void say(std::uint16_t port, const std::string& text) const {
    sockaddr_in to = address_;
    to.sin_port = htons(port);
    sendto(socket_, text.data(), text.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
  }
  std::uint16_t port() const { return ntohs(address_.sin_port); }

 private:
  const int socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address_{};
};

// Ports that were free a moment ago.
std::uint16_t unused_port() { return Voice().port(); }

struct Listener {
  // Opens a port and notes what comes there, with that name before it.
  std::uint16_t open(const std::string& name, Haste haste = Haste::kNow,
                     const ReceiveThread::HasTime& has_time = {}) {
    while (true) {
      const std::uint16_t port = unused_port();
      if (thread.open({.ip = kThisMachine, .port = port, .haste = haste, .has_time = has_time},
                      [this, name](const ReceiveThread::Datagram& datagram) {
                        sender = datagram.from.port;
                        heard.add(name + std::string(datagram.bytes.begin(), datagram.bytes.end()));
                      }))
        return port;
    }
  }

  EventLog<std::string> heard;
  std::atomic<std::uint16_t> sender = 0;
  ReceiveThread thread;
};

TEST(ReceiveThread, HearsAllItsSocketsInTheOrderOfEach) {
  Listener ears;
  const Voice speaker;
  const std::uint16_t one = ears.open("one ");
  const std::uint16_t other = ears.open("other ");
  for (int i = 0; i < 20; ++i) speaker.say(one, std::to_string(i));
  ASSERT_TRUE(ears.heard.wait_for_count(20));
  for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(ears.heard.all()[i], "one " + std::to_string(i));
  speaker.say(other, "x");
  EXPECT_TRUE(ears.heard.wait_for_one([](const auto& text) { return text == "other x"; }));
  EXPECT_EQ(ears.sender, speaker.port());
}

TEST(ReceiveThread, APortIsTakenOnce) {
  Listener ears;
  const std::uint16_t port = ears.open("");
  EXPECT_TRUE(ears.thread.is_open(port));
  EXPECT_FALSE(ears.thread.open({.ip = kThisMachine, .port = port}, [](const auto&) {}));
  ears.thread.close(port);
  EXPECT_FALSE(ears.thread.is_open(port));
  EXPECT_TRUE(ears.thread.open({.ip = kThisMachine, .port = port}, [](const auto&) {}));
}

TEST(ReceiveThread, NothingIsHeardOfAPortThatWasClosed) {
  Listener ears;
  const Voice speaker;
  for (int round = 0; round < 50; ++round) {
    auto alive = std::make_shared<std::atomic<bool>>(true);
    const std::uint16_t port = unused_port();
    if (!ears.thread.open({.ip = kThisMachine, .port = port},
                          [alive](const auto&) { EXPECT_TRUE(*alive); }))
      continue;
    for (int i = 0; i < 20; ++i) speaker.say(port, "x");
    ears.thread.close(port);
    *alive = false;
  }
}

// A reader that receives a message has received all earlier ones to readers that have time.
TEST(ReceiveThread, WhatHasTimeIsHandedOnBeforeWhatWasSaidLater) {
  Listener ears;
  const Voice speaker;
  const std::uint16_t patient = ears.open("patient ", Haste::kSoon);
  const std::uint16_t urgent = ears.open("urgent ");
  for (int i = 0; i < 200; ++i) {
    speaker.say(patient, std::to_string(i));
    speaker.say(urgent, std::to_string(i));
    ASSERT_TRUE(ears.heard.wait_for_one(
        [&](const auto& text) { return text == "urgent " + std::to_string(i); }));
    const auto all = ears.heard.all();
    const auto place = [&](const std::string& text) { return std::ranges::find(all, text); };
    ASSERT_LT(place("patient " + std::to_string(i)), place("urgent " + std::to_string(i)));
  }
}

TEST(ReceiveThread, WhatHasTimeComesByItself) {
  Listener ears;
  const Voice speaker;
  const std::uint16_t patient = ears.open("", Haste::kSoon);
  // So many that it stops being woken by each.
  for (std::size_t i = 1; i <= 100; ++i) {
    speaker.say(patient, "x");
    if (i % 2 == 0) {
      ASSERT_TRUE(ears.heard.wait_for_count(i));
    }
  }
  EXPECT_THAT(ears.heard.all(), SizeIs(100));
}

// It is as with those that always have time: datagrams there are handed on first.
TEST(ReceiveThread, OneHasTimeWhileNothingElseComesThere) {
  Listener ears;
  const Voice speaker;
  const auto has_time = [](std::span<const std::uint8_t> bytes) { return bytes[0] == 'c'; };
  const std::uint16_t calm = ears.open("", Haste::kNow, has_time);
  std::binary_semaphore is_inside(0), may_go_on(0);
  const std::uint16_t urgent = unused_port();
  ASSERT_TRUE(ears.thread.open({.ip = kThisMachine, .port = urgent}, [&](const auto& datagram) {
    const std::string text(datagram.bytes.begin(), datagram.bytes.end());
    ears.heard.add(text);
    if (text != "wait") return;
    is_inside.release();
    may_go_on.acquire();
  }));
  // The one of two datagrams, both sent while the thread was busy, that arrives first.
  const auto heard_first = [&] {
    const std::size_t before = ears.heard.all().size();
    speaker.say(urgent, "wait");
    is_inside.acquire();
    speaker.say(urgent, "urgent");
    speaker.say(calm, "calm");
    may_go_on.release();
    EXPECT_TRUE(ears.heard.wait_for_count(before + 3));
    return ears.heard.all()[before + 1];
  };
  EXPECT_EQ(heard_first(), "urgent") << "the kind of its datagrams is not known yet";
  std::this_thread::sleep_for(ReceiveThread::kCalm);
  (void)heard_first();
  EXPECT_EQ(heard_first(), "calm");
  speaker.say(calm, "alarm");
  ASSERT_TRUE(ears.heard.wait_for_one([](const auto& text) { return text == "alarm"; }));
  (void)heard_first();
  EXPECT_EQ(heard_first(), "urgent");
}

TEST(ReceiveThread, ItIsKnownWhenWhatHasTimeCame) {
  constexpr auto kMuchLater = std::chrono::milliseconds(5);
  EventLog<SystemTime> received;
  std::atomic<bool> was_late = false;  // handed on
  const auto hears = [&](const ReceiveThread::Datagram& datagram) {
    const SystemTime now = std::chrono::system_clock::now();
    EXPECT_LE(datagram.received, now);
    was_late = was_late || now - datagram.received > kMuchLater;
    received.add(datagram.received);
  };
  ReceiveThread ears;
  const Voice speaker;
  std::uint16_t port = unused_port();
  while (!ears.open({.ip = kThisMachine, .port = port, .haste = Haste::kSoon}, hears))
    port = unused_port();
  const SystemTime begin = std::chrono::system_clock::now();
  // Until so much came that the thread looks from time to time only.
  for (const Time end = live_now() + kPatience; !was_late && live_now() < end;) {
    speaker.say(port, "x");
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_TRUE(was_late);
  for (const SystemTime each : received.all()) EXPECT_GE(each, begin);
}

// Two threads are sent the same that has time, of which one hurries.
TEST(ReceiveThread, AHurriedReaderReceivesAtOnceWhatHasTime) {
  constexpr int kRounds = 40;
  EventLog<std::string> heard;  // outlives the threads
  const Voice speaker;
  ReceiveThread patient;
  ReceiveThread hurried;
  const auto open = [&](ReceiveThread& thread, const std::string& name) {
    while (true) {
      const std::uint16_t port = unused_port();
      if (thread.open({.ip = kThisMachine, .port = port, .haste = Haste::kSoon},
                      [&heard, name](const auto&) { heard.add(name); }))
        return port;
    }
  };
  const std::uint16_t to_patient = open(patient, "patient");
  const std::uint16_t to_hurried = open(hurried, "hurried");
  std::size_t said = 0;
  const auto say_to_both = [&] {
    speaker.say(to_patient, "x");
    speaker.say(to_hurried, "x");
    said += 2;
    return heard.wait_for_count(said);
  };
  // Until both look from time to time only, and no more often than what comes makes them.
  for (const Time end = later(live_now(), std::chrono::milliseconds(2500)); live_now() < end;) {
    ASSERT_TRUE(say_to_both());
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  hurried.begin_hurry();
  const std::size_t before = said;
  for (int i = 0; i < kRounds; ++i) ASSERT_TRUE(say_to_both());
  hurried.end_hurry();
  const auto all = heard.all();
  int firsts = 0;
  for (std::size_t i = before; i < said; i += 2) firsts += all[i] == "hurried" ? 1 : 0;
  EXPECT_GE(firsts, kRounds * 3 / 4) << "by chance it would be half of them";
}

TEST(ReceiveThread, OnePortMayFloodAndAnotherIsHeard) {
  for (const Haste haste : {Haste::kSoon, Haste::kNow}) {
    for (const std::string text : {"x", ""}) {
      std::atomic<int> flood = 0;  // outlives the thread that counts
      Listener ears;
      const Voice speaker;
      const std::uint16_t flooded = unused_port();
      ASSERT_TRUE(ears.thread.open({.ip = kThisMachine, .port = flooded, .haste = haste},
                                   [&](const auto&) { ++flood; }));
      const std::uint16_t urgent = ears.open("");
      std::atomic<bool> stop = false;
      std::thread flooder([&] {
        const Voice other;
        while (!stop) other.say(flooded, text);
      });
      while (flood < 100) std::this_thread::yield();
      speaker.say(urgent, "x");
      EXPECT_TRUE(ears.heard.wait_for_count(1));
      stop = true;
      flooder.join();
    }
  }
}

// A socket whose callback stops at some datagrams until it is let go on.
struct HeldListener : Listener {
  std::uint16_t open_held(const std::string& name, const std::set<std::string>& stops) {
    while (true) {
      const std::uint16_t port = unused_port();
      if (thread.open({.ip = kThisMachine, .port = port},
                      [this, name, stops](const ReceiveThread::Datagram& datagram) {
                        const std::string text =
                            name + std::string(datagram.bytes.begin(), datagram.bytes.end());
                        heard.add(text);
                        if (stops.contains(text)) go_on.acquire();
                      }))
        return port;
    }
  }
  std::size_t bytes_in_sockets() const {
    int all = 0;
    thread.look_at_sockets([&](std::span<const int> descriptors) {
      for (const int each : descriptors) {
        int bytes = 0;
        EXPECT_EQ(ioctl(each, FIONREAD, &bytes), 0);
        all += bytes;
      }
    });
    return static_cast<std::size_t>(all);
  }

  std::counting_semaphore<> go_on{0};
};

TEST(ReceiveThread, AllThatLiesInASocketIsTakenBeforeItsTurnComes) {
  HeldListener ears;
  const Voice speaker;
  const std::uint16_t port = ears.open_held("", {"0", "1"});
  speaker.say(port, "0");
  EXPECT_TRUE(ears.heard.wait_for_count(1));
  for (int i = 1; i <= 40; ++i) speaker.say(port, std::to_string(i));
  EXPECT_GT(ears.bytes_in_sockets(), 0u);
  ears.go_on.release();
  EXPECT_TRUE(ears.heard.wait_for_count(2));
  EXPECT_EQ(ears.bytes_in_sockets(), 0u) << "there is room for what comes now";
  speaker.say(port, "41");
  ears.go_on.release();
  ASSERT_TRUE(ears.heard.wait_for_count(42));
  for (std::size_t i = 0; i < 42; ++i) EXPECT_EQ(ears.heard.all()[i], std::to_string(i));
}

// More than any buffer of a socket holds.
TEST(ReceiveThread, CountsWhatItsFullSocketsDropped) {
  HeldListener ears;
  const Voice speaker;
  const std::uint16_t port = ears.open_held("", {"0"});
  speaker.say(port, "0");
  EXPECT_TRUE(ears.heard.wait_for_count(1));
  constexpr std::size_t kSent = 2000;
  const std::string large(8000, 'x');
  for (std::size_t i = 0; i < kSent; ++i) speaker.say(port, large);
  EXPECT_EQ(ears.thread.dropped(), 0u) << "no datagram after them has been handed on";
  ears.go_on.release();
  EXPECT_TRUE(ears.heard.wait_for_count(2));
  while (ears.bytes_in_sockets() > 0) std::this_thread::yield();
  speaker.say(port, "end");
  ASSERT_TRUE(ears.heard.wait_for_one([](const auto& text) { return text == "end"; }));
  const std::size_t received = ears.heard.all().size() - 2;  // without "0" and "end"
  EXPECT_LT(received, kSent);
  EXPECT_EQ(ears.thread.dropped(), kSent - received);
}

TEST(ReceiveThread, WhatWasKeptLeavesOthersTheirTurn) {
  HeldListener ears;
  const Voice speaker;
  const std::uint16_t flooded = ears.open_held("flood ", {"flood 0"});
  const std::uint16_t other = ears.open("other ");
  speaker.say(flooded, "0");
  EXPECT_TRUE(ears.heard.wait_for_count(1));
  for (int i = 1; i <= 100; ++i) speaker.say(flooded, std::to_string(i));
  for (int i = 0; i < 20; ++i) speaker.say(other, std::to_string(i));
  ears.go_on.release();
  ASSERT_TRUE(ears.heard.wait_for_count(121));
  const auto all = ears.heard.all();
  const auto place = [&](const std::string& text) {
    return static_cast<std::size_t>(std::ranges::find(all, text) - all.begin());
  };
  EXPECT_LE(place("other 0"), 1 + ReceiveThread::kBatch);
  EXPECT_LE(place("other 19"), 1 + 20 + 20 + ReceiveThread::kBatch);
  for (int i = 1; i <= 100; ++i) {
    EXPECT_LT(place("flood " + std::to_string(i - 1)), place("flood " + std::to_string(i)));
  }
}

TEST(ReceiveThread, WhatIsTooLongIsCut) {
  Listener ears;
  const Voice speaker;
  const std::uint16_t port = unused_port();
  EventLog<std::size_t> sizes;
  ASSERT_TRUE(ears.thread.open(
      {.ip = kThisMachine, .port = port, .largest = 100},
      [&](const ReceiveThread::Datagram& datagram) { sizes.add(datagram.bytes.size()); }));
  for (const std::size_t size : {99u, 100u, 60'000u}) speaker.say(port, std::string(size, 'x'));
  ASSERT_TRUE(sizes.wait_for_count(3));
  EXPECT_THAT(sizes.all(), ElementsAre(99, 100, 100));
}

TEST(ReceiveThread, GroupsAreHeard) {
  Listener ears;
  const Voice speaker;
  in_addr group{};
  inet_pton(AF_INET, "239.255.0.77", &group);
  const std::uint16_t port = unused_port();
  ASSERT_TRUE(ears.thread.open({.ip = group, .port = port, .is_shared = true},
                               [&](const auto&) { ears.heard.add("x"); }));
  for (int twice = 0; twice < 2; ++twice) ears.thread.join(port, group, kThisMachine);
  const int descriptor = socket(AF_INET, SOCK_DGRAM, 0);
  setsockopt(descriptor, IPPROTO_IP, IP_MULTICAST_IF, &kThisMachine, sizeof kThisMachine);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_addr = group;
  to.sin_port = htons(port);
  sendto(descriptor, "x", 1, 0, reinterpret_cast<sockaddr*>(&to), sizeof to);
  EXPECT_TRUE(ears.heard.wait_for_count(1));
  close(descriptor);
}

}  // namespace
}  // namespace culprit::rtps
