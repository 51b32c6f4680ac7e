#include "doctor/nodes_to_ask.h"

#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::doctor {
namespace {

using testing::SizeIs;

TEST(NodesToAsk, AreAllOfASmallRobotAndSomeOfEachProcessOfALargeOne) {
  const auto nodes = [](std::uint8_t processes, int each) {
    std::vector<ros2::Graph::NodeView> all;
    for (std::uint8_t p = 0; p < processes; ++p) {
      for (int n = 0; n < each; ++n) {
        all.push_back(
            {{"/n" + std::to_string(p * each + n), ros2::Vendor::kFastDds, "", 1}, {}, {}});
        all.back().participant.bytes[0] = p;
      }
    }
    return all;
  };
  EXPECT_THAT(nodes_to_ask(nodes(3, 20), 0), SizeIs(60));
  EXPECT_THAT(nodes_to_ask(nodes(50, 2), 0), SizeIs(50));
  EXPECT_THAT(nodes_to_ask(nodes(200, 1), 0), SizeIs(200)) << "each process may hang";
  std::set<std::string> asked;
  for (std::size_t round = 0; round < 20; ++round) {
    const auto chosen = nodes_to_ask(nodes(10, 20), round);
    EXPECT_THAT(chosen, SizeIs(10));
    std::set<rtps::GuidPrefix> processes;
    for (const auto& view : chosen) {
      asked.insert(view.node.name);
      processes.insert(view.participant);
    }
    EXPECT_THAT(processes, SizeIs(10));
  }
  EXPECT_THAT(asked, SizeIs(200)) << "everybody in turn";

  const auto with_managed = [&](std::size_t how_many) {
    auto all = nodes(10, 20);
    for (std::size_t i = 0; i < how_many; ++i) {
      ros2::GraphEndpoint state;
      state.kind = EndpointKind::kServer;
      state.name = all[i].node.name + "/get_state";
      all[i].endpoints.push_back(state);
    }
    return all;
  };
  const auto managed = [](const std::vector<ros2::Graph::NodeView>& chosen) {
    std::set<std::string> names;
    for (const auto& view : chosen) {
      if (!view.endpoints.empty()) names.insert(view.node.name);
    }
    return names;
  };
  EXPECT_THAT(managed(nodes_to_ask(with_managed(30), 0)), SizeIs(30))
      << "nobody else knows their states";
  std::set<std::string> in_turn;
  for (std::size_t round = 0; round < 20; ++round) {
    const auto chosen = nodes_to_ask(with_managed(150), round);
    EXPECT_THAT(chosen, SizeIs(60));
    in_turn.merge(managed(chosen));
  }
  EXPECT_THAT(in_turn, SizeIs(150));
}

}  // namespace
}  // namespace culprit::doctor
