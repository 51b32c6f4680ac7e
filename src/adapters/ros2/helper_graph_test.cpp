#include "ros2/helper_graph.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "ros2/graph.h"

namespace culprit::ros2 {
namespace {

using culprit_link::Gid;
using culprit_link::GraphSeen;

constexpr Gid kOwn = {1, 15, 7, 7, 0x22, 0x11};

// An id that Fast DDS gives an endpoint of this process on this machine.
Gid gid_of(int pid, std::uint8_t endpoint) {
  Gid gid = {1, 15, 7, 7, static_cast<std::uint8_t>(pid), static_cast<std::uint8_t>(pid >> 8)};
  gid[14] = endpoint;
  gid[15] = 3;
  return gid;
}

GraphSeen::Endpoint publisher(const std::string& node, const std::string& topic, const Gid& gid) {
  return {true, topic, "std_msgs/msg/Float64", "", gid, {"/", node}, {}};
}

// A graph that is fed with it, and its reports.
class Fed {
 public:
  explicit Fed(const std::string& middleware = "rmw_fastrtps_cpp") {
    helper.begin(middleware, kOwn, "/culprit");
  }
  void take(const GraphSeen& seen, HelperGraph::Missing missing = HelperGraph::Missing::kLeft) {
    for (const HelperGraph::Change& change : helper.take(seen, missing)) {
      if (const auto* event = std::get_if<DiscoveryEvent>(&change)) graph.apply(*event);
      if (const auto* info = std::get_if<DiscoveryInfo>(&change)) graph.apply(*info);
    }
  }
  std::vector<std::string> take_told() { return std::exchange(told, {}); }

