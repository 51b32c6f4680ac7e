#include "web/signal_history.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "language/checker.h"
#include "plan/bayes/bayes_planner.h"
#include "web/calls.h"

namespace culprit::web {
namespace {

constexpr const char* kPlottedRules = R"(
COMPONENT camera NODE /camera
SIGNAL brightness TOPIC /brightness FIELD data
RULE Dark
  POLICIES ERROR
  TRIGGER brightness < 10 || age(/image) > 1s
    STRATEGY restart 50 10
      ADAPTATION camera restart 3
)";

// A robot in virtual time, of which a page may ask for curves.
class PlottedSignals : public testing::Test {
 protected:
  PlottedSignals() { histories.signals.begins(manager, {}, Time()); }

  void step(Duration at, std::vector<Observation> seen = {}) {
    for (Observation& each : seen) each.at = Time(at);
    wall = 1000 + seconds(at);
    const auto commands = manager.step(Time(at), seen);
    histories.signals.stepped({Time(at), {}, seen, commands, manager.events()});
  }
  Json ask(const std::string& name) const {
    return series_route(histories).answer({{"name", name}}).body;
  }

  const RuleSet rules = *check(Source("test", kPlottedRules)).rules;
  Manager manager{rules, std::make_unique<BayesPlanner>(), {}};
  double wall = 0;
  Histories histories{UsageHistory(), SignalHistory([this] { return wall; })};
};

TEST_F(PlottedSignals, AreSampledEverySecondWhetherAPageIsOpenOrNot) {
  using std::chrono::milliseconds;
  EXPECT_EQ(histories.signals.next_look(), kNever) << "no page is served";
  histories.signals.start();
  step(milliseconds(0));
  step(milliseconds(400), {{Time(), SignalRead{SignalId(0), Value(25.0)}}});
  EXPECT_EQ(ask("input brightness")["clocks"], Json::array({1000.0})) << "once a second is enough";
  EXPECT_EQ(ask("input brightness")["values"], Json::array({nullptr})) << "it was unknown";
  step(milliseconds(1000));
  EXPECT_EQ(ask("input brightness")["clocks"], Json({1000.0, 1001.0}));
  EXPECT_EQ(ask("input brightness")["values"], Json({nullptr, 25.0}));
  EXPECT_EQ(series_route(histories)
                .answer({{"name", "input brightness"}, {"since", "1000"}})
                .body["values"],
            Json::array({25.0}))
      << "a page asks for what is new";
  EXPECT_EQ(ask("input nothing")["clocks"], Json::array());
  EXPECT_EQ(histories.signals.next_look(), Time(milliseconds(2000)))
      << "a quiet robot is sampled, too";
}

TEST_F(PlottedSignals, AreKeptForAQuarterOfAnHourAndBeyondAReload) {
  histories.signals.start();
  for (std::size_t i = 0; i < SignalHistory::kMost + 10; ++i) step(std::chrono::seconds(i));
  EXPECT_EQ(ask("age /image")["clocks"].size(), SignalHistory::kMost);
  EXPECT_EQ(ask("age /image")["clocks"][0], 1010.0) << "the oldest is dropped first";
  histories.signals.begins(manager, {}, Time());
  EXPECT_EQ(ask("age /image")["clocks"].size(), SignalHistory::kMost);
}

}  // namespace
}  // namespace culprit::web
