#include "ros2/service_mapping.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace culprit::ros2 {
namespace {

TEST(ServiceMapping, FollowsTheVendor) {
  ParticipantInfo info;
  info.vendor = Vendor::kCyclone;
  EXPECT_EQ(mapping_of(&info), Mapping::kHeader);
  info.vendor = Vendor::kFastDds;
  EXPECT_EQ(mapping_of(&info), Mapping::kInline);
  info.vendor = Vendor::kOther;
  EXPECT_EQ(mapping_of(&info), Mapping::kInline);
  EXPECT_EQ(mapping_of(nullptr), Mapping::kInline);
}

TEST(ServiceMapping, TheHeaderStandsBetweenEncapsulationAndMessage) {
  EXPECT_EQ(with_header(rtps::Bytes{0, 1, 0, 0, 0xaa}, {.client = 1, .sequence = 2}),
            (rtps::Bytes{0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0xaa}));
  EXPECT_EQ(with_header(rtps::Bytes{0, 0, 0, 0, 0xaa}, {.client = 1, .sequence = 2}),
            (rtps::Bytes{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 2, 0xaa}));
}

TEST(ServiceMapping, RefusesAPayloadThatIsTooShortForAHeader) {
  EXPECT_FALSE(split_header(rtps::Bytes{}));
  EXPECT_FALSE(split_header(rtps::Bytes{0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0}));
}

RC_GTEST_PROP(ServiceMapping, SplitUndoesWith,
              (rtps::Bytes body, std::uint64_t client, std::int64_t sequence)) {
  body.insert(body.begin(), {0, static_cast<std::uint8_t>(*rc::gen::inRange(0, 2)), 0, 0});
  const auto split = split_header(with_header(body, {client, sequence}));
  RC_ASSERT(split.has_value());
  RC_ASSERT(split->header == (ServiceHeader{client, sequence}));
  RC_ASSERT(split->payload == body);
}

TEST(ServiceMapping, ReadsUserData) {
  EXPECT_EQ(user_data_value("clientid= 1.10.c5;typehash=RIHS01_ab;", "clientid"), " 1.10.c5");
  EXPECT_EQ(user_data_value("clientid=1;typehash=2;", "typehash"), "2");
  EXPECT_EQ(user_data_value("clientid=1", "clientid"), "1");
  EXPECT_EQ(user_data_value("clientid;", "clientid"), "");
  EXPECT_EQ(user_data_value("xclientid=1;", "clientid"), "");
  EXPECT_EQ(user_data_value(";;=;", "clientid"), "");
  EXPECT_EQ(user_data_value("", "clientid"), "");
}

// An endpoint of the participant with this number.
rtps::Guid endpoint(std::uint8_t participant, std::uint16_t number) {
  rtps::Guid guid;
  guid.bytes[0] = participant;
  guid.bytes[12] = static_cast<std::uint8_t>(number >> 8);
  guid.bytes[13] = static_cast<std::uint8_t>(number);
  return guid;
}

TEST(ServiceMapping, AServerHasBothEnds) {
  const auto no_id = [](const rtps::Guid&) { return std::string_view(); };
  const Matches readers{{endpoint(1, 1), 1}, {endpoint(2, 1), 2}, {endpoint(3, 1), 3}};
  const Matches writers{{endpoint(1, 2), 5}, {endpoint(2, 2), 4}};
  EXPECT_EQ(servers_among(readers, writers, no_id),
            (std::vector{endpoint(2, 0).prefix(), endpoint(1, 0).prefix()}))
      << "the newest is the last one";
  const auto by_number = [](const rtps::Guid& guid) {
    return std::string_view(guid.bytes[13] == 1 ? "a" : "b");
  };
  EXPECT_TRUE(servers_among(readers, writers, by_number).empty()) << "of two servers each";
}

TEST(ServiceMapping, LooksAtEachOfAStrangersEndpointsOnce) {
  constexpr std::uint16_t kMany = 1000;
  Matches readers, writers;
  for (std::uint16_t i = 0; i < kMany; ++i) {
    readers[endpoint(1, i)] = 2u * i + 1;
    writers[endpoint(1, i)] = 2u * i + 2;
  }
  int looks = 0;
  const auto id_of = [&](const rtps::Guid&) {
    ++looks;
    return std::string_view();
  };
  EXPECT_EQ(servers_among(readers, writers, id_of).size(), 1u);
  EXPECT_EQ(looks, 2 * kMany);
}

}  // namespace
}  // namespace culprit::ros2
