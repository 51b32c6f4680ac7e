// Which dependencies the reference sees.
#include "reference/graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reference/test_ticks.h"

namespace culprit::test {
namespace {

using study::reference::Graph;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

constexpr const char* kNodes = R"(
COMPONENT a NODE /robot/a LAUNCH "a"
COMPONENT b NODE /robot/b LAUNCH "b"
COMPONENT c NODE /robot/c LAUNCH "c"
COMPONENT d NODE /other/d LAUNCH "d"
SIGNAL x DIAGNOSTIC d KEY k
RULE R
  POLICIES ERROR
  TRIGGER x > 0
    STRATEGY s 50 10
      ADAPTATION a restart 1
)";
const ComponentId kA(0);
const ComponentId kB(1);
const ComponentId kC(2);
const ComponentId kD(3);

class ReferenceGraph : public testing::Test {
 protected:
  void see(const char* node, EndpointKind kind, const char* name) {
    graph.take_in({Time{}, EndpointAppeared{node, kind, name}});
  }
  const RuleSet rules = rules_of(kNodes);
  Graph graph{rules, {}};
};

TEST_F(ReferenceGraph, JoinsSubscribersToPublishersTransitively) {
  see("/robot/a", EndpointKind::kPublisher, "/robot/pictures");
  see("/robot/b", EndpointKind::kSubscriber, "/robot/pictures");
  see("/robot/b", EndpointKind::kPublisher, "/words");
  see("/robot/c", EndpointKind::kSubscriber, "/words");
  EXPECT_THAT(graph.upstream(kC), UnorderedElementsAre(kA, kB));
  EXPECT_THAT(graph.upstream(kA), IsEmpty());
}

TEST_F(ReferenceGraph, DoesNotSeeATopicBetweenTwoNamespaces) {
  see("/robot/a", EndpointKind::kPublisher, "/robot/pictures");
  see("/other/d", EndpointKind::kSubscriber, "/robot/pictures");
  EXPECT_THAT(graph.upstream(kD), IsEmpty());
}

TEST_F(ReferenceGraph, TakesAServerToDependOnItsClientsInAnyNamespace) {
  see("/robot/a", EndpointKind::kServer, "/robot/a/calibrate");
  see("/other/d", EndpointKind::kClient, "/robot/a/calibrate");
  EXPECT_THAT(graph.upstream(kA), ElementsAre(kD));
  EXPECT_THAT(graph.upstream(kD), IsEmpty());
}

}  // namespace
}  // namespace culprit::test
