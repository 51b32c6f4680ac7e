#include "ros2/discovery_info.h"

#include <numeric>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace culprit::ros2 {
namespace {

rtps::Guid guid(std::uint8_t first) {
  rtps::Guid g;
  std::iota(g.bytes.begin(), g.bytes.end(), first);
  return g;
}

DiscoveryInfo one_node() {
  return {guid(1), {{.name_space = "/", .name = "n", .readers = {}, .writers = {guid(0x20)}}}};
}

rtps::Bytes golden(std::size_t gid_size) {
  rtps::Bytes bytes{0, 1, 0, 0};
  const auto gid = [&](std::uint8_t first) {
    for (std::size_t i = 0; i < gid_size; ++i)
      bytes.push_back(i < 16 ? static_cast<std::uint8_t>(first + i) : 0);
  };
  gid(1);
  const rtps::Bytes node{1, 0, 0, 0,                // one node
                         2, 0, 0, 0, '/', 0, 0, 0,  // namespace
                         2, 0, 0, 0, 'n', 0, 0, 0,  // name
                         0, 0, 0, 0,                // no readers
                         1, 0, 0, 0};               // one writer
  bytes.insert(bytes.end(), node.begin(), node.end());
  gid(0x20);
  return bytes;
}

TEST(DiscoveryInfo, IsWrittenWithBothSizesOfGid) {
  EXPECT_EQ(encode_discovery_info(one_node(), GidSize::kHumbleAndOlder), golden(24));
  EXPECT_EQ(encode_discovery_info(one_node(), GidSize::kIronAndNewer), golden(16));
}

TEST(DiscoveryInfo, TellsTheSizesApart) {
  EXPECT_EQ(gid_size_of(golden(24)), GidSize::kHumbleAndOlder);
  EXPECT_EQ(gid_size_of(golden(16)), GidSize::kIronAndNewer);
  EXPECT_EQ(decode_discovery_info(golden(24)), one_node());
  EXPECT_EQ(decode_discovery_info(golden(16)), one_node());
}

TEST(DiscoveryInfo, TellsTheSizesApartWithoutNodes) {
  const DiscoveryInfo none{guid(1), {}};
  for (const GidSize size : {GidSize::kHumbleAndOlder, GidSize::kIronAndNewer}) {
    const rtps::Bytes payload = encode_discovery_info(none, size);
    EXPECT_EQ(gid_size_of(payload), size);
    EXPECT_EQ(decode_discovery_info(payload), none);
  }
}

TEST(DiscoveryInfo, RefusesFalseCounts) {
  rtps::Bytes nodes = golden(24);
  nodes[4 + 24] = 0xff;
  EXPECT_FALSE(decode_discovery_info(nodes));
  rtps::Bytes writers = golden(24);
  writers[writers.size() - 24 - 4 + 3] = 0x7f;  // two billion gids
  EXPECT_FALSE(decode_discovery_info(writers));
}

RC_GTEST_PROP(DiscoveryInfo, AnyBytesAreReadOrRefused, (rtps::Bytes bytes)) {
  bytes.insert(bytes.begin(), {0, 1, 0, 0});
  decode_discovery_info(bytes);
}

RC_GTEST_PROP(DiscoveryInfo, SurvivesTheWire,
              (std::vector<std::pair<std::string, std::uint8_t>> nodes)) {
  DiscoveryInfo info{guid(1), {}};
  for (const auto& [name, count] : nodes) {
    NodeEntities& node = info.nodes.emplace_back(NodeEntities{"/ns", name, {}, {}});
    for (int i = 0; i < count % 5; ++i) node.readers.push_back(guid(static_cast<std::uint8_t>(i)));
  }
  const auto size = *rc::gen::element(GidSize::kHumbleAndOlder, GidSize::kIronAndNewer);
  RC_ASSERT(decode_discovery_info(encode_discovery_info(info, size)) == info);
}

}  // namespace
}  // namespace culprit::ros2
