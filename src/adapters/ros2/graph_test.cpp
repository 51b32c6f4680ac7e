#include "ros2/graph.h"

#include <algorithm>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace culprit::ros2 {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

// Endpoint ids: the last byte marks a reader (4) or a writer (3).
rtps::Guid guid_of(std::uint8_t participant, std::uint8_t entity, bool is_reader) {
  rtps::Guid guid;
  guid.bytes[0] = participant;
  guid.bytes[12] = entity;
  guid.bytes[15] = is_reader ? 4 : 3;
  return guid;
}
rtps::Guid reader(std::uint8_t participant, std::uint8_t entity) {
  return guid_of(participant, entity, true);
}
rtps::Guid writer(std::uint8_t participant, std::uint8_t entity) {
  return guid_of(participant, entity, false);
}

rtps::EndpointInfo endpoint(const rtps::Guid& guid, std::string topic, std::string type) {
  return {
      .guid = guid, .topic = std::move(topic), .type = std::move(type), .user_data = {}, .qos = {}};
}

rtps::EndpointInfo publishes(const rtps::Guid& guid, const std::string& topic) {
  return endpoint(guid, "rt" + topic, "std_msgs::msg::dds_::String_");
}

NodeEntities node(std::string name_space, std::string name,
                  std::vector<rtps::Guid> endpoints = {}) {
  NodeEntities entities{std::move(name_space), std::move(name), {}, {}};
  for (const rtps::Guid& guid : endpoints)
    (guid.is_reader() ? entities.readers : entities.writers).push_back(guid);
  return entities;
}

// A graph, and all its reports, as short texts.
class Watched {
 public:
  explicit Watched(Graph::Options options = {}) : graph_(with_listener(std::move(options))) {}

  Watched& joins(std::uint8_t participant, int pid = 0) {
    graph_.apply(ParticipantInfo{
        .guid = guid_of(participant, 0, false), .vendor = Vendor::kFastDds, .pid = pid});
    return *this;
  }
  Watched& leaves(std::uint8_t participant) {
    graph_.apply(ParticipantGone{guid_of(participant, 0, false)});
    return *this;
  }
  Watched& ends(int pid) {
    graph_.forget_process(pid);
    return *this;
  }
  Watched& is_found_to_have_left(const std::string& node) {
    graph_.believe_left(node);
    return *this;
  }
  Watched& looks_at_unproven() {
    graph_.look_at_unproven();
    return *this;
  }
  Watched& looks_for_ended_namesakes() {
    graph_.forget_ended_namesakes();
    return *this;
  }
  Watched& has(const rtps::EndpointInfo& info) {
    graph_.apply(info);
    return *this;
  }
  Watched& loses(const rtps::Guid& guid) {
    graph_.apply(rtps::EndpointGone{guid});
    return *this;
  }
  Watched& says(std::uint8_t participant, std::vector<NodeEntities> nodes) {
    graph_.apply(DiscoveryInfo{guid_of(participant, 0, false), std::move(nodes)});
    return *this;
  }

  std::vector<std::string> told() { return std::exchange(told_, {}); }
  const Graph& graph() const { return graph_; }

 private:
  Graph::Options with_listener(Graph::Options options) {
    options.listener = [this](const GraphChange& change) { told_.push_back(in_words(change)); };
    return options;
  }

  static std::string kind(EndpointKind k) {
    switch (k) {
      case EndpointKind::kPublisher:
        return "publishes ";
      case EndpointKind::kSubscriber:
        return "subscribes ";
      case EndpointKind::kServer:
        return "serves ";
      case EndpointKind::kClient:
        return "calls ";
    }
    return "?";
  }

  static std::string in_words(const GraphChange& change) {
    if (const auto* c = std::get_if<NodeJoined>(&change)) {
      return "+" + c->node.name + (c->node.pid == 0 ? "" : " in " + std::to_string(c->node.pid));
    }
    if (const auto* c = std::get_if<NodeLeft>(&change)) return "-" + c->node;
    if (const auto* c = std::get_if<EndpointJoined>(&change)) {
      return "+" + c->node + " " + kind(c->endpoint.kind) + c->endpoint.name;
    }
    if (const auto* c = std::get_if<EndpointLeft>(&change))
      return "-" + c->node + " " + kind(c->kind) + c->name;
    if (const auto* c = std::get_if<NodeNamesakes>(&change))
      return "=" + c->node + " has " + std::to_string(c->others) + " namesakes";
    if (const auto* c = std::get_if<NodeSaidToLeave>(&change)) return "?-" + c->node;
    return "!" + std::get<GraphTrouble>(change).text;
  }

