#include "rtps/datagram_filter.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "rtps/test_datagram.h"

namespace culprit::rtps {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t kAbsurd = std::int64_t{1} << 60;

Guid writer_of_kind(std::uint8_t kind, std::uint8_t participant = 1) {
  Guid guid;
  guid.bytes[0] = 1;
  guid.bytes[11] = participant;
  guid.bytes[14] = 1;
  guid.bytes[15] = kind;
  return guid;
}
const Guid kCamera = writer_of_kind(0x03);
Guid builtin_writer(std::uint16_t number, std::uint8_t participant = 1) {
  Guid guid = writer_of_kind(0xc2, participant);
  guid.bytes[13] = static_cast<std::uint8_t>(number >> 8);
  guid.bytes[14] = static_cast<std::uint8_t>(number);
  return guid;
}
const Guid kDiscovery = builtin_writer(3);  // announces writers
const Guid kService = writer_of_kind(0x03, 2);

// One of ours.
Guid reader(std::uint8_t number) {
  Guid guid;
  guid.bytes[0] = 9;
  guid.bytes[14] = number;
  guid.bytes[15] = 0x04;
  return guid;
}
const Guid kPictures = reader(1);
const Guid kReplies = reader(2);

class Filter : public testing::Test {
 protected:
  Filter() {
    filter.begin_hearing(kCamera, kPictures, DatagramFilter::Reading::kBestEffort);
    filter.begin_hearing(kService, kReplies, DatagramFilter::Reading::kReliable);
    filter.know(kDiscovery.prefix());
  }

  TestDatagram from(const Guid& guid) const { return TestDatagram(guid.prefix()); }
  // How many bytes of it are passed on; 0: none.
  std::size_t pass(const TestDatagram& datagram) { return pass(datagram.bytes()); }
  std::size_t pass(Bytes bytes) {
    buffer = std::move(bytes);
    passed = filter.pass(buffer, now, kReceived);
    return passed.size();
  }
  // The addressee of the submessage at `position` of the passed datagram: an entity's number.
  int addressee(std::size_t position) const {
    const bool is_sample = passed[position] == 0x15 || passed[position] == 0x16;
    return passed[position + 4 + (is_sample ? 4 : 0) + 2];
  }
  // Whether it is passed on as it is.
  bool passes(const TestDatagram& datagram) {
    const auto before = filter.refused().count;
    return pass(datagram) == datagram.bytes().size() && filter.refused().count == before;
  }

  static constexpr SystemTime kReceived{std::chrono::seconds(7)};

