// The reference's loop: when it looks, what it remembers, which rules it can run, and a whole
// course on a robot.
#include "reference/reference_manager.h"

#include <atomic>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "knowledge/describe.h"
#include "manager/runtime.h"
#include "reference/sunset_blackboard.h"
#include "reference/test_ticks.h"
#include "rule_test/reader.h"
#include "rule_test/scripted_robot.h"

namespace culprit::test {
namespace {

using namespace std::chrono_literals;
using study::ReferenceManager;
using study::ReferenceOptions;
using testing::HasSubstr;

TEST(ReferenceManager, LooksOnlyAtItsTicks) {
  const RuleSet rules = rules_of(sunset_reference_rules());
  ReferenceOptions options;
  options.initial = study::sunset_blackboard();
  options.start = Time{4200ms};
  const auto manager = ReferenceManager::make(rules, options);
  ASSERT_TRUE(manager) << manager.error();
  ReferenceManager& m = **manager;
  const auto read = [&](double value, Time at) {
    for (std::size_t s = 0; s < rules.signals.size(); ++s) {
      if (rules.signals[s].name == "segmentation_freq")
        m.step(at, std::vector{Observation{at, SignalRead{SignalId(s), value}}});
    }
  };
  EXPECT_EQ(m.next_deadline(), Time{4200ms});
  read(0.0, Time{4199ms});
  EXPECT_TRUE(m.events().empty());
  read(10.0, Time{4200ms});
  EXPECT_TRUE(m.events().empty()) << "the value read last counts";
  EXPECT_EQ(m.next_deadline(), Time{4240ms});
  read(0.0, Time{4215ms});
  EXPECT_TRUE(m.events().empty());
  m.step(Time{4350ms}, {});
  EXPECT_FALSE(m.events().empty());
  EXPECT_EQ(m.next_deadline(), Time{4360ms}) << "late ticks are left out, and the rhythm stays";
}

TEST(ReferenceManager, HoldsWhatItReadForEver) {
  Ticks ticks;
  ticks.signal("segmentation_entropy", 0.1);
  ticks.run(100000);
  ASSERT_FALSE(ticks.said.empty());
  EXPECT_FALSE(ticks.said.back().ends_with("went away"));
}

// Drives a manager over `observations` and gives what it said, with the times. Steps at its ticks,
// and at each observation too or not.
enum class Stepping : std::uint8_t { kAtTicks, kAtObservations };
std::vector<std::string> told(const RuleSet& rules, const std::vector<Observation>& observations,
                              Stepping stepping) {
  ReferenceOptions options;
  options.initial = study::sunset_blackboard();
  const auto manager = ReferenceManager::make(rules, options);
  std::vector<std::string> lines;
  const auto step = [&](Time now, const std::vector<Observation>& batch) {
    (*manager)->step(now, batch);
    for (const Event& event : (*manager)->events())
      lines.push_back(to_string(event.at.time_since_epoch()) + " " + describe(event, rules));
  };
  std::vector<Observation> batch;
  for (const Observation& observation : observations) {
    while ((*manager)->next_deadline() < observation.at)
      step((*manager)->next_deadline(), std::exchange(batch, {}));
    batch.push_back(observation);
    if (stepping == Stepping::kAtObservations) step(observation.at, std::exchange(batch, {}));
  }
  for (int tick = 0; tick < 200; ++tick)
    step((*manager)->next_deadline(), std::exchange(batch, {}));
  return lines;
}

RC_GTEST_PROP(ReferenceManager, DoesTheSameHoweverOftenItIsStepped, ()) {
  const RuleSet rules = rules_of(sunset_reference_rules());
  std::vector<Observation> observations;
  Time now{};
  for (int i = *rc::gen::inRange(1, 60); i > 0; --i) {
    // Never at a tick: what is observed at that very time may come before or after it.
    now += 1ms * *rc::gen::inRange(1, 1500);
    if (now.time_since_epoch() % 40ms == 0ms) now += 1ms;
    const SignalId signal(*rc::gen::inRange<std::size_t>(0, rules.signals.size()));
    const bool is_bad = *rc::gen::arbitrary<bool>();
    const Value value = rules[signal].name == "camera_autofocus_needed" ? Value(is_bad)
                        : rules[signal].name == "segmentation_entropy"  ? Value(is_bad ? 0.1 : 0.03)
                                                                       : Value(is_bad ? 0.0 : 10.0);
    observations.push_back({now, SignalRead{signal, value}});
  }
  RC_ASSERT(told(rules, observations, Stepping::kAtTicks) ==
            told(rules, observations, Stepping::kAtObservations));
}

std::string refusal(const std::string& rules, ReferenceOptions options = {}) {
  const RuleSet checked = rules_of(rules);
  if (options.initial.empty()) options.initial = {{"x", 0.0}};
  const auto made = ReferenceManager::make(checked, options);
  return made ? "" : made.error();
}

std::string rule(const std::string& policies, const std::string& trigger,
                 const std::string& adaptation, const std::string& when = "") {
  return R"(
COMPONENT c NODE /c LAUNCH "c"
SIGNAL x DIAGNOSTIC d KEY k
RULE R
  POLICIES )" +
         policies + "\n  TRIGGER " + trigger + "\n    STRATEGY s 50 10 " + when +
         "\n      ADAPTATION c " + adaptation + " 1\n";
}

TEST(ReferenceManager, RefusesRulesThatItCannotRun) {
  EXPECT_EQ(refusal(rule("ERROR", "x < 1", "restart")), "");
  EXPECT_EQ(refusal(rule("ERROR FOR 1s", "x < 1", "restart")),
            "rule R: the reference manager knows no FOR, HOLD, COOLDOWN and ON_CHANGE; take them "
            "out");
  EXPECT_THAT(refusal(rule("ERROR HOLD 1/3", "x < 1", "restart")), HasSubstr("HOLD"));
  EXPECT_THAT(refusal(rule("ERROR ON_CHANGE", "x < 1", "restart")), HasSubstr("ON_CHANGE"));
  EXPECT_EQ(refusal(rule("ERROR", "x < 1 && rate(/t) < 1", "restart")),
            "the reference manager reads only signals; write the triggers without functions");
  EXPECT_EQ(refusal(rule("ERROR", "x < 1", "stop")),
            "strategy s: the reference manager cannot stop c");
  EXPECT_EQ(refusal(rule("ERROR", "x < 1", "restart", "WHEN x > 0")),
            "strategy s: the reference manager knows no WHEN; take it out");
}

TEST(ReferenceManager, RefusesABlackboardThatDoesNotFitTheRules) {
  const std::string good = rule("ERROR", "x < 1", "restart");
  ReferenceOptions options;
  options.initial = {{"x", std::string("much")}};
  EXPECT_EQ(refusal(good, options), "signal x: its initial value \"much\" is no double");
  options.initial = {{"y", 1.0}};
  EXPECT_EQ(refusal(good, options), "signal x needs an initial value for the reference manager");
  options.initial = {{"x", 1.0}, {"y", 1.0}};
  EXPECT_EQ(refusal(good, options), "the rules have no signal y to give an initial value");
}

// The camera's outage shows at the three stations one after another, as on SUNSET; a restart of the
// camera heals all.
constexpr const char* kCameraOutage = R"(
COMPONENT camera             PUBLISHES /managed_subsystem/rgb_camera
COMPONENT depth              PUBLISHES /managed_subsystem/depth_camera
COMPONENT image_enhancement  STATE inactive
COMPONENT fusion             SUBSCRIBES /managed_subsystem/rgb_camera /managed_subsystem/depth_camera  PUBLISHES /managed_subsystem/sensors_fused
COMPONENT segmentation       SUBSCRIBES /managed_subsystem/sensors_fused
TEST "outage"
  SIGNAL rgb_camera_freq     EVERY 700ms 0s: 10.0  3.6s: 0.5
  SIGNAL sensors_fused_freq  EVERY 700ms 0s: 20.0  4s: 0.5
  SIGNAL segmentation_freq   EVERY 700ms 0s: 20.0  4s: 0.5
  STRATEGY rgb_restart HEALS rgb_camera_freq sensors_fused_freq segmentation_freq
  RUN 20s
  EXPECT RGBDead DETECTED
)";