  std::vector<std::string> told_;
  Graph graph_;
};

TEST(Graph, JoinsNamesAndEndpointsWhicheverComesFirst) {
  Watched names_first;
  names_first.joins(1).says(1, {node("/", "a", {writer(1, 1)})}).has(publishes(writer(1, 1), "/t"));
  EXPECT_THAT(names_first.told(), ElementsAre("+/a", "+/a publishes /t"));

  Watched endpoints_first;
  endpoints_first.joins(1)
      .has(publishes(writer(1, 1), "/t"))
      .says(1, {node("/", "a", {writer(1, 1)})});
  EXPECT_THAT(endpoints_first.told(), ElementsAre("+/a", "+/a publishes /t"));
}

TEST(Graph, KnowsTheFourKindsOfEndpoints) {
  Watched watched;
  watched.joins(1)
      .has(publishes(writer(1, 1), "/t"))
      .has(publishes(reader(1, 2), "/t"))
      .has(endpoint(reader(1, 3), "rq/sRequest", "std_srvs::srv::dds_::Trigger_Request_"))
      .has(endpoint(writer(1, 4), "rr/sReply", "std_srvs::srv::dds_::Trigger_Response_"))
      .has(endpoint(writer(1, 5), "rq/otherRequest", "std_srvs::srv::dds_::Trigger_Request_"))
      .has(endpoint(reader(1, 6), "rr/otherReply", "std_srvs::srv::dds_::Trigger_Response_"))
      .says(1, {node("/ns", "a",
                     {writer(1, 1), reader(1, 2), reader(1, 3), writer(1, 4), writer(1, 5),
                      reader(1, 6)})});
  EXPECT_THAT(watched.told(), ElementsAre("+/ns/a", "+/ns/a publishes /t", "+/ns/a subscribes /t",
                                          "+/ns/a serves /s", "+/ns/a calls /other"));
}

TEST(Graph, EndpointsVanishBeforeTheirNode) {
  Watched watched;
  watched.joins(1)
      .has(publishes(writer(1, 1), "/t"))
      .says(1, {node("/", "a", {writer(1, 1)})})
      .told();
  watched.leaves(1);
  EXPECT_THAT(watched.told(), ElementsAre("-/a publishes /t", "-/a"));
  EXPECT_THAT(watched.graph().nodes(), IsEmpty());
}

TEST(Graph, ShowsItsListenerWhoPublishesAfterTheChange) {
  std::vector<std::string> seen;
  const Graph* shown = nullptr;
  Graph graph({.listener = [&](const GraphChange&) {
    std::string publishers;
    for (const auto& [name, each] : shown->nodes_publishing("/t")) publishers += name + " ";
    seen.push_back(publishers + (shown->node("/a") ? "and /a is there" : "and /a is not"));
  }});
  shown = &graph;
  ParticipantInfo info{.guid = guid_of(1, 0, false)};
  graph.apply(info);
  graph.apply(publishes(writer(1, 1), "/t"));
  graph.apply(DiscoveryInfo{info.guid, {node("/", "a", {writer(1, 1)})}});
  EXPECT_THAT(seen, ElementsAre("and /a is there", "/a and /a is there"));
  seen.clear();
  graph.apply(ParticipantGone{info.guid});
  EXPECT_THAT(seen, ElementsAre("and /a is there", "and /a is not"));
}

TEST(Graph, AMessageReplacesWhatWasSaidBefore) {
  Watched watched;
  watched.joins(1)
      .has(publishes(writer(1, 1), "/t"))
      .has(publishes(writer(1, 2), "/u"))
      .says(1, {node("/", "a", {writer(1, 1)}), node("/", "b")})
      .told();
  watched.says(1, {node("/", "a", {writer(1, 2)}), node("/", "c")});
  EXPECT_THAT(watched.told(), ElementsAre("-/a publishes /t", "-/b", "+/a publishes /u", "+/c"));
  watched.says(1, {node("/", "a", {writer(1, 2)}), node("/", "c")});
  EXPECT_THAT(watched.told(), IsEmpty());
}

TEST(Graph, AnEndpointMovesFromNodeToNode) {
  Watched watched;
  watched.joins(1)
      .has(publishes(writer(1, 1), "/t"))
      .says(1, {node("/", "a", {writer(1, 1)}), node("/", "b")})
      .told();
  watched.says(1, {node("/", "a"), node("/", "b", {writer(1, 1)})});
  EXPECT_THAT(watched.told(), ElementsAre("-/a publishes /t", "+/b publishes /t"));
}

