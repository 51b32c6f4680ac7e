#include "web/hub_observer.h"

#include <gtest/gtest.h>

#include "language/checker.h"
#include "plan/bayes/bayes_planner.h"

namespace culprit::web {
namespace {

constexpr const char* kObservedRules = R"(
COMPONENT camera NODE /camera
COMPONENT lidar  NODE /lidar
RULE CameraGone
  POLICIES ERROR
  TRIGGER alive(camera) == false
    STRATEGY restart 50 10
      ADAPTATION camera restart 3
)";

TEST(HubObserver, ShowsWhoElseHasTheNameOfANodeWithItsComponent) {
  const RuleSet rules = *check(Source("test", kObservedRules)).rules;
  Manager manager(rules, std::make_unique<BayesPlanner>(), {});
  Hub hub;
  Metrics metrics;
  HubObserver observer(hub, metrics);
  observer.begins(
      manager,
      [] {
        return live::Observer::Remarks{{"/camera", "kill 12 or 13"}};
      },
      Time());
  const Hub::Reader reader(hub);
  std::vector<Observation> nothing;
  const Time now(Duration(1));
  const auto commands = manager.step(now, nothing);
  observer.stepped({now, {}, nothing, commands, manager.events()});
  const Json state = Json::parse(*hub.latest(Kind::kState));
  EXPECT_EQ(state["components"][0]["remark"], "kill 12 or 13");
  EXPECT_FALSE(state["components"][1].contains("remark"));
}

}  // namespace
}  // namespace culprit::web