std::vector<std::string> course(ReferenceOptions options) {
  const RuleSet rules = rules_of(sunset_reference_rules());
  const Source source("outage.test", kCameraOutage);
  std::vector<Diagnostic> diagnostics;
  const rule_test::Suite suite = rule_test::read_suite(source, rules, diagnostics);
  for (const Diagnostic& d : diagnostics) ADD_FAILURE() << render(d, source);
  rule_test::Scenario scenario = suite.shared;
  scenario.append(suite.tests.at(0).scenario);
  rule_test::ScriptedRobot robot(rules, scenario);
  options.initial = study::sunset_blackboard();
  const auto manager = ReferenceManager::make(rules, options);
  Runtime runtime(**manager, robot);
  std::vector<std::string> lines;
  runtime.on_events = [&](std::span<const Event> events) {
    for (const Event& event : events) {
      robot.hear(event);
      lines.push_back(describe(event, rules));
    }
  };
  const std::atomic<bool> never = false;
  runtime.run(never, Time{suite.tests[0].length});
  return lines;
}

bool holds(const std::vector<std::string>& lines, const std::string& part) {
  return std::any_of(lines.begin(), lines.end(),
                     [&](const std::string& line) { return line.find(part) != std::string::npos; });
}

TEST(ReferenceManager, HealsACascadeByOneRestartWithDAndC) {
  const auto lines = course({});
  EXPECT_TRUE(holds(lines, "RGBDead resolved by rgb_restart"));
  EXPECT_FALSE(holds(lines, "restart fusion"));
  EXPECT_FALSE(holds(lines, "restart segmentation"));
}

TEST(ReferenceManager, RestartsAllOfACascadeWithCAloneAsWithNothing) {
  ReferenceOptions none;
  none.switches = {false, false, true};
  ReferenceOptions only_criticality;
  only_criticality.switches = {false, true, true};
  const auto lines = course(only_criticality);
  EXPECT_TRUE(holds(lines, "restart fusion"));
  EXPECT_EQ(lines, course(none));
}

}  // namespace
}  // namespace culprit::test