TEST(Graph, TwoEndpointsOfOneNameAreOneEdge) {
  Watched watched;
  watched.joins(1)
      .has(publishes(writer(1, 1), "/t"))
      .has(publishes(writer(1, 2), "/t"))
      .says(1, {node("/", "a", {writer(1, 1), writer(1, 2)})});
  EXPECT_THAT(watched.told(), ElementsAre("+/a", "+/a publishes /t"));
  watched.loses(writer(1, 1));
  EXPECT_THAT(watched.told(), IsEmpty());
  watched.loses(writer(1, 2));
  EXPECT_THAT(watched.told(), ElementsAre("-/a publishes /t"));
}

TEST(Graph, EndpointsThatAreNotRosAreLeftOut) {
  Watched watched;
  watched.joins(1)
      .has(endpoint(writer(1, 1), "ros_discovery_info",
                    "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_"))
      .has(endpoint(writer(1, 2), "plain", "Plain"))
      .has(endpoint(writer(1, 3), "rt/a b", "std_msgs::msg::dds_::String_"))
      .has(endpoint(writer(1, 4), "rt/t", "not a type"))
      .says(1, {node("/", "a", {writer(1, 1), writer(1, 2), writer(1, 3), writer(1, 4)})});
  EXPECT_THAT(watched.told(), ElementsAre("+/a"));
}

TEST(Graph, InvalidNamesAreLeftOutAndToldOnce) {
  Watched watched;
  watched.joins(1).says(1, {node("/", "a b\n"), node("x", "y"), node("/", "good")});
  watched.says(1, {node("/", "a b\n"), node("/", "good")});
  EXPECT_THAT(
      watched.told(),
      ElementsAre("!a node is left out because its name is not valid: namespace '/', name 'a b?'",
                  "+/good"));
}

TEST(Graph, NobodySpeaksForAnother) {
  Watched watched;
  watched.joins(1)
      .joins(2)
      .has(publishes(writer(2, 1), "/t"))
      .says(1, {node("/", "a", {writer(2, 1)})});
  EXPECT_THAT(watched.told(), ElementsAre("+/a"));
}

TEST(Graph, AnAbsentNodeSaysNothing) {
  Watched watched;
  watched.says(1, {node("/", "a")})
      .has(publishes(writer(1, 1), "/t"))
      .loses(writer(1, 1))
      .leaves(1);
  EXPECT_THAT(watched.told(), IsEmpty());
}

TEST(Graph, ARestartedNodeReplacesItsDeadPredecessor) {
  std::set<int> running = {10, 20};
  Watched watched({.find_process =
                       [](const ParticipantInfo& info) {
                         return FoundProcess{info.pid, ""};
                       },
                   .is_running = [&](int pid) { return running.contains(pid); }});
  watched.joins(1, 10).has(publishes(writer(1, 1), "/t")).says(1, {node("/", "a", {writer(1, 1)})});
  EXPECT_THAT(watched.told(), ElementsAre("+/a in 10", "+/a publishes /t"));

  running.erase(10);
  watched.joins(2, 20).says(2, {node("/", "a", {writer(2, 1)})}).has(publishes(writer(2, 1), "/t"));
  EXPECT_THAT(watched.told(),
              ElementsAre("-/a publishes /t", "-/a", "+/a in 20", "+/a publishes /t"));

  watched.leaves(1);  // the lease of the dead one has run out
  EXPECT_THAT(watched.told(), IsEmpty());
  EXPECT_EQ(watched.graph().nodes().size(), 1u);
}

TEST(Graph, TwoLivingNodesOfOneNameAreTrouble) {
  Watched watched({.find_process =
                       [](const ParticipantInfo& info) {
                         return FoundProcess{info.pid, ""};
                       },
                   .is_running = [](int) { return true; }});
  watched.joins(1, 10)
      .has(publishes(writer(1, 1), "/t"))
      .says(1, {node("/", "a", {writer(1, 1)})})
      .told();
  watched.joins(2, 20).says(2, {node("/", "a")});
  EXPECT_THAT(
      watched.told(),
      ElementsAre(
          "!two nodes have the name /a: one in process 10, one in process 20; the latter counts",
          "=/a has 1 namesakes", "-/a publishes /t", "-/a", "+/a in 20", "=/a has 1 namesakes"));
  watched.leaves(2);
  EXPECT_THAT(watched.told(),
              ElementsAre("-/a", "+/a in 10", "+/a publishes /t", "=/a has 0 namesakes"));
}

