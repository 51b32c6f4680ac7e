#include "web/watched_manager.h"

#include <gtest/gtest.h>

#include "language/checker.h"
#include "plan/bayes/bayes_planner.h"

namespace culprit::web {
namespace {

constexpr const char* kRules = R"(
COMPONENT camera NODE /camera
COMPONENT lidar  NODE /lidar
RULE CameraGone
  POLICIES ERROR
  TRIGGER alive(camera) == false
    STRATEGY restart 50 10
      ADAPTATION camera restart 3
)";

TEST(WatchedManager, ShowsWhoElseHasTheNameOfANodeWithItsComponent) {
  const RuleSet rules = *check(Source("test", kRules)).rules;
  Manager manager(rules, std::make_unique<BayesPlanner>(), {});
  Hub hub;
  Metrics metrics;
  WatchedManager watched(manager, hub, metrics, Time());
  watched.remarks = [] { return WatchedManager::Remarks{{"/camera", "kill 12 or 13"}}; };
  const Hub::Reader reader(hub);
  watched.step(Time(Duration(1)), {});
  const Json state = Json::parse(*hub.latest(Kind::kState));
  EXPECT_EQ(state["components"][0]["remark"], "kill 12 or 13");
  EXPECT_FALSE(state["components"][1].contains("remark"));
}

}  // namespace
}  // namespace culprit::web
