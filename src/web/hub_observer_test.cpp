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

// One step of a manager that knows nothing, told at a quarter to six.
struct ToldOnce {
  explicit ToldOnce(std::vector<Observation> observations, live::Observer::Remarks remarks = {}) {
    observer.begins(
        manager, [remarks] { return remarks; }, Time());
    const http::Hub::Reader reader(hub);
    const Time now(Duration(1));
    const auto commands = manager.step(now, observations);
    observer.stepped({now, {}, observations, commands, manager.events()});
  }
  Json latest(http::Kind kind) const { return parse_json(*hub.latest(kind)); }

  const RuleSet rules = *check(Source("test", kObservedRules)).rules;
  Manager manager{rules, std::make_unique<BayesPlanner>(), {}};
  http::Hub hub;
  Metrics metrics;
  HubObserver observer{hub, metrics, [] { return 1795538700.1234; }};
};

TEST(HubObserver, TellsWhatTheClockOnTheWallSays) {
  ToldOnce told({});
  EXPECT_EQ(told.latest(http::Kind::kState)["clock"], 1795538700.123);
  told.observer.announced(Time(), {"trouble", "trouble", EventSeverity::kWarning, Tone::kWarning},
                          "a test");
  const http::Hub::Batch batch = told.hub.wait(0, std::chrono::milliseconds(0));
  const Json event = parse_json(*batch.messages.back().data);
  EXPECT_EQ(event["text"], "a test");
  EXPECT_EQ(event["clock"], 1795538700.123);
}

TEST(HubObserver, SaysWhetherTheRobotIsHeard) {
  EXPECT_EQ(ToldOnce({}).latest(http::Kind::kControl)["hears"], true);
  const ToldOnce deaf({{Time(), HearingLost{"a test"}}});
  EXPECT_EQ(deaf.latest(http::Kind::kControl)["hears"], false);
}

TEST(HubObserver, TellsAProcessThatIsStoppedFromOneThatIsGone) {
  const auto seen = [](std::size_t component, ProcessState process) {
    const int pid = 12 + static_cast<int>(component);
    return Observation{Time(), ProcessSeen{ComponentId(component), process, pid, ""}};
  };
  const ToldOnce told({{Time(), NodeAppeared{"/camera"}},
                       {Time(), NodeAppeared{"/lidar"}},
                       seen(0, ProcessState::kRunning),
                       seen(1, ProcessState::kRunning),
                       seen(0, ProcessState::kStopped),
                       seen(1, ProcessState::kGone)});
  const Json state = told.latest(http::Kind::kState);
  EXPECT_EQ(state["components"][0]["process"], "stopped");
  EXPECT_EQ(state["components"][1]["process"], "gone");
}

// A page has 300 ms from the detection to the cause's name. The wait takes at most an eighth of them.
TEST(HubObserver, TellsTheStateSoonAfterAnEvent) {
  static_assert(8 * HubObserver::kSoon <= std::chrono::milliseconds(300));
  const auto seen = [](ProcessState process) {
    return Observation{Time(), ProcessSeen{ComponentId(0), process, 12, ""}};
  };
  ToldOnce told({{Time(), NodeAppeared{"/camera"}}, seen(ProcessState::kRunning)});
  const http::Hub::Reader reader(told.hub);
  const Time before(Duration(1));
  EXPECT_EQ(told.observer.next_look(), later(before, HubObserver::kPeriod));
  const Time now = later(before, std::chrono::milliseconds(10));
  std::vector<Observation> gone{seen(ProcessState::kGone)};
  const auto commands = told.manager.step(now, gone);
  ASSERT_FALSE(told.manager.events().empty());
  told.observer.stepped({now, {}, gone, commands, told.manager.events()});
  EXPECT_EQ(told.observer.next_look(), later(before, HubObserver::kSoon));
}

TEST(HubObserver, ShowsOtherNodesOfTheSameNameWithItsComponent) {
  const ToldOnce told({}, {{"/camera", "kill 12 or 13"}});
  const Json state = told.latest(http::Kind::kState);
  EXPECT_EQ(state["components"][0]["remark"], "kill 12 or 13");
  EXPECT_FALSE(state["components"][1].contains("remark"));
}

}  // namespace
}  // namespace culprit::web