TEST(Graph, SeveralMayLookAtARobotByHiddenNodesOfOneName) {
  Watched watched({.find_process =
                       [](const ParticipantInfo& info) {
                         return FoundProcess{info.pid, ""};
                       },
                   .is_running = [](int) { return true; }});
  watched.joins(1, 10).says(1, {node("/", "_survey")}).told();
  watched.joins(2, 20).says(2, {node("/", "_survey")});
  EXPECT_THAT(watched.told(), Not(Contains(HasSubstr("two nodes"))));
}

TEST(Graph, ANamesakeIsForgottenWhenItsProcessHasEnded) {
  std::set<int> running = {10, 20};
  Watched watched({.find_process =
                       [](const ParticipantInfo& info) {
                         return FoundProcess{info.pid, ""};
                       },
                   .is_running = [&](int pid) { return running.contains(pid); }});
  watched.joins(1, 10).says(1, {node("/", "a")}).joins(2, 20).says(2, {node("/", "a")}).told();
  watched.looks_for_ended_namesakes();
  EXPECT_THAT(watched.told(), IsEmpty()) << "both run";
  running.erase(10);
  watched.looks_for_ended_namesakes();
  EXPECT_THAT(watched.told(), ElementsAre("=/a has 0 namesakes"));
  running.erase(20);
  watched.looks_for_ended_namesakes();
  EXPECT_THAT(watched.told(), IsEmpty()) << "for a single one, its process's watcher reports that";
}

TEST(Graph, AnUnprovenNamesakeIsForgottenWhenItsSocketsAreGone) {
  std::set<int> ended;
  Watched watched({.find_process =
                       [&](const ParticipantInfo& info) {
                         return FoundProcess{0, "", ended.contains(info.pid)};
                       },
                   .is_running = [](int) { return true; }});
  watched.joins(1, 10).says(1, {node("/", "a")}).joins(2, 20).says(2, {node("/", "a")}).told();
  watched.looks_for_ended_namesakes();
  EXPECT_THAT(watched.told(), IsEmpty());
  ended.insert(10);
  watched.looks_for_ended_namesakes();
  EXPECT_THAT(watched.told(), ElementsAre("=/a has 0 namesakes"));
  ended.insert(20);
  watched.joins(3, 30).says(3, {node("/", "a")});
  EXPECT_THAT(watched.told(), ElementsAre("-/a", "+/a")) << "a restart";
}

TEST(Graph, TheProcessOfManyNodesIsLookedForOnce) {
  int looks = 0;
  Watched watched({.find_process =
                       [&](const ParticipantInfo& info) {
                         ++looks;
                         return FoundProcess{info.pid, ""};
                       },
                   .is_running = [](int) { return true; }});
  watched.joins(1, 10).says(1, {node("/", "a"), node("/", "b"), node("/", "c")});
  EXPECT_EQ(looks, 1);
  watched.says(1, {node("/", "a"), node("/", "b"), node("/", "c"), node("/", "d")});
  EXPECT_EQ(looks, 2) << "its announcement changed";
}

TEST(Graph, TellsOnceWhatIsMissingForTheProofOfAProcess) {
  Watched watched({.find_process = [](const ParticipantInfo&) {
    return FoundProcess{0, "its user is another"};
  }});
  watched.joins(1, 10).says(1, {node("/", "a"), node("/", "b")});
  watched.says(1, {node("/", "a"), node("/", "b"), node("/", "c")});
  EXPECT_THAT(
      watched.told(),
      ElementsAre("!the process of /a is not proven, so it is not ended: its user is another",
                  "+/a", "+/b", "+/c"));
}

// A process may hold a node that another owner ends, and one that culprit ends.
TEST(Graph, NothingIsMissingForANodeThatOthersEnd) {
  Watched watched({.find_process =
                       [](const ParticipantInfo&) {
                         return FoundProcess{0, "its user is another"};
                       },
                   .is_ended_by_others = [](const std::string& node) { return node == "/a"; }});
  watched.joins(1, 10).says(1, {node("/", "a")});
  EXPECT_THAT(watched.told(), ElementsAre("+/a"));
  watched.joins(2, 20).says(2, {node("/", "a"), node("/", "b")});
  EXPECT_THAT(watched.told(), Contains("!the process of /b is not proven, so it is not ended: "
                                       "its user is another"));
  watched.says(1, {node("/", "a"), node("/", "c")});
  EXPECT_THAT(watched.told(), Contains(HasSubstr("the process of /c is not proven")))
      << "it came later";
}

