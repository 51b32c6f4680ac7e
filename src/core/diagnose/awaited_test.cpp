#include "diagnose/awaited.h"

#include <gtest/gtest.h>

#include "diagnose/imminent.h"
#include "plan/bayes/test_scene.h"

namespace culprit::diagnose {
namespace {

using namespace std::chrono_literals;
using plan::failure_of;
using plan::Scene;

// a -> b, each watched by a value of its own; their monitors are at most 400 ms late (the least impact
// of their strategies, two cycles), and are read every 200 ms.
class TwoMonitors : public ::testing::Test {
 protected:
  TwoMonitors() : scene_(rules()) {
    scene_.link("a", "b");
    for (const char* rule : {"A", "B"}) {
      scene_->signals.set_latency(scene_.rules()[scene_.rule(rule)].inputs.front(), 400ms);
      scene_->states.state(scene_.rule(rule)).detection.trigger = Slot::of(false);
    }
    scene_->latencies.weigh(-3);  // the monitors keep what the rules state
  }

  static std::string rules() {
    std::string text = failure_of("a", "A") + failure_of("b", "B");
    text.replace(text.rfind("x > 1"), 5, "y > 1");
    return text;
  }
  std::optional<Awaiting> awaited(Duration detected_ago) {
    scene_.fail("B", 10s - detected_ago);
    return Awaited(*scene_, scene_->states.active()).of(scene_.rule("B"));
  }
  RuleState& state(const char* rule) { return scene_->states.state(scene_.rule(rule)); }

