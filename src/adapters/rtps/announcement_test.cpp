#include "rtps/announcement.h"

#include <gtest/gtest.h>

#include "rtps/test_datagram.h"

namespace culprit::rtps {
namespace {

using namespace std::chrono_literals;

Guid announced_guid(std::uint8_t kind) {
  Guid guid;
  for (std::uint8_t i = 0; i < 15; ++i) guid.bytes[i] = i;
  guid.bytes[15] = kind;
  return guid;
}

Bytes with_encapsulation(const Bytes& parameters) {
  Bytes payload{0, 3, 0, 0};
  payload.insert(payload.end(), parameters.begin(), parameters.end());
  return payload;
}

TestParameters named(std::uint8_t kind) {
  return TestParameters().endpoint(announced_guid(kind)).add(0x05, "rt/scan").add(0x07, "Scan_");
}

TEST(Announcement, WhatIsNotSaidIsAsTheStandardHasIt) {
  const Bytes of_writer = with_encapsulation(named(0x03).end());
  EXPECT_EQ(announced_topic(of_writer), "rt/scan");
  const auto writer = read_announcement(of_writer, EndpointRole::kWriter);
  ASSERT_TRUE(writer);
  EXPECT_EQ(writer->guid, announced_guid(0x03));
  EXPECT_EQ(writer->topic, "rt/scan");
  EXPECT_EQ(writer->type, "Scan_");
  EXPECT_EQ(writer->qos, Qos{});
  const auto reader =
      read_announcement(with_encapsulation(named(0x04).end()), EndpointRole::kReader);
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->qos, Qos{.reliability = Reliability::kBestEffort});
}

TEST(Announcement, EveryPolicyIsRead) {
  const auto info = read_announcement(
      with_encapsulation(named(0x07)
                             .add(0x1a, Bytes{2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0})
                             .add(0x1d, Bytes{1, 0, 0, 0})
                             .add(0x1f, Bytes{1, 0, 0, 0})
                             .add(0x1b, Bytes{2, 0, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0})
                             .add(0x23, Bytes{0, 0, 0, 0, 0, 0, 0, 0x80})
                             .add(0x2b, Bytes{255, 255, 255, 127, 255, 255, 255, 255})
                             .add(0x2c, std::string_view("typehash=1;"))
                             .add(0x29, Bytes{2, 0, 0, 0, 2, 0, 0, 0, 'a', 0, 0, 0, 1, 0, 0, 0, 0})
                             .add(0x8006, Bytes{1, 2, 3, 4})
                             .end()),
      EndpointRole::kReader);
  ASSERT_TRUE(info);
  EXPECT_EQ(info->qos, (Qos{.durability = Durability::kTransientLocal,
                            .deadline = 500ms,
                            .keys = Keys::kSome,
                            .liveliness = Liveliness::kManualByTopic,
                            .liveliness_lease = 3s,
                            .ownership = Ownership::kExclusive}));
  EXPECT_EQ(info->user_data, std::string("typehash=1;\0", 12));
  EXPECT_EQ(info->partitions, (std::vector<std::string>{"a", ""}));
}

TEST(Announcement, EitherOrderOfBytesIsRead) {
  Bytes payload{0, 2, 0, 0, 0, 5, 0, 8, 0, 0, 0,   2, 't', 0,
                0, 0, 0, 7, 0, 8, 0, 0, 0, 2, 'T', 0, 0,   0};
  payload.insert(payload.end(), {0, 0x1d, 0, 4, 0, 0, 0, 1, 0, 0x5a, 0, 16});
  const Guid guid = announced_guid(0x03);
  payload.insert(payload.end(), guid.bytes.begin(), guid.bytes.end());
  payload.insert(payload.end(), {0, 1, 0, 0});
  const auto info = read_announcement(payload, EndpointRole::kWriter);
  ASSERT_TRUE(info);
  EXPECT_EQ(info->topic, "t");
  EXPECT_EQ(info->qos.durability, Durability::kTransientLocal);
}

TEST(Announcement, WhatIsCutIsNotRead) {
  const Bytes whole = with_encapsulation(named(0x03)
                                             .add(0x29, Bytes{1, 0, 0, 0, 2, 0, 0, 0, 'a', 0})
                                             .add(0x2c, std::string_view("x"))
                                             .end());
  EXPECT_TRUE(read_announcement(whole, EndpointRole::kWriter));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    // A copy of its own, so that a read beyond its end is detected.
    const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(read_announcement(part, EndpointRole::kWriter)) << size;
    (void)announced_topic(part);
    (void)read_end(part, Endianness::kLittle, part);
  }
}