TEST(Graph, TheProcessOfANodeThatCountsAgainIsLookedForAnew) {
  int looks = 0;
  Watched watched({.find_process = [&](const ParticipantInfo&) {
    ++looks;
    return FoundProcess{};
  }});
  watched.joins(1, 10).says(1, {node("/", "a")});
  watched.joins(2, 20).says(2, {node("/", "a")});
  watched.says(1, {node("/", "a"), node("/", "b")});  // the last that was looked for
  const int before = looks;
  watched.leaves(2);
  EXPECT_GT(looks, before);
}

TEST(Graph, AnEndedProcessIsGoneAtOnce) {
  Watched watched({.find_process = [](const ParticipantInfo& info) {
    return FoundProcess{info.pid, ""};
  }});
  watched.joins(1, 10).joins(2, 20).joins(3);
  watched.says(1, {node("/", "a")}).says(2, {node("/", "b")}).says(3, {node("/", "c")}).told();
  watched.ends(10);
  EXPECT_THAT(watched.told(), ElementsAre("-/a"));
  watched.ends(0);  // no process
  EXPECT_THAT(watched.told(), IsEmpty());
  watched.leaves(1);  // its lease
  EXPECT_THAT(watched.told(), IsEmpty());
}

// One message announces that the camera has left. The listener that acts on that finds out first.
TEST(Graph, ANodeThatIsAskedAboutStaysUntilItIsFoundToHaveLeft) {
  Watched watched({.is_asked_about = [](const std::string& node) { return node == "/camera"; }});
  const NodeEntities camera = node("/", "camera", {writer(1, 1)});
  watched.joins(1)
      .says(1, {camera, node("/", "other")})
      .has(publishes(writer(1, 1), "/rgb"))
      .told();
  watched.says(1, {});
  EXPECT_THAT(watched.told(), ElementsAre("?-/camera", "-/other"));
  watched.says(1, {});
  EXPECT_THAT(watched.told(), IsEmpty()) << "once";
  EXPECT_TRUE(watched.graph().is_said_to_leave("/camera"));
  EXPECT_EQ(watched.graph().nodes().at(0).endpoints.size(), 1u);

  watched.says(1, {camera});
  EXPECT_FALSE(watched.graph().is_said_to_leave("/camera"));
  watched.is_found_to_have_left("/camera");
  EXPECT_THAT(watched.told(), IsEmpty()) << "meanwhile it announced itself";

  watched.says(1, {}).is_found_to_have_left("/camera");
  EXPECT_THAT(watched.told(), ElementsAre("?-/camera", "-/camera publishes /rgb", "-/camera"));
  watched.says(1, {camera});
  EXPECT_THAT(watched.told(), ElementsAre("+/camera", "+/camera publishes /rgb"));
  watched.leaves(1);
  EXPECT_THAT(watched.told(), ElementsAre("-/camera publishes /rgb", "-/camera"))
      << "the participant takes its nodes with it";
}

// Anybody may claim a name. A process of this machine can be proven.
TEST(Graph, AClaimOfAStrangerIsNeitherTheNodeNorItsNamesake) {
  std::map<int, FoundProcess> found = {
      {10, {10, ""}}, {20, {0, "nobody here has it"}}, {30, {30, ""}}};
  std::set<int> running = {10, 30};
  Watched watched({.find_process = [&](const ParticipantInfo& info) { return found[info.pid]; },
                   .is_running = [&](int pid) { return running.contains(pid); },
                   .is_kept_here = [](const std::string& node) { return node == "/camera"; }});
  watched.joins(1, 10).says(1, {node("/", "camera")}).told();
  watched.joins(2, 20).says(2, {node("/", "camera")});
  EXPECT_THAT(watched.told(), ElementsAre(HasSubstr("claims the name /camera")));
  running.erase(10);
  watched.leaves(1);
  EXPECT_THAT(watched.told(), ElementsAre("-/camera")) << "the stranger does not take its place";
  EXPECT_THAT(watched.graph().nodes(), IsEmpty());
  EXPECT_THAT(watched.graph().bare_nodes(), IsEmpty());
  watched.joins(3, 30).says(3, {node("/", "camera")});
  EXPECT_THAT(watched.told(), ElementsAre("+/camera in 30")) << "its successor, without a namesake";
  watched.leaves(2).leaves(3);
  EXPECT_THAT(watched.told(), ElementsAre("-/camera"));
}

