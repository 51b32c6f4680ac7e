#include "knowledge/dependency_graph.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "knowledge/condensation.h"
#include "language/checker.h"

namespace culprit {
namespace {

using enum EndpointKind;

class Graph {
 public:
  explicit Graph(const std::string& rules)
      : rules_(*check(Source("test.rules", rules)).rules), graph_(rules_) {}

  Graph& node(const std::string& name) {
    graph_.node_appeared(name);
    return *this;
  }
  Graph& link(const std::string& producer, const std::string& topic, const std::string& consumer) {
    graph_.endpoint_appeared(producer, kPublisher, topic);
    graph_.endpoint_appeared(consumer, kSubscriber, topic);
    return *this;
  }
  std::vector<std::string> upstream(const std::string& name) const {
    return names(graph_.upstream(id(name)));
  }
  std::vector<std::string> downstream(const std::string& name) const {
    return names(graph_.downstream(id(name)));
  }
  DependencyGraph& operator*() { return graph_; }

 private:
  ComponentId id(const std::string& name) const {
    for (std::size_t c = 0; c < rules_.components.size(); ++c) {
      if (rules_.components[c].name == name) return ComponentId(c);
    }
    return {};
  }
  std::vector<std::string> names(const std::vector<ComponentId>& ids) const {
    std::vector<std::string> out;
    for (const ComponentId c : ids) out.push_back(rules_[c].name);
    std::sort(out.begin(), out.end());
    return out;
  }
  RuleSet rules_;
  DependencyGraph graph_;
};

using Names = std::vector<std::string>;

constexpr const char* kThree =
    "COMPONENT camera NODE /camera\nCOMPONENT fusion NODE /fusion\nCOMPONENT seg NODE /seg\n";

TEST(DependencyGraph, HeartbeatsAndWhatAllShareAreNoDataFlow) {
  for (const char* topic : {"/bond", "/robot1/bond", "/peers"}) {
    Graph graph(kThree);
    graph.node("/camera").node("/fusion").node("/seg");
    for (const char* node : {"/camera", "/fusion", "/seg"}) graph.link(node, topic, node);
    EXPECT_EQ(graph.upstream("camera"), Names{}) << topic;
    EXPECT_TRUE((*graph).edges().empty()) << topic;
    EXPECT_FALSE((*graph).reads_others(ComponentId(0))) << topic;
    EXPECT_NE((*graph).scc_of(ComponentId(0)), (*graph).scc_of(ComponentId(1))) << topic;
    // One that only listens waits for the others, but for a heartbeat.
    graph.node("/watcher").link("/camera", topic, "/watcher");
    EXPECT_EQ((*graph).edges().empty(), std::string(topic) != "/peers") << topic;
  }
}

TEST(DependencyGraph, TheNodesOfOneProcessAreOne) {
  Graph graph(
      "COMPONENT controller NODE /controller /costmap\nCOMPONENT lidar NODE /lidar\n"
      "COMPONENT base NODE /base\n");
  graph.node("/lidar").node("/base").node("/controller");
  graph.link("/lidar", "/scan", "/costmap").link("/controller", "/cmd_vel", "/base");
  graph.link("/costmap", "/costmap", "/controller");
  EXPECT_EQ(graph.upstream("base"), (Names{"controller", "lidar"}));
  EXPECT_FALSE((*graph).is_present(ComponentId(0)));
  EXPECT_EQ((*graph).missing_node(ComponentId(0)), "/costmap");
  graph.node("/costmap");
  EXPECT_TRUE((*graph).is_present(ComponentId(0)));
  EXPECT_EQ((*graph).publisher_count("/costmap"), 1u);
  (*graph).node_vanished("/costmap");
  EXPECT_FALSE((*graph).is_present(ComponentId(0)));
  EXPECT_TRUE((*graph).has_any_node(ComponentId(0)));
  EXPECT_EQ(graph.downstream("lidar"), (Names{"base", "controller"}));
  (*graph).component_vanished(ComponentId(0));
  EXPECT_FALSE((*graph).has_any_node(ComponentId(0)));
}

Graph pipeline() {
  Graph graph(kThree);
  graph.node("/camera")
      .node("/fusion")
      .node("/seg")
      .link("/camera", "/rgb", "/fusion")
      .link("/fusion", "/fused", "/seg");
  return graph;
}

TEST(DependencyGraph, FindsTheFirstUpstreamWithoutTheRest) {
  Graph graph = pipeline();
  graph.link("/camera", "/tf", "/fusion")
      .link("/camera", "/tf", "/seg")
      .link("/fusion", "/tf", "/seg");
  const ComponentId seg(2);
  const std::vector<ComponentId> all = (*graph).upstream(seg);
  ASSERT_EQ(all.size(), 2u);
  std::vector<ComponentId> asked;
  for (const ComponentId wanted : all) {
    const auto first = (*graph).first_upstream(seg, [&](ComponentId each) {
      asked.push_back(each);
      return each == wanted;
    });
    EXPECT_EQ(first, wanted);
  }
  EXPECT_EQ(asked, (std::vector<ComponentId>{all[0], all[0], all[1]}));
  EXPECT_FALSE((*graph).first_upstream(seg, [](ComponentId) { return false; }));
  EXPECT_EQ((*graph).upstream(seg), all) << "what ended early is not remembered";
}

TEST(DependencyGraph, FollowsTopicsAgainstTheFlowOfData) {
  Graph graph = pipeline();
  EXPECT_EQ(graph.upstream("seg"), (Names{"camera", "fusion"}));
  EXPECT_EQ(graph.downstream("camera"), (Names{"fusion", "seg"}));
  EXPECT_EQ(graph.upstream("camera"), Names{});
}

TEST(DependencyGraph, LetsAClientDependOnItsServer) {
  Graph graph(kThree);
  graph.node("/camera").node("/fusion");
  (*graph).endpoint_appeared("/camera", kServer, "/calibrate");
  (*graph).endpoint_appeared("/fusion", kClient, "/calibrate");
  EXPECT_EQ(graph.upstream("fusion"), Names{"camera"});
  EXPECT_EQ(graph.upstream("camera"), Names{});
}

TEST(DependencyGraph, LeadsThroughNodesThatAreNoComponents) {
  Graph graph(kThree);
  graph.node("/camera")
      .node("/relay")
      .node("/seg")
      .link("/camera", "/a", "/relay")
      .link("/relay", "/b", "/seg");
  EXPECT_EQ(graph.upstream("seg"), Names{"camera"});
}

// A periodic reader sees by the number that something changed, even if it changed back.
TEST(DependencyGraph, CountsEachChangeOnce) {
  Graph graph(kThree);
  graph.node("/camera").link("/camera", "/a", "/relay");
  const auto before = (*graph).changes();
  EXPECT_TRUE((*graph).endpoint_vanished("/camera", EndpointKind::kPublisher, "/a"));
  EXPECT_EQ((*graph).changes(), before + 1);
  EXPECT_TRUE((*graph).endpoint_appeared("/camera", EndpointKind::kPublisher, "/a"));
  EXPECT_EQ((*graph).changes(), before + 2);
}

TEST(DependencyGraph, ANodeThatIsThereAppearsOnce) {
  Graph graph(kThree);
  EXPECT_TRUE((*graph).node_appeared("/camera"));
  const auto changes = (*graph).changes();
  EXPECT_FALSE((*graph).node_appeared("/camera"));
  EXPECT_EQ((*graph).changes(), changes);
  EXPECT_TRUE((*graph).node_vanished("/camera"));
  EXPECT_EQ((*graph).changes(), changes + 1);
  EXPECT_TRUE((*graph).node_appeared("/camera"));
}

TEST(DependencyGraph, EndsWithCycles) {
  Graph graph = pipeline();
  graph.link("/seg", "/feedback", "/camera");
  EXPECT_EQ(graph.upstream("camera"), (Names{"fusion", "seg"}));
}

TEST(DependencyGraph, ForgetsASubscriptionThatALivingNodeGaveUp) {
  Graph graph = pipeline();
  (*graph).endpoint_vanished("/fusion", kSubscriber, "/rgb");
  EXPECT_EQ(graph.upstream("fusion"), Names{});
}

TEST(DependencyGraph, RemembersSuppliersAndConsumersOfANodeThatExited) {
  Graph graph = pipeline();
  (*graph).endpoint_vanished("/fusion", kSubscriber, "/rgb");
  (*graph).endpoint_vanished("/fusion", kPublisher, "/fused");
  (*graph).node_vanished("/fusion");
  EXPECT_EQ(graph.upstream("seg"), (Names{"camera", "fusion"}));
  (*graph).node_appeared("/fusion");
  (*graph).endpoint_appeared("/fusion", kPublisher, "/fused");
  EXPECT_EQ(graph.upstream("seg"), Names{"fusion"}) << "it came back and subscribes to nothing";
}

TEST(DependencyGraph, RemembersADeactivatedProducerUntilAnotherTakesItsPlace) {
  Graph graph = pipeline();
  (*graph).endpoint_vanished("/camera", kPublisher, "/rgb");
  EXPECT_EQ(graph.upstream("fusion"), Names{"camera"});
  (*graph).endpoint_appeared("/backup", kPublisher, "/rgb");
  EXPECT_EQ(graph.upstream("fusion"), Names{});
}

TEST(DependencyGraph, CountsSeveralEndpointsOfOneNode) {
  Graph graph = pipeline();
  (*graph).endpoint_appeared("/fusion", kSubscriber, "/rgb");
  (*graph).endpoint_vanished("/fusion", kSubscriber, "/rgb");
  EXPECT_EQ(graph.upstream("fusion"), Names{"camera"});
}

TEST(DependencyGraph, IgnoresWhatItIsToldToIgnore) {
  Graph graph(std::string(kThree) + "IGNORE TOPIC /tf\n");
  graph.node("/camera")
      .node("/seg")
      .link("/camera", "/tf", "/seg")
      .link("/camera", "/rosout", "/seg");
  EXPECT_EQ(graph.upstream("seg"), Names{});
}

TEST(DependencyGraph, TakesDeclaredDependencies) {
  Graph graph(std::string(kThree) + "DEPENDENCY seg ON camera\n");
  EXPECT_EQ(graph.upstream("seg"), Names{"camera"});
  EXPECT_EQ(graph.downstream("camera"), Names{"seg"});
}

TEST(DependencyGraph, FindsUndeclaredComponentsByTheNameOfTheirNode) {
  Graph graph(
      "RULE R\nPOLICIES ERROR\nTRIGGER x > 1\nSTRATEGY s 50 10\nADAPTATION fusion restart 1\n"
      "DEPENDENCY fusion ON lidar\n");
  graph.node("/robot/fusion").node("/robot/lidar").node("/other/fusion");
  EXPECT_EQ((*graph).component_of("/robot/fusion"), ComponentId(0));
  EXPECT_EQ((*graph).component_of("/other/fusion"), std::nullopt) << "the first one is it";
  EXPECT_EQ(graph.upstream("fusion"), Names{"lidar"});
}

// Compares the graph's condensation with one that is built from scratch.
void check_condensation(const RuleSet& rules, const DependencyGraph& graph) {
  ChannelEdges edges(graph.size());
  graph.for_each_channel([&](auto producers, auto consumers) { edges.add(producers, consumers); });
  const Condensation anew(edges.vertices(), edges.edges());
  const auto scc_of = [&](std::size_t c) { return anew.scc_of(*graph.vertex_of(ComponentId(c))); };
  for (std::size_t a = 0; a < rules.components.size(); ++a) {
    for (std::size_t b = 0; b < rules.components.size(); ++b) {
      RC_ASSERT((graph.scc_of(ComponentId(a)) == graph.scc_of(ComponentId(b))) ==
                (scc_of(a) == scc_of(b)));
    }
  }
  for (std::size_t c = 0; c < rules.components.size(); ++c) {
    for (const ComponentId producer : graph.upstream(ComponentId(c))) {
      RC_ASSERT(*graph.scc_of(producer) <= *graph.scc_of(ComponentId(c)));
    }
  }
}

// Compares one search from several components with a search from each; both ways.
void check_searches(const RuleSet& rules, const DependencyGraph& graph) {
  std::vector<ComponentId> several;
  for (std::size_t c = 0; c < rules.components.size(); c += 3) several.emplace_back(c);
  std::set<ComponentId> upstream;
  std::set<ComponentId> downstream;
  for (const ComponentId c : several) {
    upstream.insert(graph.upstream(c).begin(), graph.upstream(c).end());
    downstream.insert(graph.downstream(c).begin(), graph.downstream(c).end());
  }
  for (const ComponentId c : several) {
    upstream.erase(c);
    downstream.erase(c);
  }
  const auto is_same = [](const std::vector<ComponentId>& found, const std::set<ComponentId>& all) {
    return found.size() == all.size() && std::set(found.begin(), found.end()) == all;
  };
  RC_ASSERT(is_same(graph.upstream(several), upstream));
  RC_ASSERT(is_same(graph.downstream(several), downstream));
  for (std::size_t a = 0; a < rules.components.size(); ++a) {
    for (std::size_t b = 0; b < rules.components.size(); ++b) {
      const auto is_b = [&](ComponentId c) { return c == ComponentId(b); };
      RC_ASSERT(
          graph.first_downstream(ComponentId(a), is_b).has_value() ==
          graph.first_upstream(ComponentId(b), [&](ComponentId c) { return c == ComponentId(a); })
              .has_value());
    }
  }
}

RC_GTEST_PROP(DependencyGraph, CondensesAndSearchesTheSameWhateverCameAndWent, ()) {
  std::string text = "DEPENDENCY c0 ON c1\n";
  const int components = *rc::gen::inRange(2, 12);
  for (int c = components - 1; c >= 0; --c)
    text = "COMPONENT c" + std::to_string(c) + " NODE /c" + std::to_string(c) + "\n" + text;
  const RuleSet rules = *check(Source("test.rules", text)).rules;
  DependencyGraph graph(rules);
  for (int changes = *rc::gen::inRange(0, 200); changes > 0; --changes) {
    const std::string node = "/c" + std::to_string(*rc::gen::inRange(0, components));
    const std::string topic = "/t" + std::to_string(*rc::gen::inRange(0, 2 * components));
    const auto kind = *rc::gen::element(kPublisher, kSubscriber);
    switch (*rc::gen::weightedElement<int>({{6, 0}, {4, 1}, {1, 2}, {1, 3}, {2, 4}})) {
      case 0:
        graph.endpoint_appeared(node, kind, topic);
        break;
      case 1:
        graph.endpoint_vanished(node, kind, topic);
        break;
      case 2:
        graph.node_appeared(node);
        break;
      case 3:
        graph.node_vanished(node);
        break;
      default:
        check_condensation(rules, graph);
        check_searches(rules, graph);
    }
  }
  check_condensation(rules, graph);
  check_searches(rules, graph);
}

// The network decides how many there are.
TEST(DependencyGraph, TakesInAsManyNodesAsItMayAndNoMore) {
  Graph graph("COMPONENT c NODE /c LAUNCH \"c\"\n");
  std::size_t taken = 0;
  for (std::size_t i = 0; i < DependencyGraph::kMaxNodes + 2; ++i) {
    const std::string number = std::to_string(i);
    taken += (*graph).endpoint_appeared("/n" + number, kPublisher, "/t" + number);
  }
  EXPECT_EQ(taken, DependencyGraph::kMaxNodes - 1) << "the component has its place";
  EXPECT_FALSE((*graph).endpoint_appeared("/one_more", kPublisher, "/t0"));
  EXPECT_TRUE((*graph).endpoint_appeared("/n1", kPublisher, "/t0")) << "it is known";
}

}  // namespace
}  // namespace culprit
