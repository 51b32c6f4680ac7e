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
  EXPECT_EQ(with_header(Bytes{0, 1, 0, 0, 0xaa}, {.client = 1, .sequence = 2}),
            (Bytes{0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0xaa}));
  EXPECT_EQ(with_header(Bytes{0, 0, 0, 0, 0xaa}, {.client = 1, .sequence = 2}),
            (Bytes{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 2, 0xaa}));
}

TEST(ServiceMapping, RefusesAPayloadThatIsTooShortForAHeader) {
  EXPECT_FALSE(split_header(Bytes{}));
  EXPECT_FALSE(split_header(Bytes{0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0}));
}

RC_GTEST_PROP(ServiceMapping, SplitUndoesWith,
              (Bytes body, std::uint64_t client, std::int64_t sequence)) {
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

}  // namespace
}  // namespace culprit::ros2