TEST(Graph, AProcessProvenLaterThanItClaimsANameHoldsItThen) {
  std::map<int, FoundProcess> found = {{10, {10, ""}}, {20, {0, "its datagrams are to come"}}};
  Watched watched({.find_process = [&](const ParticipantInfo& info) { return found[info.pid]; },
                   .is_running = [](int) { return true; },
                   .is_kept_here = [](const std::string&) { return true; }});
  watched.joins(1, 10).says(1, {node("/", "camera")}).leaves(1);
  watched.joins(2, 20).says(2, {node("/", "camera")}).told();
  found[20] = {20, ""};
  watched.looks_at_unproven();
  EXPECT_THAT(watched.told(), ElementsAre("+/camera in 20"));
  watched.looks_at_unproven();
  EXPECT_THAT(watched.told(), IsEmpty());
}

// As in a container whose files culprit may not see.
TEST(Graph, RootsProcessesNeedNoProofToHoldAName) {
  std::map<int, FoundProcess> found = {{10, {10, ""}}, {20, {0, "of another user", false, true}}};
  Watched watched({.find_process = [&](const ParticipantInfo& info) { return found[info.pid]; },
                   .is_running = [](int) { return true; },
                   .is_kept_here = [](const std::string&) { return true; }});
  watched.joins(1, 10).says(1, {node("/", "camera")}).leaves(1).told();
  watched.joins(2, 20).says(2, {node("/", "camera")});
  EXPECT_THAT(watched.told(), Contains("+/camera"));
}

// The stranger has participants 100 and up.
Graph::Options with_strangers(Graph::Limits limits) {
  return {.is_component = [](const std::string& node) { return node == "/camera"; },
          .source_of =
              [](const ParticipantInfo& info) {
                const std::uint8_t number = info.guid.bytes[0];
                return number >= 100 ? "10.0.0.9" : number >= 50 ? "10.0.0.5" : "";
              },
          .limits = limits};
}

TEST(Graph, AStrangersParticipantsLeaveRoomForTheRobots) {
  Watched watched(with_strangers({.participants = 40, .nodes = 40, .endpoints = 40}));
  for (std::uint8_t i = 100; i < 200; ++i)
    watched.joins(i)
        .says(i, {node("/", "n" + std::to_string(i), {writer(i, 1)})})
        .has(publishes(writer(i, 1), "/t"));
  EXPECT_EQ(watched.graph().participants().size(), 10u);
  watched.told();
  watched.joins(50).says(50, {node("/", "camera")});
  EXPECT_THAT(watched.told(), ElementsAre("+/camera"));
  for (std::uint8_t i = 51; i < 65; ++i) watched.joins(i);
  EXPECT_EQ(watched.graph().participants().size(), 25u) << "a computer with a component is known";
  for (std::uint8_t i = 1; i <= 15; ++i)
    watched.joins(i).says(i, {node("/", "own" + std::to_string(i))});
  EXPECT_EQ(watched.graph().participants().size(), 40u);
  EXPECT_EQ(watched.graph().nodes().size(), 26u);
}

TEST(Graph, AStrangersNodesAndEndpointsLeaveRoomForTheRobots) {
  Watched watched(with_strangers({.participants = 40, .nodes = 8, .endpoints = 8}));
  std::vector<NodeEntities> many;
  std::vector<rtps::Guid> endpoints;
  for (std::uint8_t i = 1; i <= 20; ++i) {
    endpoints.push_back(writer(100, i));
    many.push_back(node("/", "n" + std::to_string(i), {endpoints.back()}));
  }
  watched.joins(100).says(100, many);
  for (const rtps::Guid& guid : endpoints) watched.has(publishes(guid, "/t"));
  EXPECT_EQ(watched.graph().nodes().size(), 2u);
  watched.told();
  watched.joins(1)
      .says(1, {node("/", "a", {writer(1, 1)}), node("/", "camera", {writer(1, 2)})})
      .has(publishes(writer(1, 1), "/x"))
      .has(publishes(writer(1, 2), "/y"));
  EXPECT_THAT(watched.told(),
              ElementsAre("+/a", "+/camera", "+/a publishes /x", "+/camera publishes /y"));
}