  Scene scene_;
};

// B began at least 200 ms before it was detected, and A would show its own failure within 600 ms.
TEST_F(TwoMonitors, AQuietRuleUpstreamCanStillFireForAWhile) {
  ASSERT_TRUE(awaited(300ms));
  EXPECT_EQ(awaited(300ms)->because, scene_.rule("A"));
  EXPECT_FALSE(awaited(300ms)->is_echo);
  EXPECT_TRUE(awaited(399ms));
  EXPECT_FALSE(awaited(401ms));
}

// Until it is known that monitors keep it, they may be 2 s late, whatever the rules state.
TEST_F(TwoMonitors, AnUnprovenStatementIsNotReliedOn) {
  scene_->latencies.forget(scene_.rule("A"));
  EXPECT_TRUE(awaited(1900ms));
  EXPECT_FALSE(awaited(2100ms));
  scene_->latencies.weigh(3);  // they exceed it
  EXPECT_TRUE(awaited(3100ms));
  EXPECT_FALSE(awaited(3300ms));
}

TEST_F(TwoMonitors, ARuleThatCannotSeeIsNotWaitedFor) {
  state("A").detection.trigger = Slot();
  EXPECT_FALSE(awaited(100ms));
}

TEST_F(TwoMonitors, ARuleInItsCooldownIsNotWaitedFor) {
  state("A").quiet_until = scene_->now + 10s;
  EXPECT_FALSE(awaited(100ms));
}

// Its trigger stays true as long as that part of the mission lasts, and fires no more.
TEST(Awaited, AMissionRuleIsNotWaitedForOnceItHasActed) {
  std::string text = failure_of("a", "A", "ERROR ON_CHANGE") + failure_of("b", "B");
  text.replace(text.rfind("x > 1"), 5, "y > 1");
  Scene scene(text);
  scene.link("a", "b").fail("B", 9900ms);
  scene->latencies.weigh(-3);
  for (const char* rule : {"A", "B"})
    scene->signals.set_latency(scene.rules()[scene.rule(rule)].inputs.front(), 400ms);
  Detection& seen = scene->states.state(scene.rule("A")).detection;
  seen.trigger = Slot::of(true);
  const auto awaited = [&] {
    return Awaited(*scene, scene->states.active()).of(scene.rule("B")).has_value();
  };
  EXPECT_TRUE(awaited());
  EXPECT_TRUE(is_imminent(scene.rule("A"), *scene));
  seen.armed = false;
  EXPECT_FALSE(awaited());
  EXPECT_FALSE(is_imminent(scene.rule("A"), *scene));
}

TEST_F(TwoMonitors, ARuleDownstreamIsNotWaitedFor) {
  scene_.fail("A", 9900ms);
  EXPECT_FALSE(Awaited(*scene_, scene_->states.active()).of(scene_.rule("A")));
}

// How late it is was seen in an earlier failure.
TEST_F(TwoMonitors, ALateRuleIsWaitedForAsLongAsItWasLate) {
  scene_->latencies.cleared(scene_.rule("A"), 2s);
  EXPECT_TRUE(awaited(1900ms));
  EXPECT_FALSE(awaited(2100ms));
}

// B is as late as A, so that A would have been detected first.
TEST_F(TwoMonitors, TwoRulesThatAreEquallyLateNeedNotWait) {
  scene_->latencies.cleared(scene_.rule("A"), 2s);
  scene_->latencies.cleared(scene_.rule("B"), 2s);
  EXPECT_TRUE(awaited(300ms));
  EXPECT_FALSE(awaited(500ms));
}

// A minimum over 3 s shows a bad value when all of the 3 s are bad.
TEST(Awaited, ARuleOverAWindowIsWaitedForUntilTheWindowIsFull) {
  std::string text = failure_of("a", "A") + failure_of("b", "B");
  text.replace(text.rfind("x > 1"), 5, "y > 1");
  text.replace(text.find("x > 1"), 5, "min(x, 3s) > 1");
  Scene scene(text);
  scene.link("a", "b");
  scene->latencies.weigh(-3);
  scene->signals.set_latency(scene.rules()[scene.rule("A")].inputs.front(), 3400ms);
  scene->signals.set_latency(scene.rules()[scene.rule("B")].inputs.front(), 400ms);
  scene->states.state(scene.rule("A")).detection.trigger = Slot::of(false);
  const auto awaited = [&](Duration detected_ago) {
    scene.fail("B", 10s - detected_ago);
    return Awaited(*scene, scene->states.active()).of(scene.rule("B")).has_value();
  };
  EXPECT_TRUE(awaited(3399ms));
  EXPECT_FALSE(awaited(3401ms));
}

// A recovered a moment ago; what B shows may be the echo of that.
TEST_F(TwoMonitors, AFailureMayBeTheEchoOfOneThatCleared) {
  state("A").onset = Onset{scene_->now - 2s, scene_->now - 1500ms};
  state("A").gone_since = scene_->now - 500ms;
  const auto echo = awaited(900ms);
  ASSERT_TRUE(echo);
  EXPECT_TRUE(echo->is_echo);
  state("A").gone_since = scene_->now - 2s;
  EXPECT_FALSE(awaited(900ms)) << "that was too long ago";
}

// A was given up, and comes and goes by itself: it has not cleared yet, but is not there any more.
TEST_F(TwoMonitors, AFailureMayBeTheEchoOfAnExhaustedOneThatIsAboutToClear) {
  state("A").onset = Onset{scene_->now - 2s, scene_->now - 1500ms};
  scene_->states.enter(scene_.rule("A"), RulePhase::kExhausted);
  state("A").detection.trigger_since = scene_->now - 10ms;
  const auto echo = awaited(900ms);
  ASSERT_TRUE(echo);
  EXPECT_EQ(echo->because, scene_.rule("A"));
  EXPECT_TRUE(echo->is_echo);
}

// However long ago it was detected.
TEST_F(TwoMonitors, AnOldFailureMayBeAnEcho) {
  scene_.fail("A", -10min);
  scene_->states.enter(scene_.rule("A"), RulePhase::kQuiet);
  state("A").gone_since = scene_->now - 500ms;
  EXPECT_TRUE(awaited(9min));
}

// A began after B: its recovery is no evidence about B.
TEST_F(TwoMonitors, WhatBeganLaterHasNoEchoInAnEarlierFailure) {
  scene_.fail("A", 9s);
  state("A").onset = Onset{scene_->now - 1500ms, scene_->now - 1s};
  scene_->states.enter(scene_.rule("A"), RulePhase::kQuiet);
  state("A").gone_since = scene_->now - 500ms;
  EXPECT_FALSE(awaited(3s));
}

// A strategy had the component begin anew: its own rule and those downstream show that later.
TEST_F(TwoMonitors, AFailureMayShowThatAStrategyTookItsComponentDown) {
  state("A").detection.trigger = Slot();  // nothing else is waited for
  const StrategyId strategy = scene_.strategy("B.restart");
  for (const char* component : {"a", "b"}) {
    scene_->components[scene_.component("a")].begun_anew.reset();
    scene_->components[scene_.component(component)].begun_anew =
        BegunAnew{strategy, scene_->now - 1500ms, scene_->now - 500ms};
    const auto echo = awaited(400ms);
    ASSERT_TRUE(echo) << component;
    EXPECT_EQ(echo->component, scene_.component(component));
    EXPECT_FALSE(awaited(2500ms)) << component << ": it failed before";
  }
}

// One status tells of both: neither is later than the other.
TEST(Awaited, RulesOfOneMonitorDoNotWaitForOneAnother) {
  std::string text = failure_of("a", "A") + failure_of("b", "B") +
                     "SIGNAL x DIAGNOSTIC board KEY x\nSIGNAL y DIAGNOSTIC board KEY y\n";
  text.replace(text.find("x > 1", text.find("RULE B")), 5, "y > 1");
  Scene scene(text);
  scene.link("a", "b").fail("B", 9900ms);
  scene->states.state(scene.rule("A")).detection.trigger = Slot::of(false);
  for (const char* rule : {"A", "B"})
    scene->signals.set_latency(scene.rules()[scene.rule(rule)].inputs.front(), 100ms);
  EXPECT_FALSE(Awaited(*scene, scene->states.active()).of(scene.rule("B")));
}

// Its topic has sent since the failure began: it has no outage, and its threshold does not matter.
TEST(Awaited, ATopicThatSentSinceTheOnsetIsProof) {
  std::string text = failure_of("a", "A") + failure_of("b", "B");
  text.replace(text.find("x > 1"), 5, "age(/out) > 3s");
  Scene scene(text);
  scene.link("a", "b").fail("B", 9900ms);
  scene->states.state(scene.rule("A")).detection.trigger = Slot::of(false);
  const auto awaited = [&] {
    return Awaited(*scene, scene->states.active()).of(scene.rule("B")).has_value();
  };
  scene->signals.set_rhythm(TopicId(0), {scene->now - 350ms, 200ms, 200ms});
  EXPECT_TRUE(awaited());
  scene->signals.set_rhythm(TopicId(0), {scene->now - 50ms, 200ms, 200ms});
  EXPECT_FALSE(awaited());
}

// A rail that is off ends the data of what hangs on it: that is shown with its next reading, every 200 ms, the
// lateness of its monitor, and a cycle.
TEST(Awaited, AnOutageWaitsForTheValueOfADeclaredSupplier) {
  std::string text = failure_of("a", "A") + failure_of("b", "B") + "DEPENDENCY b ON a\n";
  text.replace(text.rfind("x > 1"), 5, "age(/out) > 500ms");
  Scene scene(text);
  scene.fail("B", 9900ms);
  scene->signals.set_latency(scene.rules()[scene.rule("A")].inputs.front(), 400ms);
  scene->states.state(scene.rule("A")).detection.trigger = Slot::of(false);
  const auto awaited = [&](Duration began_ago) {
    const Time onset = scene->now - began_ago;
    scene->states.state(scene.rule("B")).onset = Onset{onset - 100ms, onset};
    return Awaited(*scene, scene->states.active()).of(scene.rule("B"));
  };
  const Duration shown = 400ms + scene->latencies.lateness(scene.rule("A")).most;
  ASSERT_TRUE(awaited(shown - 1ms));
  EXPECT_EQ(awaited(shown - 1ms)->because, scene.rule("A"));
  EXPECT_FALSE(awaited(shown + 1ms));
}

// It was seen to clear with the rule of a value, though nothing declares that it depends on it.
TEST(Awaited, AnOutageWaitsForTheValueOfALearnedSupplier) {
  std::string text = failure_of("a", "A") + failure_of("b", "B");
  text.replace(text.rfind("x > 1"), 5, "age(/out) > 500ms");
  Scene scene(text);
  scene.fail("B", 9900ms);
  scene->states.state(scene.rule("B")).onset = Onset{scene->now - 200ms, scene->now - 100ms};
  scene->states.state(scene.rule("A")).detection.trigger = Slot::of(false);
  const auto is_awaited = [&] {
    return Awaited(*scene, scene->states.active()).of(scene.rule("B")).has_value();
  };
  scene->couplings.cleared(scene.rule("A"), scene.rule("B"));
  EXPECT_FALSE(is_awaited()) << "once may be chance";
  for (int i = 0; i < 3; ++i) scene->couplings.cleared(scene.rule("A"), scene.rule("B"));
  EXPECT_TRUE(is_awaited());
}

// Bad data ends no data: neither a value that can still show, nor one that cleared a moment ago.
TEST(Awaited, AnOutageWaitsForNoBadValue) {
  std::string text = failure_of("a", "A") + failure_of("b", "B");
  text.replace(text.rfind("x > 1"), 5, "age(/out) > 500ms");
  Scene scene(text);
  scene.link("a", "b").fail("B", 9900ms);
  scene->states.state(scene.rule("B")).onset = Onset{scene->now - 600ms, scene->now - 500ms};
  scene->states.state(scene.rule("A")).detection.trigger = Slot::of(false);
  scene->states.state(scene.rule("A")).gone_since = scene->now - 100ms;
  EXPECT_FALSE(Awaited(*scene, scene->states.active()).of(scene.rule("B")));
}

}  // namespace
}  // namespace culprit::diagnose