  DatagramFilter filter;
  DatagramFilter::Clock::time_point now{};
  Bytes buffer;
  ByteView passed;
};

TEST_F(Filter, PassesOnWhatParticipantsSend) {
  for (const Guid& guid : {kCamera, kDiscovery, kService}) {
    EXPECT_TRUE(passes(from(guid).data(guid, 1).heartbeat(guid, 1, 1)));
    EXPECT_TRUE(passes(from(guid).heartbeat(guid, 2, 5).gap(guid, 2, 5)));
    EXPECT_TRUE(passes(from(guid).heartbeat(guid, 1, 0))) << "nothing was written yet";
    EXPECT_TRUE(
        passes(from(guid).fragment(guid, 6, 1, 1000, 1500).fragment(guid, 6, 2, 1000, 1500)));
  }
}

TEST_F(Filter, DropsWhatIsNoMessage) {
  EXPECT_TRUE(pass(Bytes{}) == 0);
  EXPECT_TRUE(pass(Bytes(19, 'R')) == 0);
  EXPECT_TRUE(pass(Bytes(100, 'R')) == 0);
  EXPECT_EQ(filter.refused().count, 3u);
}

// A sample and the heartbeat behind it come in one datagram: the sample arrives all the same.
TEST_F(Filter, TakesOutTheSubmessageAndNotTheRest) {
  EXPECT_EQ(
      pass(from(kCamera).data(kCamera, 1).heartbeat(kCamera, 1, kAbsurd).data(kCamera, 2)),
      from(kCamera).data(kCamera, 1).heartbeat(kCamera, 1, 1).data(kCamera, 2).bytes().size());
  EXPECT_EQ(passed[20], 0x15);
  EXPECT_EQ(passed[20 + 32], 0x01) << "padding";
  EXPECT_EQ(passed[20 + 32 + 32], 0x15);
}

TEST_F(Filter, RefusesAbsurdSequenceNumbers) {
  for (const Guid& guid : {kCamera, kDiscovery, kService}) {
    EXPECT_FALSE(passes(from(guid).gap(guid, 1, kAbsurd))) << "nothing is known of it";
    EXPECT_FALSE(passes(from(guid).heartbeat(guid, kAbsurd, kAbsurd)));
    EXPECT_FALSE(passes(from(guid).data(guid, kAbsurd)));
    EXPECT_TRUE(passes(from(guid).data(guid, 10)));
    EXPECT_FALSE(passes(from(guid).gap(guid, 1, kAbsurd)));
    EXPECT_FALSE(passes(from(guid).gap(guid, 1, 1000)));
    EXPECT_FALSE(passes(from(guid).heartbeat(guid, 1, 1000)));
    EXPECT_FALSE(passes(from(guid).heartbeat(guid, 5, 3)));
    EXPECT_FALSE(passes(from(guid).data(guid, 1000)));
    EXPECT_FALSE(passes(from(guid).fragment(guid, 1000, 1, 1000, 1500)));
    EXPECT_FALSE(passes(from(guid).data(guid, 0)));
    EXPECT_FALSE(passes(from(guid).data(guid, -7)));
    EXPECT_TRUE(passes(from(guid).data(guid, 11)));
  }
}

TEST_F(Filter, AWriterThatWasNotHeardForLongMayBeFarAhead) {
  EXPECT_TRUE(passes(from(kCamera).data(kCamera, 10)));
  now += 1h;
  EXPECT_TRUE(passes(from(kCamera).data(kCamera, 10 + 3600 * 1000))) << "1 kHz behind a cut cable";
}

TEST_F(Filter, AWriterThatHasWrittenForYearsIsHeard) {
  EXPECT_TRUE(passes(from(kCamera).data(kCamera, 300'000'000'000)));
}

TEST_F(Filter, RefusesDamagedSubmessages) {
  for (const int kind : {0x06, 0x07, 0x08, 0x0c, 0x0e, 0x12, 0x13, 0x15, 0x16}) {
    const auto datagram = from(kCamera)
                              .submessage(static_cast<std::uint8_t>(kind), 0, Bytes(4))
                              .heartbeat(kCamera, 1, 1);
    EXPECT_FALSE(passes(datagram)) << kind;
  }
  const Bytes whole = from(kCamera).data(kCamera, 1).bytes();
  for (std::ptrdiff_t length = 21; length < std::ssize(whole); ++length) {
    EXPECT_EQ(pass(Bytes(whole.begin(), whole.begin() + length)), 0u) << length;
  }
}

TEST_F(Filter, BitmapsHaveAtMost256Bits) {
  Bytes body(20 + 4 + 400);
  body[16 + 3] = 1;  // base
  body[20] = 0xff, body[21] = 0xff;
  EXPECT_FALSE(passes(from(kCamera).submessage(0x06, 0, body)));
}

TEST_F(Filter, WhatFragmentsTakeIsBounded) {
  std::size_t came = 0;
  for (std::int64_t sequence = 1; sequence <= 600; ++sequence)
    came += passes(from(kDiscovery).fragment(kDiscovery, sequence, 1, 1000, 1'000'000)) ? 1 : 0;
  EXPECT_EQ(came, WriterRecords::kReliableOfOne / 1'000'000);
  EXPECT_TRUE(passes(from(kDiscovery).data(kDiscovery, came + 1))) << "it still passes";
  for (std::uint8_t participant = 3; participant < 200; ++participant) {
    const Guid other = builtin_writer(3, participant);
    filter.know(other.prefix());
    came += passes(from(other).fragment(other, 1, 1, 1000, 3'000'000)) ? 3 : 0;
  }
  EXPECT_LE(came, WriterRecords::kReliableOfAll / 1'000'000);
}

TEST_F(Filter, ManySmallSamplesInFragmentsAreBounded) {
  std::size_t came = 0;
  for (std::int64_t number = 1; number <= 20'000; ++number)
    came += passes(from(kService).fragment(kService, number, 1, 1, 2)) ? 1 : 0;
  EXPECT_LE(came, WriterRecords::kReliableOfOne / 512);
}

TEST_F(Filter, KeepsNothingOfWritersThatTheMiddlewareDoesNotRead) {
  for (std::uint16_t number = 1; number <= 1000; ++number)
    pass(from(kDiscovery).heartbeat(builtin_writer(number), 1, 5));
  EXPECT_EQ(filter.known_writers(), 5U) << "participants, topics, writers, readers, liveliness";
}

TEST_F(Filter, WhatIsCompleteOrGivenUpIsFreeAgain) {
  for (std::int64_t sequence = 1; sequence <= 100; ++sequence) {
    for (const std::uint32_t number : {1u, 3u, 2u}) {
      EXPECT_TRUE(passes(from(kService).fragment(kService, sequence, number, 50'000, 150'000)));
    }
  }
  for (std::int64_t sequence = 101; sequence <= 200; ++sequence) {
    EXPECT_TRUE(passes(from(kService).fragment(kService, sequence, 1, 50'000, 3'000'000)));
    EXPECT_TRUE(passes(from(kService).heartbeat(kService, sequence + 1, sequence)));
  }
  EXPECT_TRUE(passes(from(kService).fragment(kService, 201, 1, 50'000, 3'000'000)));
  EXPECT_FALSE(passes(from(kService).fragment(kService, 202, 1, 50'000, 3'000'000)));
  filter.forget(kService.prefix());
  filter.begin_hearing(kService, kReplies, DatagramFilter::Reading::kReliable);
  EXPECT_TRUE(passes(from(kService).fragment(kService, 1, 1, 50'000, 3'000'000)));
}

// Most fragments of a big topic may be lost on the way.
TEST_F(Filter, ALossyCameraIsNeverTooMuch) {
  for (std::int64_t sequence = 1; sequence <= 10'000; ++sequence)
    EXPECT_TRUE(
        passes(from(kCamera).fragment(kCamera, sequence, 1 + sequence % 90, 60'000, 6'000'000)));
  EXPECT_FALSE(passes(from(kCamera).fragment(kCamera, 10'001, 1, 65'000, 1'000'000'000)));
}

TEST_F(Filter, AllCamerasTogetherAreBounded) {
  int came = 0;
  for (std::uint8_t participant = 3; participant < 100; ++participant) {
    const Guid camera = writer_of_kind(0x03, participant);
    filter.begin_hearing(camera, kPictures, DatagramFilter::Reading::kBestEffort);
    came += passes(from(camera).fragment(camera, 1, 1, 60'000, 6'000'000)) ? 1 : 0;
  }
  EXPECT_EQ(came, 5);
}

// It only seems silent to us: too large, or lost in part, or behind a forged number.
TEST_F(Filter, AWriterWhoseSamplesAreNotDeliveredIsNotSilent) {
  int signs = 0;
  const Guid lidar = writer_of_kind(0x03, 9);
  filter.begin_hearing(lidar, kPictures, DatagramFilter::Reading::kBestEffort,
                       std::make_shared<const std::function<void()>>([&] { ++signs; }));
  for (std::int64_t sequence = 1; sequence <= 10; ++sequence) {
    pass(from(lidar).data(lidar, sequence));
    filter.delivered(lidar);
  }
  EXPECT_EQ(signs, 0);
  for (std::int64_t sequence = 11; sequence <= 20; ++sequence) {
    pass(from(lidar).fragment(lidar, sequence, 1, 60'000, 500'000'000));
    pass(from(lidar).fragment(lidar, sequence, 2, 60'000, 500'000'000));
  }
  EXPECT_EQ(signs, 10 - DatagramFilter::kUnheard);
}

// Else strangers could use the budget up.
TEST_F(Filter, WritersThatNobodyHearsTakeNothing) {
  for (std::uint8_t participant = 3; participant < 200; ++participant) {
    const Guid stranger = writer_of_kind(participant % 2 == 0 ? 0x03 : 0xc2, participant);
    EXPECT_TRUE(passes(from(stranger).fragment(stranger, 1, 1, 60'000, 3'000'000)));
  }
  EXPECT_TRUE(passes(from(kCamera).fragment(kCamera, 1, 1, 60'000, 30'000'000)));
  EXPECT_TRUE(passes(from(kDiscovery).fragment(kDiscovery, 1, 1, 60'000, 4'000'000)));
}

TEST_F(Filter, AWriterThatIsHeardNoMoreFreesWhatItTook) {
  const Guid other = writer_of_kind(0x03, 9);
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(passes(from(kCamera).fragment(kCamera, 1, 1, 60'000, 30'000'000)));
    filter.end_hearing(kCamera, kPictures);
    filter.begin_hearing(other, kPictures, DatagramFilter::Reading::kBestEffort);
    EXPECT_TRUE(passes(from(other).fragment(other, 1, 1, 60'000, 30'000'000)));
    filter.end_hearing(other, kPictures);
    filter.begin_hearing(kCamera, kPictures, DatagramFilter::Reading::kBestEffort);
  }
}

TEST_F(Filter, FragmentsMustNotContradictOneAnother) {
  EXPECT_TRUE(passes(from(kCamera).fragment(kCamera, 1, 1, 1000, 5000)));
  EXPECT_FALSE(passes(from(kCamera).fragment(kCamera, 1, 2, 500, 5000)));
  EXPECT_FALSE(passes(from(kCamera).fragment(kCamera, 1, 2, 1000, 9000)));
  EXPECT_FALSE(passes(from(kCamera).fragment(kCamera, 1, 6, 1000, 5000))) << "beyond the end";
  EXPECT_FALSE(passes(from(kCamera).fragment(kCamera, 1, 0, 1000, 5000)));
  EXPECT_FALSE(passes(from(kCamera).fragment(kCamera, 2, 1, 0, 5000)));
  EXPECT_TRUE(passes(from(kCamera).fragment(kCamera, 1, 2, 1000, 5000)));
}

TEST_F(Filter, WritersAreKnownByTheirSource) {
  EXPECT_TRUE(passes(from(kCamera).data(kCamera, 10)));
  Bytes source(20);
  std::copy_n(kService.bytes.begin(), 12, source.begin() + 8);
  // The second sample is another participant's.
  const auto datagram = from(kCamera).submessage(0x0c, 0, source).data(kService, 1000);
  EXPECT_TRUE(passes(datagram));
}

// Fast DDS would take the first as the key of whatever it names, and would find the parameters of the second elsewhere.
TEST_F(Filter, WhatTheMiddlewareWouldReadOtherwiseIsRefused) {
  using Content = TestDatagram::Content;
  const Bytes ends = TestParameters().add(0x71, Bytes{0, 0, 0, 3}).end();
  const Bytes key(kCamera.bytes.begin(), kCamera.bytes.end());
  EXPECT_FALSE(passes(from(kDiscovery).end_of(kDiscovery, 1, ends, Content::kKey, key)));
  EXPECT_FALSE(passes(from(kDiscovery).end_of(kDiscovery, 1, ends, Content::kKey, {1, 15, 0, 0})));
  Bytes list{0, 3, 0, 0};
  const Bytes named = TestParameters().endpoint(kCamera).end();
  list.insert(list.end(), named.begin(), named.end());
  EXPECT_TRUE(passes(from(kDiscovery).end_of(kDiscovery, 1, ends, Content::kKey, list)));
  constexpr std::uint16_t kNegative = 0x8000;
  Bytes far = TestParameters().add(0x70, key).add(0x71, Bytes{0, 0, 0, 3}).end();
  far.resize(kNegative, 0);
  far.insert(far.end(), {1, 0, 0, 0});
  EXPECT_FALSE(passes(from(kDiscovery).end_of(kDiscovery, 2, far, Content::kNone, {}, kNegative)));
}

// ---- which reader receives which writer

TEST_F(Filter, WhatOneReaderHearsIsAddressedToIt) {
  filter.begin_to_address();
  EXPECT_TRUE(passes(from(kCamera).data(kCamera, 1)));
  EXPECT_EQ(addressee(20), 1);
  EXPECT_TRUE(passes(from(kCamera).fragment(kCamera, 2, 1, 1000, 1500)));
  EXPECT_EQ(addressee(20), 1);
  EXPECT_TRUE(passes(from(kService).heartbeat(kService, 1, 1).gap(kService, 1, 2)));
  EXPECT_EQ(addressee(20), 2);
  EXPECT_EQ(addressee(20 + 32), 2);
}

TEST_F(Filter, WhatSeveralReadersHearIsAddressedToAll) {
  filter.begin_to_address();
  filter.begin_hearing(kCamera, kReplies, DatagramFilter::Reading::kReliable);
  EXPECT_TRUE(passes(from(kCamera).data(kCamera, 1).heartbeat(kCamera, 1, 1)));
  EXPECT_EQ(addressee(20), 0);
  EXPECT_EQ(addressee(20 + 32), 2) << "heartbeats are for those that are reliable";
  filter.end_hearing(kCamera, kPictures);
  EXPECT_TRUE(passes(from(kCamera).data(kCamera, 2)));
  EXPECT_EQ(addressee(20), 2);
}

TEST_F(Filter, OfAWriterThatNobodyHearsMostIsTakenOut) {
  filter.begin_to_address();
  const Guid stranger = writer_of_kind(0x03, 9);
  int passed_on = 0;
  for (std::int64_t second = 0; second < 3; ++second, now += 1s) {
    for (std::int64_t i = 1; i <= 100; ++i)
      passed_on += pass(from(stranger).data(stranger, 100 * second + i)) > 0 ? 1 : 0;
  }
  EXPECT_EQ(passed_on, 3 * DatagramFilter::kTries);
  EXPECT_EQ(filter.refused().count, 0u) << "nothing is wrong with it";
  EXPECT_EQ(pass(from(stranger).data(stranger, 1)),
            from(stranger).data(stranger, 1).bytes().size());
  filter.begin_hearing(stranger, kPictures, DatagramFilter::Reading::kBestEffort);
  for (std::int64_t i = 2; i <= 100; ++i) EXPECT_TRUE(passes(from(stranger).data(stranger, i)));
}

TEST_F(Filter, WhatNoReaderHearsIsTakenOut) {
  filter.begin_to_address();
  EXPECT_EQ(pass(from(kCamera).heartbeat(kCamera, 1, 1)), 0u) << "its reader is best effort";
  EXPECT_EQ(filter.refused().count, 0u);
  Bytes source(20);
  std::copy_n(kService.bytes.begin(), 12, source.begin() + 8);
  const auto mixed =
      from(kCamera).heartbeat(kCamera, 1, 1).submessage(0x0c, 0, source).data(kService, 2).bytes();
  EXPECT_EQ(pass(mixed), mixed.size());
  EXPECT_EQ(passed[20], 0x01) << "padding";
  EXPECT_EQ(addressee(20 + 32 + 24), 2);
}

TEST_F(Filter, WhatIsAddressedToSomebodyStays) {
  filter.begin_to_address();
  Bytes bytes = from(kCamera).data(kCamera, 1).bytes();
  bytes[20 + 8 + 2] = 7;
  EXPECT_EQ(pass(bytes), bytes.size());
  EXPECT_EQ(addressee(20), 7);
}

TEST_F(Filter, DiscoveryIsHeardByTheMiddleware) {
  filter.begin_to_address();
  for (const Guid& guid : {kDiscovery, writer_of_kind(0xc2, 9), writer_of_kind(0x43, 9)}) {
    EXPECT_TRUE(passes(from(guid).data(guid, 1).heartbeat(guid, 1, 1)));
    EXPECT_EQ(addressee(20), 0);
  }
}

TEST_F(Filter, NothingIsAddressedWhileReadersChange) {
  const Guid stranger = writer_of_kind(0x03, 9);
  EXPECT_TRUE(passes(from(stranger).data(stranger, 1))) << "not yet";
  filter.begin_to_address();
  {
    const DatagramFilter::Change change(filter);
    EXPECT_TRUE(passes(from(stranger).data(stranger, 1)));
    EXPECT_TRUE(passes(from(kCamera).data(kCamera, 1)));
    EXPECT_EQ(addressee(20), 0);
  }
  EXPECT_TRUE(passes(from(kCamera).data(kCamera, 2)));
  EXPECT_EQ(addressee(20), 1);
}

// A last submessage may have no length of its own: the submessages before it are passed on.
TEST_F(Filter, TheLastSubmessageCanBeForNobody) {
  filter.begin_to_address();
  Bytes bytes = from(kCamera).data(kCamera, 1).heartbeat(kCamera, 1, 1).bytes();
  bytes[20 + 32 + 2] = 0;
  EXPECT_EQ(pass(bytes), 20u + 32u);
}

// One reader has time, and is handed what is plain.
class HandingFilter : public Filter {
 protected:
  HandingFilter() {
    filter.begin_hearing(kScan, kScans, DatagramFilter::Reading::kBestEffort, {},
                         std::make_shared<const std::function<void(const DatagramFilter::Whole&)>>(
                             [this](const DatagramFilter::Whole& sample) {
                               EXPECT_EQ(sample.writer, kScan);
                               handed.push_back(sample.sequence);
                               sent = sample.sent;
                               received = sample.received;
                               payload.assign(sample.payload.begin(), sample.payload.end());
                             }));
    filter.begin_to_address();
  }
  // At 5.5 s.
  TestDatagram timed() const { return from(kScan).submessage(0x09, 0, kTime); }

  const Bytes kTime{5, 0, 0, 0, 0, 0, 0, 0x80};
  const Guid kScan = writer_of_kind(0x03, 4);
  const Guid kScans = reader(3);
  std::vector<std::int64_t> handed;
  SystemTime sent;
  SystemTime received;
  Bytes payload;
};

TEST_F(HandingFilter, WhatIsPlainIsHandedOverAndTheMiddlewareNeverSeesIt) {
  EXPECT_EQ(pass(timed().data(kScan, 7)), 0u);
  EXPECT_EQ(handed, std::vector<std::int64_t>{7});
  EXPECT_EQ(sent.time_since_epoch(), 5500ms);
  EXPECT_EQ(received, kReceived);
  EXPECT_EQ(payload, (Bytes{0, 1, 0, 0, 7, 0, 0, 0}));
  EXPECT_EQ(filter.refused().count, 0u);
}

TEST_F(HandingFilter, WhatElseIsInTheDatagramIsPassedOn) {
  const auto mixed = timed().data(kScan, 1).data(kCamera, 1).bytes();
  EXPECT_EQ(pass(timed()
                     .data(kScan, 1)
                     .submessage(0x0c, 0,
                                 [] {
                                   Bytes source(20);
                                   std::copy_n(kCamera.bytes.begin(), 12, source.begin() + 8);
                                   return source;
                                 }())
                     .data(kCamera, 1)),
            mixed.size() + 24);
  EXPECT_EQ(handed.size(), 1u);
}

TEST_F(HandingFilter, EachIsHandedOverOnceAndNoneThatIsOlder) {
  for (const std::int64_t number : {1, 2, 2, 5, 3, 6})
    EXPECT_EQ(pass(timed().data(kScan, number)), 0u);
  EXPECT_EQ(handed, (std::vector<std::int64_t>{1, 2, 5, 6}));
}

TEST_F(HandingFilter, WhatIsNotPlainIsLeftToTheMiddleware) {
  EXPECT_GT(pass(from(kScan).data(kScan, 1)), 0u) << "without a time";
  EXPECT_GT(pass(from(kScan).submessage(0x09, 2, {}).data(kScan, 2)), 0u) << "its time is invalid";
  EXPECT_GT(pass(timed().fragment(kScan, 3, 1, 1000, 1500)), 0u);
  Bytes disposed = timed().data(kScan, 4).bytes();
  disposed[20 + 12 + 1] = 1 | 8;
  EXPECT_GT(pass(disposed), 0u) << "a key";
  {
    const DatagramFilter::Change change(filter);
    EXPECT_GT(pass(timed().data(kScan, 5)), 0u) << "readers change";
  }
  EXPECT_TRUE(handed.empty());
}

TEST_F(HandingFilter, WhatIsForAnotherParticipantIsNotHandedOver) {
  Bytes other(12, 3);
  EXPECT_GT(pass(timed().submessage(0x0e, 0, other).data(kScan, 1)), 0u);
  EXPECT_TRUE(handed.empty());
  Bytes own(kScans.bytes.begin(), kScans.bytes.begin() + 12);
  EXPECT_EQ(pass(timed().submessage(0x0e, 0, own).data(kScan, 1)), 0u);
  EXPECT_EQ(handed.size(), 1u);
}

TEST_F(HandingFilter, WhatASecondReaderHearsIsLeftToTheMiddleware) {
  filter.begin_hearing(kScan, kPictures, DatagramFilter::Reading::kBestEffort);
  EXPECT_GT(pass(timed().data(kScan, 1)), 0u);
  EXPECT_TRUE(handed.empty());
  filter.end_hearing(kScan, kPictures);
  EXPECT_EQ(pass(timed().data(kScan, 2)), 0u);
  filter.end_hearing(kScan, kScans);
  (void)pass(timed().data(kScan, 3));
  EXPECT_EQ(handed, std::vector<std::int64_t>{2}) << "it receives no more";
}

// A forged number made its reader deaf to it.
TEST_F(HandingFilter, AWriterWhoseSamplesArePassedOverIsNotSilent) {
  const Guid forged = writer_of_kind(0x03, 5);
  int told = 0;
  filter.begin_hearing(forged, kScans, DatagramFilter::Reading::kBestEffort,
                       std::make_shared<const std::function<void()>>([&told] { ++told; }),
                       std::make_shared<const std::function<void(const DatagramFilter::Whole&)>>(
                           [](const DatagramFilter::Whole&) {}));
  const auto say = [&](std::int64_t number) {
    (void)pass(from(forged).submessage(0x09, 0, kTime).data(forged, number));
  };
  say(1);
  say(200);
  for (std::int64_t number = 2; number < 2 + DatagramFilter::kUnheard; ++number) say(number);
  EXPECT_EQ(told, 0);
  say(20);
  EXPECT_EQ(told, 1);
}

TEST_F(HandingFilter, AnAbsurdNumberIsNotHandedOver) {
  EXPECT_EQ(pass(timed().data(kScan, 1)), 0u);
  (void)pass(timed().data(kScan, kAbsurd));
  EXPECT_EQ(handed, std::vector<std::int64_t>{1});
  EXPECT_EQ(filter.refused().count, 1u);
}

// ---- what is never met

class DiscoveringFilter : public Filter {
 protected:
  DiscoveringFilter() {
    filter.discover(
        reader(0).prefix(),
        [](std::string_view topic, EndpointRole) { return topic.starts_with("never"); },
        [this](const EndpointNews& news) {
          if (const auto* info = std::get_if<EndpointInfo>(&news)) {
            told.push_back("+" + info->topic);
            last = *info;
          } else {
            told.push_back("-" + std::to_string(std::get<EndpointGone>(news).guid.bytes[14]));
          }
        });
    filter.begin_to_address();
  }

  static Guid announcer(EndpointRole role, std::uint8_t participant = 1) {
    Guid guid = writer_of_kind(0xc2, participant);
    guid.bytes[14] = role == EndpointRole::kReader ? 4 : 3;
    return guid;
  }
  static Guid endpoint(std::uint8_t number, std::uint8_t kind = 0x03) {
    Guid guid = writer_of_kind(kind);
    guid.bytes[14] = number;
    return guid;
  }
  static Bytes said(const Guid& endpoint, std::string_view topic) {
    return TestParameters().endpoint(endpoint).add(0x05, topic).add(0x07, "T").end();
  }
  TestDatagram announced(std::int64_t sequence, std::uint8_t number, std::string_view topic) const {
    return from(kWriters).announcement(kWriters, sequence, said(endpoint(number), topic));
  }
  // For each gap that is passed on: its beginning, and the number that follows it.
  std::vector<std::pair<int, int>> gaps() const {
    std::vector<std::pair<int, int>> all;
    std::size_t at = 20;
    while (at < passed.size()) {
      if (passed[at] == 0x08) {
        EXPECT_EQ(passed[at + 2], 28) << "bytes";
        EXPECT_EQ(passed[at + 28], 0) << "no bitmap";
        all.emplace_back(passed[at + 16], passed[at + 24]);
      }
      at += 4u + (passed[at + 2] | passed[at + 3] << 8);
    }
    EXPECT_EQ(at, passed.size());
    return all;
  }

  const Guid kWriters = announcer(EndpointRole::kWriter);
  const Guid kReaders = announcer(EndpointRole::kReader);
  std::vector<std::string> told;
  EndpointInfo last;
};

using Told = std::vector<std::string>;
using Gaps = std::vector<std::pair<int, int>>;

TEST_F(DiscoveringFilter, WhatIsNeverMetIsToldHereAndIsAGapForTheMiddleware) {
  EXPECT_EQ(pass(announced(7, 1, "never")), 20u + 32u);
  EXPECT_EQ(gaps(), (Gaps{{7, 8}}));
  EXPECT_EQ(passed[20 + 10], 3) << "its writer";
  EXPECT_EQ(told, Told{"+never"});
  EXPECT_EQ(last.guid, endpoint(1));
  EXPECT_EQ(last.type, "T");
  EXPECT_EQ(filter.refused().count, 0u);
}

TEST_F(DiscoveringFilter, WhatMayBeMetIsTheMiddlewares) {
  EXPECT_TRUE(passes(announced(1, 1, "met")));
  EXPECT_EQ(passed[20], 0x15);
  EXPECT_TRUE(passes(from(kDiscovery).data(kDiscovery, 1))) << "no announcement of an endpoint";
  EXPECT_TRUE(told.empty());
}

TEST_F(DiscoveringFilter, WhatElseIsInTheDatagramStaysAsItIs) {
  auto datagram = announced(1, 1, "never");
  const std::size_t taken = datagram.bytes().size();
  datagram.announcement(kWriters, 2, said(endpoint(2), "met")).heartbeat(kWriters, 1, 2);
  EXPECT_EQ(pass(datagram), datagram.bytes().size());
  EXPECT_EQ(gaps(), (Gaps{{1, 2}}));
  EXPECT_EQ(passed[20 + 32], 0x01) << "padding";
  EXPECT_TRUE(std::ranges::equal(passed.subspan(taken), ByteView(datagram.bytes()).subspan(taken)));
}

TEST_F(DiscoveringFilter, SeveralInARowAreOneGap) {
  auto datagram = announced(1, 1, "never");
  datagram.announcement(kWriters, 2, said(endpoint(2), "never_2"))
      .announcement(kWriters, 4, said(endpoint(4), "never_4"))
      .announcement(kReaders, 5, said(endpoint(5, 0x04), "never_5"));
  pass(datagram);
  EXPECT_EQ(gaps(), (Gaps{{1, 3}, {4, 5}, {5, 6}}));
  EXPECT_EQ(told, (Told{"+never", "+never_2", "+never_4", "+never_5"}));
}

TEST_F(DiscoveringFilter, WhatIsSaidAgainIsAGapAgainAndNotTold) {
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(pass(announced(7, 1, "never")), 20u + 32u) << "the middleware may have missed it";
    EXPECT_EQ(gaps(), (Gaps{{7, 8}}));
  }
  EXPECT_EQ(told, Told{"+never"});
  pass(announced(9, 1, "never_more"));
  pass(announced(8, 1, "never"));  // came late
  EXPECT_EQ(told, (Told{"+never", "+never_more"}));
}

TEST_F(DiscoveringFilter, AnEndIsToldToBothAndIsFinal) {
  EXPECT_TRUE(passes(from(kWriters).farewell(kWriters, 1, endpoint(1)))) << "of nobody";
  pass(announced(2, 1, "never"));
  const auto farewell = from(kWriters).farewell(kWriters, 5, endpoint(1));
  EXPECT_TRUE(passes(farewell));
  EXPECT_TRUE(passes(farewell));
  pass(announced(2, 1, "never"));  // came late
  EXPECT_EQ(told, (Told{"+never", "-1"}));
  pass(announced(6, 1, "never"));
  EXPECT_EQ(told, (Told{"+never", "-1", "+never"}));
}

TEST_F(DiscoveringFilter, NobodySpeaksForAnotherParticipant) {
  const Guid other = announcer(EndpointRole::kWriter, 9);
  EXPECT_TRUE(passes(from(other).announcement(other, 1, said(endpoint(1), "never"))))
      << "its participant is unknown";
  filter.know(other.prefix());
  EXPECT_TRUE(passes(from(other).announcement(other, 2, said(endpoint(1), "never"))));
  const Guid self = reader(0);
  filter.know(self.prefix());
  Guid own = kWriters;
  std::ranges::copy(self.prefix().bytes, own.bytes.begin());
  EXPECT_TRUE(passes(from(own).announcement(own, 1, said(reader(1), "never"))));
  EXPECT_TRUE(told.empty());
}

TEST_F(DiscoveringFilter, WhatIsForAnotherParticipantIsLeftAlone) {
  const auto to = [&](const Bytes& prefix) {
    return from(kWriters)
        .submessage(0x0e, 0, prefix)
        .announcement(kWriters, 1, said(endpoint(1), "never"));
  };
  EXPECT_TRUE(passes(to(Bytes(12, 3))));
  EXPECT_TRUE(told.empty());
  const Guid self = reader(0);
  EXPECT_FALSE(passes(to(Bytes(self.bytes.begin(), self.bytes.begin() + 12))));
  EXPECT_EQ(told, Told{"+never"});
}

TEST_F(DiscoveringFilter, ASourceThatReturnsIsReportedAgain) {
  pass(announced(3, 1, "never"));
  filter.forget(kWriters.prefix());
  EXPECT_TRUE(passes(announced(3, 1, "never"))) << "it is not there";
  filter.know(kWriters.prefix());
  pass(announced(3, 1, "never"));
  EXPECT_EQ(told, (Told{"+never", "+never"}));
}

TEST_F(DiscoveringFilter, WhatCannotBeReadIsTheMiddlewares) {
  const Bytes whole = said(endpoint(1), "never");
  for (std::size_t length = 0; length < whole.size(); length += 4) {
    const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
    EXPECT_TRUE(passes(from(kWriters).announcement(kWriters, 1, part))) << length;
  }
  EXPECT_TRUE(passes(from(kReaders).announcement(kReaders, 1, whole))) << "a writer is no reader";
  EXPECT_TRUE(passes(from(kWriters).announcement(
      kWriters, 1, TestParameters().endpoint(endpoint(1)).add(0x05, "never").end())))
      << "it has no type";
  EXPECT_TRUE(told.empty());
}

// The network decides how many there are.
TEST_F(DiscoveringFilter, NoMoreAreKeptThanIsAllowed) {
  constexpr std::size_t kSequence = 20 + 20;  // where it is in the datagram, its lower half
  constexpr std::size_t kEndpoint = kSequence + 4 + 4 + 4 + 12;
  const Bytes one = announced(1, 0, "never").bytes();
  std::size_t taken = 0;
  for (std::size_t i = 0; i < DatagramFilter::kMostAnnounced + 10; ++i) {
    Bytes each = one;
    for (std::size_t byte = 0; byte < 3; ++byte) {
      each[kSequence + byte] = static_cast<std::uint8_t>((i + 1) >> (8 * byte));
      each[kEndpoint + byte] = static_cast<std::uint8_t>(i >> (8 * byte));
    }
    pass(std::move(each));
    taken += passed[20] == 0x08 ? 1 : 0;
  }
  EXPECT_EQ(taken, DatagramFilter::kMostAnnounced);
  EXPECT_EQ(told.size(), taken) << "the middleware reports the others";
}

}  // namespace
}  // namespace culprit::rtps