TEST(Announcement, WhatIsNoNameIsNotRead) {
  const auto reads = [](const Bytes& topic) {
    return read_announcement(with_encapsulation(TestParameters()
                                                    .endpoint(announced_guid(0x03))
                                                    .add(0x05, topic)
                                                    .add(0x07, "T")
                                                    .end()),
                             EndpointRole::kWriter)
        .has_value();
  };
  EXPECT_TRUE(reads({2, 0, 0, 0, 't', 0}));
  EXPECT_FALSE(reads({1, 0, 0, 0, 0})) << "empty";
  EXPECT_FALSE(reads({1, 0, 0, 0, 't'})) << "without its end";
  EXPECT_FALSE(reads({4, 0, 0, 0, 't', 0, 'u', 0})) << "two ends";
  EXPECT_FALSE(reads({255, 255, 255, 255, 't', 0}));
  Bytes longest{0, 1, 0, 0};
  longest.resize(4 + 255, 't');
  longest.push_back(0);
  EXPECT_TRUE(reads(longest));
  longest.insert(longest.end() - 1, 't');
  ++longest[0];
  EXPECT_FALSE(reads(longest)) << "the middleware has no such strings";
}

TEST(Announcement, OnlyEndpointsOfProgramsAndOfTheRoleAreRead) {
  for (const std::uint8_t kind : {0x04, 0x07, 0xc2, 0xc7, 0x43})
    EXPECT_FALSE(read_announcement(with_encapsulation(named(kind).end()), EndpointRole::kWriter));
  for (const std::uint8_t kind : {0x03, 0x02, 0xc7, 0x44})
    EXPECT_FALSE(read_announcement(with_encapsulation(named(kind).end()), EndpointRole::kReader));
}

TEST(Announcement, AnEndSaysWhichByItsKeyOrItsPayload) {
  const Guid guid = announced_guid(0x03);
  const Bytes key(guid.bytes.begin(), guid.bytes.end());
  const Bytes ended = TestParameters().add(0x71, Bytes{0, 0, 0, 1}).end();
  const Bytes with_key = TestParameters().add(0x70, key).add(0x71, Bytes{0, 0, 0, 2}).end();
  const Bytes alive = TestParameters().add(0x70, key).add(0x71, Bytes{0, 0, 0, 0}).end();
  const Bytes payload = with_encapsulation(TestParameters().endpoint(guid).end());
  EXPECT_EQ(read_end(with_key, Endianness::kLittle, {}), guid);
  EXPECT_EQ(read_end(ended, Endianness::kLittle, payload), guid);
  EXPECT_FALSE(read_end(ended, Endianness::kLittle, {}));
  EXPECT_FALSE(read_end(alive, Endianness::kLittle, payload));
  EXPECT_FALSE(read_end({}, Endianness::kLittle, payload));
}

TEST(Announcement, AFarewellIsThatOfFastDds) {
  Guid participant;
  for (std::size_t i = 0; i < 12; ++i) participant.bytes[i] = static_cast<std::uint8_t>(i + 1);
  participant.bytes[14] = 1, participant.bytes[15] = 0xc1;
  Guid announcer = participant;
  announcer.bytes[13] = 1, announcer.bytes[14] = 0, announcer.bytes[15] = 0xc2;
  constexpr std::int64_t kSequence = (std::int64_t{5} << 32) + 0x0102'0304;
  EXPECT_EQ(farewell_of(participant.prefix(), kSequence),
            TestDatagram(participant.prefix()).farewell(announcer, kSequence, participant).bytes());
}

}  // namespace
}  // namespace culprit::rtps