  HelperGraph helper;
  std::vector<std::string> told;
  Graph graph{[this] {
    Graph::Options options;
    options.listener = [this](const GraphChange& change) {
      if (const auto* joined = std::get_if<NodeJoined>(&change))
        told.push_back("+" + joined->node.name);
      if (const auto* left = std::get_if<NodeLeft>(&change)) told.push_back("-" + left->node);
      if (const auto* joined = std::get_if<EndpointJoined>(&change))
        told.push_back("+" + joined->node + joined->endpoint.name);
      if (const auto* left = std::get_if<EndpointLeft>(&change))
        told.push_back("-" + left->node + left->name);
    };
    options.is_component = [](const std::string& node) { return node == "/camera"; };
    options.source_of = HelperGraph::source_of;
    options.limits = {.participants = 20, .nodes = 20, .endpoints = 20};
    return options;
  }()};
};

GraphSeen camera(int pid) {
  return {{{"/", "camera"}},
          {publisher("camera", "/light", gid_of(pid, 1))},
          {{true, "/camera/get_state", "lifecycle_msgs/srv/GetState", {"/", "camera"}}}};
}

TEST(HelperGraph, TellsOfNodesWithTheirEndpointsAndServices) {
  Fed fed;
  fed.take(camera(300));
  EXPECT_EQ(fed.take_told(),
            (std::vector<std::string>{"+/camera", "+/camera/light", "+/camera/camera/get_state"}));
  fed.take(camera(300));
  EXPECT_EQ(fed.take_told(), std::vector<std::string>{});
  fed.take({});
  const auto told = fed.take_told();
  ASSERT_EQ(told.size(), 3U);
  EXPECT_EQ(told.back(), "-/camera");
}

// They come all at once, before the robot's.
TEST(HelperGraph, AThousandStrangersLeaveRoomForAComponent) {
  Fed fed;
  GraphSeen seen = camera(60'000);
  for (int i = 0; i < 1000; ++i) {
    const std::string name = "n" + std::to_string(i);
    seen.nodes.push_back({"/", name});
    seen.endpoints.push_back(publisher(name, "/light", gid_of(i + 1, 1)));
  }
  fed.take(seen);
  const auto told = fed.take_told();
  for (const char* wanted : {"+/camera", "+/camera/light", "+/camera/camera/get_state"})
    EXPECT_NE(std::ranges::find(told, wanted), told.end()) << wanted;
  EXPECT_EQ(fed.graph.participants().size(), 21U);
}

Gid on_computer(std::uint8_t number, int pid) {
  Gid gid = gid_of(pid, 1);
  gid[2] = number;
  return gid;
}

GraphSeen thousand_strangers_on(std::uint8_t computer) {
  GraphSeen seen;
  for (int i = 0; i < 1000; ++i)
    seen.endpoints.push_back(
        publisher("n" + std::to_string(i), "/light", on_computer(computer, i + 1)));
  return seen;
}

TEST(HelperGraph, StrangersOfOneComputerTakeAQuarterOfTheRoomAndLeaveItToOthers) {
  Fed fed;
  GraphSeen seen = thousand_strangers_on(8);
  fed.take(seen);
  EXPECT_EQ(fed.graph.participants().size(), 5U);
  fed.take_told();
  seen.endpoints.push_back(publisher("lidar", "/scan", on_computer(9, 1)));
  fed.take(seen);
  EXPECT_EQ(fed.take_told(), (std::vector<std::string>{"+/lidar", "+/lidar/scan"}));
}

TEST(HelperGraph, AComponentElsewhereMakesNoOtherComputerKnown) {
  Fed fed;
  GraphSeen seen = thousand_strangers_on(8);
  seen.endpoints.insert(seen.endpoints.begin(), publisher("camera", "/image", on_computer(6, 1)));
  fed.take(seen);
  EXPECT_EQ(fed.graph.participants().size(), 6U);
}

TEST(HelperGraph, StrangersOfAnotherVendorAreOneSource) {
  Fed fed;
  GraphSeen seen;
  for (int i = 0; i < 1000; ++i) {
    Gid gid = on_computer(static_cast<std::uint8_t>(i), i + 1);
    gid[1] = 16;  // Cyclone DDS
    seen.endpoints.push_back(publisher("n" + std::to_string(i), "/light", gid));
  }
  fed.take(seen);
  EXPECT_EQ(fed.graph.participants().size(), 5U);
}

TEST(HelperGraph, ForgetsServicesThatAreGone) {
  Fed fed;
  const auto server = [&fed] {
    const auto& all =
        fed.helper.matching("rq/camera/get_stateRequest", rtps::EndpointRole::kWriter);
    return all.empty() ? rtps::Guid() : *all.begin();
  };
  fed.take(camera(300));
  const rtps::Guid first = server();
  GraphSeen without = camera(300);
  without.services.clear();
  fed.take(without);
  EXPECT_EQ(server(), rtps::Guid());
  fed.take(camera(300));
  EXPECT_NE(server(), first) << "nothing is kept of each name that there ever was";
}

TEST(HelperGraph, KnowsTheProcessThatFastDdsAnnouncesAndTheNodesOfIt) {
  Fed fed;
  GraphSeen seen = camera(300);
  seen.endpoints.push_back(publisher("flash", "/flashes", gid_of(300, 2)));
  GraphSeen::Endpoint elsewhere = publisher("far", "/far", gid_of(400, 1));
  elsewhere.gid[2] = 8;
  seen.endpoints.push_back(elsewhere);
  fed.take(seen);
  const auto all = fed.graph.participants();
  ASSERT_EQ(all.size(), 2U);
  const auto here = std::ranges::find(all, std::vector<std::string>{"/camera", "/flash"},
                                      [](const auto& each) { return each.info.nodes; });
  ASSERT_NE(here, all.end());
  EXPECT_EQ(here->info.pid, 300);
  const auto far = std::ranges::find(all, std::vector<std::string>{"/far"},
                                     [](const auto& each) { return each.info.nodes; });
  ASSERT_NE(far, all.end());
  EXPECT_EQ(far->info.pid, 0);
  EXPECT_EQ(far->info.host, "another computer");
}

TEST(HelperGraph, ASuccessorHasTheServicesOfItsName) {
  Fed fed;
  fed.take(camera(300));
  GraphSeen both = camera(300);
  both.endpoints.push_back(publisher("camera", "/light", gid_of(301, 1)));
  fed.take(both);
  const std::string topic = "rq/camera/get_stateRequest";
  const auto& servers = fed.helper.matching(topic, rtps::EndpointRole::kWriter);
  ASSERT_EQ(servers.size(), 1U);
  EXPECT_EQ(servers.begin()->bytes[4] | servers.begin()->bytes[5] << 8, 301);
}

TEST(HelperGraph, WithoutGuidsANodeIsItselfUntilNoneOfItsIdsIsLeft) {
  Fed fed("rmw_zenoh_cpp");
  GraphSeen seen{{{"/", "camera"}}, {publisher("camera", "/parameter_events", Gid{5})}, {}};
  fed.take(seen);
  fed.take_told();
  seen.endpoints.push_back(publisher("camera", "/light", Gid{2}));
  fed.take(seen);
  EXPECT_EQ(fed.take_told(), std::vector<std::string>{"+/camera/light"});
  seen.endpoints = {publisher("camera", "/parameter_events", Gid{9})};
  fed.take(seen);
  const auto told = fed.take_told();
  EXPECT_NE(std::ranges::find(told, "-/camera"), told.end());
  EXPECT_NE(std::ranges::find(told, "+/camera"), told.end());
}

TEST(HelperGraph, KeepsWhatANewHelperHasNotDiscoveredYet) {
  Fed fed;
  fed.take(camera(300));
  fed.take_told();
  fed.take({}, HelperGraph::Missing::kKeep);
  EXPECT_TRUE(fed.helper.has_missing());
  GraphSeen without_service = camera(300);
  without_service.services.clear();
  fed.take(without_service, HelperGraph::Missing::kKeep);
  EXPECT_TRUE(fed.helper.has_missing());
  fed.take(camera(300), HelperGraph::Missing::kKeep);
  EXPECT_FALSE(fed.helper.has_missing());
  EXPECT_EQ(fed.take_told(), std::vector<std::string>{});
}

TEST(HelperGraph, KnowsWhoseNodesWereNotAnnounced) {
  Fed fed;
  GraphSeen seen = camera(300);
  seen.endpoints.push_back(publisher("", "/scan", gid_of(301, 1)));
  seen.endpoints.back().node = {};
  fed.take(seen);
  const auto found = fed.helper.without_nodes();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].bytes[4] | found[0].bytes[5] << 8, 301);
}

TEST(HelperGraph, DoesNotMissAKilledHelper) {
  Fed fed;
  fed.helper.begin("rmw_fastrtps_cpp", gid_of(500, 1), "/culprit");
  GraphSeen seen = camera(300);
  seen.endpoints.push_back(publisher("culprit", "/diagnostics", kOwn));  // of the one before
  fed.take(seen);
  EXPECT_EQ(fed.take_told().size(), 3U);
}

TEST(HelperGraph, TheOnlyPublisherOfATopicWroteItsSamples) {
  Fed fed("rmw_cyclonedds_cpp");
  fed.take(camera(300));
  rtps::Guid publisher_id;
  publisher_id.bytes = gid_of(300, 1);
  EXPECT_EQ(fed.helper.writer_of("rt/light", Gid{77}), publisher_id);
  GraphSeen two = camera(300);
  two.endpoints.push_back(publisher("lamp", "/light", gid_of(301, 1)));
  fed.take(two);
  EXPECT_EQ(fed.helper.writer_of("rt/light", gid_of(300, 1)), publisher_id);
  EXPECT_NE(fed.helper.writer_of("rt/light", Gid{77}), publisher_id);
}

TEST(HelperGraph, LeavesOutItselfAndNamesThatBreakTheGrammar) {
  Fed fed;
  GraphSeen seen;
  seen.nodes = {{"/", "culprit"}, {"/", "bad name"}};
  seen.endpoints = {publisher("culprit", "/diagnostics", kOwn),
                    publisher("bad name", "/light", gid_of(300, 1)),
                    publisher("camera", "no topic", gid_of(301, 1))};
  seen.services = {{true, "/x y", "a/srv/B", {"/", "camera"}}, {true, "/x", "b", {"/", "nobody"}}};
  fed.take(seen);
  EXPECT_EQ(fed.take_told(), std::vector<std::string>{});
}

}  // namespace
}  // namespace culprit::ros2