// Another user of this computer may make up as many.
TEST(Graph, OnThisMachineOneWithoutNodesMakesRoom) {
  Watched watched(with_strangers({.participants = 4, .nodes = 40, .endpoints = 40}));
  watched.joins(1).says(1, {node("/", "a")});
  for (std::uint8_t i = 2; i < 20; ++i) watched.joins(i);
  watched.told();
  watched.joins(30).says(30, {node("/", "camera")});
  EXPECT_THAT(watched.told(), ElementsAre("+/camera"));
  for (std::uint8_t i = 31; i < 40; ++i) watched.joins(i);
  EXPECT_EQ(watched.graph().nodes().size(), 2u);
  EXPECT_EQ(watched.graph().participants().size(), 4u);
}

TEST(Graph, OneProcessWithTwoNodesOfOneNameIsTroubleOnce) {
  Watched watched;
  watched.joins(1)
      .says(1, {node("/", "a"), node("/", "a")})
      .says(1, {node("/", "a"), node("/", "a")});
  EXPECT_THAT(watched.told(), ElementsAre("!one process holds two nodes with the name /a", "+/a"));
}

TEST(Graph, KeepsTrackOfALimitedNumber) {
  Watched watched({.limits = {.participants = 2, .nodes = 2, .endpoints = 2}});
  watched.joins(1).joins(2).joins(3).joins(4);
  EXPECT_THAT(
      watched.told(),
      ElementsAre("!there are too many participants to keep track of; further ones are left out"));
  watched.says(3, {node("/", "a"), node("/", "b"), node("/", "c"), node("/", "d")});
  EXPECT_THAT(watched.told(),
              ElementsAre("!there are too many nodes to keep track of; further ones are left out",
                          "+/a", "+/b"));
  watched.says(3, {node("/", "a", {writer(3, 1), writer(3, 2), writer(3, 3)})});
  for (const std::uint8_t entity : {1, 2, 3, 4}) watched.has(publishes(writer(3, entity), "/t"));
  EXPECT_THAT(
      watched.told(),
      ElementsAre("!there are too many endpoints to keep track of; further ones are left out",
                  "-/b", "+/a publishes /t"));
  watched.leaves(3)
      .joins(5)
      .says(5, {node("/", "e", {writer(5, 1)})})
      .has(publishes(writer(5, 1), "/t"));
  EXPECT_THAT(watched.told(), ElementsAre("-/a publishes /t", "-/a", "+/e", "+/e publishes /t"));
}

TEST(Graph, ShowsAllNodesWithTheirEndpoints) {
  Watched watched;
  watched.joins(1).has(publishes(writer(1, 1), "/t")).says(1, {node("/", "a", {writer(1, 1)})});
  const auto nodes = watched.graph().nodes();
  ASSERT_EQ(nodes.size(), 1u);
  EXPECT_EQ(nodes[0].node.name, "/a");
  EXPECT_EQ(nodes[0].node.vendor, Vendor::kFastDds);
  ASSERT_EQ(nodes[0].endpoints.size(), 1u);
  EXPECT_EQ(nodes[0].endpoints[0].type, "std_msgs/msg/String");
}

TEST(Graph, ShowsAllParticipantsWithAllThatTheyHave) {
  Watched watched;
  watched.joins(1)
      .joins(2)
      .has(publishes(writer(1, 1), "/t"))
      .has(publishes(writer(1, 2), "/t"))
      .has(publishes(writer(2, 1), "/u"))
      .says(1, {node("/", "a", {writer(1, 1), writer(1, 2), reader(1, 3), reader(1, 4)})});
  const auto participants = watched.graph().participants();
  ASSERT_EQ(participants.size(), 2u);
  EXPECT_THAT(participants[0].nodes, ElementsAre("/a"));
  ASSERT_EQ(participants[0].endpoints.size(), 2u) << "two publishers of one topic, and one node";
  EXPECT_EQ(participants[0].endpoints[1].node, "/a");
  EXPECT_EQ(participants[0].endpoints[1].endpoint.name, "/t");
  EXPECT_EQ(participants[0].undiscovered, 2u);
  EXPECT_THAT(participants[1].nodes, IsEmpty());
  ASSERT_EQ(participants[1].endpoints.size(), 1u);
  EXPECT_EQ(participants[1].endpoints[0].node, "") << "nobody claims it";
}

TEST(Graph, TellsWhetherANodeThatLeftSaidGoodBye) {
  std::vector<bool> lost;
  Graph graph({.listener =
                   [&](const GraphChange& change) {
                     if (const auto* left = std::get_if<NodeLeft>(&change))
                       lost.push_back(left->was_lost);
                   },
               .find_process = {},
               .is_running = {},
               .is_ended_by_others = {},
               .limits = {}});
  for (const bool was_lost : {true, false}) {
    ParticipantInfo info{.guid = guid_of(1, 0, false)};
    graph.apply(info);
    graph.apply(DiscoveryInfo{info.guid, {node("/", "a")}});
    graph.apply(ParticipantGone{info.guid, was_lost});
  }
  EXPECT_THAT(lost, ElementsAre(true, false));
}

// In any order of events: the reported changes add up to the graph's content.
RC_GTEST_PROP(Graph, WhatItTellsAddsUpToWhatItShows, ()) {
  std::set<std::string> nodes, edges;
  Graph graph(
      {.listener =
           [&](const GraphChange& change) {
             const auto edge = [](const std::string& n, EndpointKind kind,
                                  const std::string& name) {
               return n + "|" + std::to_string(static_cast<int>(kind)) + "|" + name;
             };
             if (const auto* c = std::get_if<NodeJoined>(&change)) {
               RC_ASSERT(nodes.insert(c->node.name).second);
             } else if (const auto* left = std::get_if<NodeLeft>(&change)) {
               RC_ASSERT(nodes.erase(left->node) == 1u);
               RC_ASSERT(std::ranges::none_of(
                   edges, [&](const auto& e) { return e.starts_with(left->node + "|"); }));
             } else if (const auto* joined = std::get_if<EndpointJoined>(&change)) {
               RC_ASSERT(nodes.contains(joined->node));
               RC_ASSERT(
                   edges.insert(edge(joined->node, joined->endpoint.kind, joined->endpoint.name))
                       .second);
             } else if (const auto* gone = std::get_if<EndpointLeft>(&change)) {
               RC_ASSERT(edges.erase(edge(gone->node, gone->kind, gone->name)) == 1u);
             }
           },
       .limits = {.participants = 2, .nodes = 3, .endpoints = 6}});
  const auto participant = [] { return *rc::gen::inRange<std::uint8_t>(1, 4); };
  const auto any_endpoint = [&](std::uint8_t p) {
    return guid_of(p, *rc::gen::inRange<std::uint8_t>(1, 4), *rc::gen::arbitrary<bool>());
  };
  const int steps = *rc::gen::inRange(0, 60);
  for (int i = 0; i < steps; ++i) {
    const std::uint8_t p = participant();
    switch (*rc::gen::inRange(0, 5)) {
      case 0: {
        graph.apply(ParticipantInfo{.guid = guid_of(p, 0, false)});
        break;
      }
      case 1:
        graph.apply(ParticipantGone{guid_of(p, 0, false)});
        break;
      case 2:
        graph.apply(publishes(any_endpoint(p), *rc::gen::element<std::string>("/t", "/u", "bad")));
        break;
      case 3:
        graph.apply(rtps::EndpointGone{any_endpoint(p)});
        break;
      default: {
        DiscoveryInfo info{guid_of(p, 0, false), {}};
        const int count = *rc::gen::inRange(0, 4);
        for (int n = 0; n < count; ++n) {
          std::vector<rtps::Guid> endpoints;
          const int claimed = *rc::gen::inRange(0, 4);
          for (int e = 0; e < claimed; ++e) endpoints.push_back(any_endpoint(p));
          info.nodes.push_back(
              node("/", *rc::gen::element<std::string>("a", "b", "c", "d", "no good"), endpoints));
        }
        graph.apply(info);
      }
    }
  }
  std::set<std::string> shown;
  std::size_t shown_edges = 0;
  std::map<std::string, std::set<std::string>> publishers;
  for (const auto& view : graph.nodes()) {
    shown.insert(view.node.name);
    shown_edges += view.endpoints.size();
    for (const GraphEndpoint& each : view.endpoints) {
      if (each.kind == EndpointKind::kPublisher) publishers[each.name].insert(view.node.name);
    }
  }
  RC_ASSERT(shown == nodes);
  RC_ASSERT(shown_edges == edges.size());
  std::map<std::string, std::set<std::string>> published;
  for (const auto& [topic, by_node] : graph.published()) {
    for (const auto& [name, each] : by_node) {
      RC_ASSERT(each->name == topic && each->kind == EndpointKind::kPublisher);
      published[topic].insert(name);
    }
  }
  RC_ASSERT(published == publishers);
}

}  // namespace
}  // namespace culprit::ros2
