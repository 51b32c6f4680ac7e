// The monitor on the process, the node, the answers and the transitions of a component.
#include <gtest/gtest.h>

#include "monitor/monitor.h"
#include "monitor/test_watched.h"

namespace culprit::test {
namespace {

using namespace std::chrono_literals;

TEST(Monitor, KnowsWhetherAComponentIsAlive) {
  Watched watched(rule("!alive(c)"));
  const auto alive = [&] { return watched.knowledge.components[ComponentId(0)].alive; };
  EXPECT_EQ(alive(), std::nullopt);
  watched.observe(1s, NodeAppeared{"/c", 7});
  EXPECT_EQ(alive(), true);
  watched.observe(2s, ProcessSeen{ComponentId(0), ProcessState::kStopped, 7, ""});
  EXPECT_EQ(alive(), false) << "stopped";
  watched.observe(3s, ProcessSeen{ComponentId(0), ProcessState::kRunning, 7, ""});
  EXPECT_EQ(alive(), true);
  watched.observe(4s, ProcessSeen{ComponentId(0), ProcessState::kGone, 7, "exit code 1"});
  EXPECT_EQ(alive(), false);
  watched.observe(5s, ProcessSeen{ComponentId(0), ProcessState::kRunning, 8, ""});
  EXPECT_EQ(alive(), false) << "the process is there, its node is not";
  watched.observe(6s, NodeAppeared{"/c", 8});
  EXPECT_EQ(alive(), true);
  watched.observe(7s, ProcessSeen{ComponentId(0), ProcessState::kGone, 7, "late news"});
  EXPECT_EQ(alive(), true) << "the old process's end says nothing about the new one";
}

// A mode manager offers services in the names of nodes.
TEST(Monitor, TellsTheProcessOfANodeAlsoIfItWasFirstTakenForThatOfItsManager) {
  Watched watched(rule("!alive(c)"));
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(2s, NodeAppeared{"/c", 8});
  watched.observe(3s, NodeAppeared{"/c", 8});
  std::vector<int> told;
  for (const Event& event : watched.knowledge.events) {
    if (const auto* found = std::get_if<ComponentFound>(&event.what)) told.push_back(found->pid);
  }
  EXPECT_EQ(told, (std::vector<int>{7, 8}));
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].node_pid, 8);
}

TEST(Monitor, AComponentWhoseComputerCannotBeAskedIsNeitherAliveNorDead) {
  Watched watched(rule("!alive(c)"));
  const auto alive = [&] { return watched.knowledge.components[ComponentId(0)].alive; };
  watched.observe(1s, NodeAppeared{"/c", 0});
  watched.observe(2s, HostReached{ComponentId(0), false});
  EXPECT_EQ(alive(), true) << "it is heard";
  watched.observe(3s, NodeVanished{"/c"});
  EXPECT_EQ(alive(), std::nullopt);
  EXPECT_FALSE(watched.knowledge.signals[InputId(0)].known);
  watched.observe(14s, HostReached{ComponentId(0), true});
  EXPECT_EQ(alive(), false) << "it had the time to be heard";
  watched.observe(15s, NodeAppeared{"/c", 0});
  EXPECT_EQ(alive(), true);
  watched.observe(16s, ProcessSeen{ComponentId(0), ProcessState::kGone, 0, "c.service failed"});
  watched.observe(17s, HostReached{ComponentId(0), false});
  EXPECT_EQ(alive(), false) << "what its owner said is proof";
}

TEST(Monitor, LosesAComponentThatDoesNotAnswerProbes) {
  Watched watched(rule("!alive(c)"));
  watched.observe(1s, NodeAppeared{"/c", 0});
  watched.observe(2s, Probed{ComponentId(0), false});
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].alive, true) << "one answer may be lost";
  watched.observe(3s, Probed{ComponentId(0), false});
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].alive, false);
  watched.observe(4s, Probed{ComponentId(0), true});
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].alive, true);
}

TEST(Monitor, ForgetsTheStateOfAProcessThatIsGone) {
  Watched watched(rule("lifecycle(c) == \"active\" || parameter(c, p) > 1 || parameter(d, p) > 1"));
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(1s, LifecycleRead{ComponentId(0), Lifecycle::kActive});
  watched.observe(1s, ParameterRead{ParameterId(0), Value(2.0)});
  watched.observe(1s, ParameterRead{ParameterId(1), Value(2.0)});
  EXPECT_TRUE(watched.knowledge.signals[InputId(0)].known &&
              watched.knowledge.signals[InputId(1)].known);
  watched.observe(2s, ProcessSeen{ComponentId(0), ProcessState::kGone, 7, ""});
  EXPECT_FALSE(watched.knowledge.signals[InputId(0)].known ||
               watched.knowledge.signals[InputId(1)].known);
  EXPECT_TRUE(watched.knowledge.signals[InputId(2)].known) << "of another component";
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].intended_lifecycle, Lifecycle::kActive);
}

TEST(Monitor, ANodeIsOfARunningProcessUnlessItsOwnIsKnownToBeStopped) {
  Watched watched(rule("!alive(c)"));
  const auto process = [&] { return watched.knowledge.components[ComponentId(0)].process; };
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(2s, ProcessSeen{ComponentId(0), ProcessState::kStopped, 7, ""});
  watched.observe(3s, NodeAppeared{"/c", 7});
  EXPECT_EQ(process(), ProcessState::kStopped) << "it was only discovered anew";
  watched.observe(4s, ProcessSeen{ComponentId(0), ProcessState::kGone, 7, ""});
  watched.observe(5s, NodeAppeared{"/c", 8});
  EXPECT_EQ(process(), ProcessState::kRunning);
}

TEST(Monitor, ANodeThatIsOnlyDiscoveredAnewIsAsItWas) {
  Watched watched(rule("lifecycle(c) == \"active\""));
  const auto lifecycle = [&] { return watched.knowledge.components[ComponentId(0)].lifecycle; };
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(1s, LifecycleRead{ComponentId(0), Lifecycle::kActive});
  watched.observe(2s, NodeAppeared{"/c", 7});
  EXPECT_EQ(lifecycle(), Lifecycle::kActive);
  watched.observe(3s, NodeAppeared{"/c", 0});
  watched.observe(3s, LifecycleRead{ComponentId(0), Lifecycle::kActive});
  watched.observe(4s, NodeAppeared{"/c", 0});
  EXPECT_EQ(lifecycle(), Lifecycle::kUnknown) << "of another machine it may be another process";
}

// A restart that was interrupted left it inactive, or its deactivation may still come.
struct Owed : Watched {
  Owed() : Watched(rule("!alive(c)")) {
    monitor.remember(
        {Event{Time(0s), LifecycleIntended{ComponentId(0), Lifecycle::kActive, true}}});
    observe(1s, NodeAppeared{"/c", 7});
  }
  void read(Duration at, Lifecycle state) { observe(at, LifecycleRead{ComponentId(0), state}); }
  const ComponentState& state() const { return knowledge.components[ComponentId(0)]; }
  // As the next process of culprit learns it.
  bool is_said_to_be_owed() const {
    bool is_owed = true;
    for (const Event& event : knowledge.events) {
      if (const auto* intended = std::get_if<LifecycleIntended>(&event.what))
        is_owed = intended->is_owed;
    }
    return is_owed;
  }
};

TEST(Monitor, APersonMayDeactivateWhatIsActiveAgain) {
  Owed watched;
  watched.read(1s, Lifecycle::kInactive);
  EXPECT_TRUE(watched.state().is_to_be_given_back());
  EXPECT_EQ(watched.state().intended_lifecycle, Lifecycle::kActive);
  watched.read(2s, Lifecycle::kActive);
  EXPECT_FALSE(watched.state().is_to_be_given_back());
  EXPECT_FALSE(watched.is_said_to_be_owed()) << "else the next culprit undoes what a person did";
  watched.read(5s, Lifecycle::kInactive);
  EXPECT_EQ(watched.state().intended_lifecycle, Lifecycle::kInactive);
}

TEST(Monitor, ANewProcessThatComesUpActiveIsOwedNothing) {
  Owed watched;
  watched.read(1s, Lifecycle::kInactive);
  watched.observe(2s, NodeVanished{"/c"});
  watched.observe(3s, NodeAppeared{"/c", 8});
  EXPECT_TRUE(watched.state().is_to_be_given_back());
  watched.read(3s, Lifecycle::kActive);
  EXPECT_FALSE(watched.state().is_to_be_given_back());
  EXPECT_FALSE(watched.is_said_to_be_owed());
}

TEST(Monitor, ALateAnswerToAnAbandonedDeactivationIsNobodysWish) {
  Owed watched;
  watched.read(1s, Lifecycle::kActive);
  watched.read(4s, Lifecycle::kInactive);
  EXPECT_TRUE(watched.state().is_to_be_given_back());
  EXPECT_EQ(watched.state().intended_lifecycle, Lifecycle::kActive);
  EXPECT_TRUE(watched.is_said_to_be_owed());
}

TEST(Monitor, APersonMayDeactivateWhatAnAbandonedRestartLeftActive) {
  Owed watched;
  watched.read(1s, Lifecycle::kActive);
  watched.read(300s, Lifecycle::kTransition);
  watched.read(301s, Lifecycle::kInactive);
  EXPECT_FALSE(watched.state().is_to_be_given_back());
  EXPECT_FALSE(watched.is_said_to_be_owed());
  EXPECT_EQ(watched.state().intended_lifecycle, Lifecycle::kInactive);
}

// As where `respawn` of a launch file starts a node again: it comes up unconfigured.
TEST(Monitor, NobodyIntendedTheStateThatANewProcessComesUpIn) {
  Watched watched(rule("!alive(c)"));
  const auto intended = [&] {
    return watched.knowledge.components[ComponentId(0)].intended_lifecycle;
  };
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(1s, LifecycleRead{ComponentId(0), Lifecycle::kActive});
  watched.observe(2s, NodeVanished{"/c"});
  watched.observe(3s, NodeAppeared{"/c", 8});
  watched.observe(3s, LifecycleRead{ComponentId(0), Lifecycle::kUnconfigured});
  EXPECT_EQ(intended(), Lifecycle::kActive);
  watched.observe(4s, NodeAppeared{"/c", 9});
  watched.observe(4s, LifecycleRead{ComponentId(0), Lifecycle::kUnconfigured});
  EXPECT_EQ(intended(), Lifecycle::kActive) << "its end was not seen";
  watched.observe(5s, LifecycleRead{ComponentId(0), Lifecycle::kInactive});
  EXPECT_EQ(intended(), Lifecycle::kInactive) << "somebody configured it";
  watched.observe(6s, NodeAppeared{"/c", 10});
  watched.observe(6s, LifecycleRead{ComponentId(0), Lifecycle::kTransition});
  watched.observe(6s, LifecycleRead{ComponentId(0), Lifecycle::kActive});
  EXPECT_EQ(intended(), Lifecycle::kActive) << "it was seen on its way";
}

// Its consumers need a moment after that, whether or not a failure was there beside.
TEST(Monitor, AnActivationEndsATroubleAndTheFirstReadingDoesNot) {
  Watched watched(rule("!alive(c)"));
  const auto& past = watched.knowledge.components[ComponentId(0)].past_trouble;
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(1s, LifecycleRead{ComponentId(0), Lifecycle::kActive});
  EXPECT_FALSE(past);
  watched.observe(20s, LifecycleRead{ComponentId(0), Lifecycle::kInactive});
  watched.observe(140s, LifecycleRead{ComponentId(0), Lifecycle::kActive});
  ASSERT_TRUE(past);
  EXPECT_EQ(past->over - past->since, 120s);
}

// The node was in the graph all the time.
TEST(Monitor, TheEndOfOneOfSeveralProcessesIsNoTroubleOfTheOneThatStays) {
  Watched watched(rule("!alive(c)"));
  const auto& troubled = watched.knowledge.components[ComponentId(0)].troubled;
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(2s, NamesakesSeen{"/c", 1});
  watched.observe(3s, ProcessSeen{ComponentId(0), ProcessState::kGone, 7, "exit code 1"});
  EXPECT_TRUE(troubled);
  watched.observe(4s, NodeAppeared{"/c", 8});
  EXPECT_FALSE(troubled);
  watched.observe(5s, NamesakesSeen{"/c", 0});
  watched.observe(3600s, ProcessSeen{ComponentId(0), ProcessState::kGone, 8, "exit code 1"});
  ASSERT_TRUE(troubled);
  EXPECT_EQ(troubled->latest, Time(3600s));
}

TEST(Monitor, AnInactiveProcessIsNoTroubleOfTheUnmanagedOneThatReplacesIt) {
  Watched watched(rule("!alive(c)"));
  const auto& troubled = watched.knowledge.components[ComponentId(0)].troubled;
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(1s, LifecycleRead{ComponentId(0), Lifecycle::kInactive});
  EXPECT_TRUE(troubled);
  watched.observe(2s, NodeAppeared{"/c", 8});
  EXPECT_FALSE(troubled);
}

constexpr const char* kHeard = "!alive(c) || age(/t) > 1h";

// Its process is known, it publishes /t every 100 ms until `end`, and answers until then.
void work_until(Watched& watched, Duration end) {
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(1s, EndpointAppeared{"/c", EndpointKind::kPublisher, "/t"});
  for (Duration at = 1s; at < end; at += 100ms) watched.observe(at, SampleArrived{TopicId(0), 1});
  watched.observe(end, Probed{ComponentId(0), true});
}

// The topic came every 100 ms before these pauses.
std::optional<SignalStore::Rhythm::Silence> silence_after(std::initializer_list<Duration> pauses) {
  Watched watched(rule(kHeard));
  work_until(watched, 5s);
  Duration at = 4900ms;
  for (const Duration pause : pauses) watched.observe(at += pause, SampleArrived{TopicId(0), 1});
  return watched.knowledge.signals.rhythm(TopicId(0)).silence;
}

TEST(Monitor, ASilenceIsOverWithAMessage) {
  const auto silence = silence_after({3s});
  ASSERT_TRUE(silence);
  EXPECT_EQ(silence->over - silence->since, 3s);
  EXPECT_TRUE(silence_after({3s, 100ms, 100ms, 100ms}));
  EXPECT_TRUE(silence_after({3s, 250ms, 100ms})) << "it comes irregularly at first";
  EXPECT_FALSE(silence_after({240ms, 100ms})) << "one message is late";
}

// The first of its slow gaps is as long as the others.
TEST(Monitor, ATopicThatBecomesSlowWasNotSilent) {
  for (const Duration gap : {240ms, 340ms, 500ms, 1000ms, 3000ms})
    EXPECT_FALSE(silence_after({gap, gap, gap, gap, gap, gap, gap, gap})) << gap.count();
}

TEST(Monitor, NotesSinceWhenAnswersAreMissing) {
  Watched watched(rule(kHeard));
  work_until(watched, 5s);
  const ComponentState& state = watched.knowledge.components[ComponentId(0)];
  const Time begin = state.answered;
  watched.observe(6s, Probed{ComponentId(0), false});
  watched.observe(7s, Probed{ComponentId(0), true});
  watched.observe(8s, Probed{ComponentId(0), false});
  watched.observe(9s, Probed{ComponentId(0), false});
  EXPECT_EQ(state.missed_since - begin, 4s) << "one alone may be lost";
}

TEST(Monitor, ALocalNodeHangsThatNeitherAnswersNorPublishes) {
  Watched watched(rule(kHeard));
  const auto is_alive = [&] { return watched.knowledge.components[ComponentId(0)].alive; };
  work_until(watched, 5s);
  watched.observe(5400ms, Probed{ComponentId(0), false});
  watched.observe(5800ms, Probed{ComponentId(0), false});
  EXPECT_EQ(is_alive(), true) << "it was heard a moment ago";
  watched.observe(6200ms, Probed{ComponentId(0), false});
  EXPECT_EQ(is_alive(), false);
  watched.observe(6300ms, Probed{ComponentId(0), true});
  EXPECT_EQ(is_alive(), true);
}

TEST(Monitor, ALocalNodeIsAtWorkThatPublishesOrPausesAsEver) {
  Watched watched(rule(kHeard));
  const auto is_alive = [&] { return watched.knowledge.components[ComponentId(0)].alive; };
  work_until(watched, 5s);
  for (Duration at = 5s; at < 8s; at += 100ms) {
    watched.observe(at, SampleArrived{TopicId(0), 1});
    watched.observe(at, Probed{ComponentId(0), false});
  }
  EXPECT_EQ(is_alive(), true) << "it is busy";
  watched.observe(8s, Probed{ComponentId(0), true});
  watched.observe(11s, SampleArrived{TopicId(0), 1});  // a pause of 3.1 s, and it was well
  for (Duration at = 11s; at < 15s; at += 400ms) watched.observe(at, Probed{ComponentId(0), false});
  EXPECT_EQ(is_alive(), true);
  watched.observe(16s, Probed{ComponentId(0), false});
  EXPECT_EQ(is_alive(), false);
}

// Real robots showed it: after an outage of its camera, a detector that hung was taken for busy for as long as that had been.
TEST(Monitor, WhatALocalNodeWasSilentForWhileWhatItNeedsWasDownIsNoPauseOfItsOwn) {
  Watched watched("COMPONENT d NODE /d\n" + rule(kHeard));
  const auto probe = [&](Duration at, bool answers) {
    watched.observe(at, Probed{ComponentId(1), answers});
  };
  watched.observe(1s, NodeAppeared{"/d", 8});
  watched.observe(1s, EndpointAppeared{"/d", EndpointKind::kPublisher, "/in"});
  watched.observe(1s, EndpointAppeared{"/c", EndpointKind::kSubscriber, "/in"});
  work_until(watched, 5s);
  probe(5s, true);
  watched.observe(5s, NodeVanished{"/d"});
  watched.observe(8s, NodeAppeared{"/d", 9});
  watched.observe(8s, EndpointAppeared{"/d", EndpointKind::kPublisher, "/in"});
  for (Duration at = 8200ms; at < 10s; at += 100ms)
    watched.observe(at, SampleArrived{TopicId(0), 1});
  for (const Duration at : {10400ms, 10800ms, 11200ms}) probe(at, false);
  EXPECT_EQ(watched.knowledge.components[ComponentId(1)].alive, false);
}

TEST(Monitor, ALocalNodeIsNotAtWorkBecauseAnotherOnePublishes) {
  Watched watched(rule("!alive(c) || age(/t) > 1h || age(/u) > 1h || age(/v) > 1h"));
  work_until(watched, 5s);
  watched.observe(5s, NodeAppeared{"/d", 8});
  for (const char* topic : {"/u", "/v"})
    watched.observe(5s, EndpointAppeared{"/d", EndpointKind::kPublisher, topic});
  watched.observe(5s, EndpointAppeared{"/c", EndpointKind::kPublisher, "/v"});
  for (Duration at = 5s; at < 8s; at += 100ms) {
    watched.observe(at, SampleArrived{TopicId(1), 1});
    watched.observe(at, SampleArrived{TopicId(2), 1});
    watched.observe(at, Probed{ComponentId(0), false});
  }
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].alive, false);
}

// As one in a container may be, or on another computer.
TEST(Monitor, ANodeOfAnUnknownProcessIsAtWorkWhileItIsHeardToo) {
  Watched watched(rule(kHeard));
  watched.observe(1s, NodeAppeared{"/c", 0});
  watched.observe(1s, EndpointAppeared{"/c", EndpointKind::kPublisher, "/t"});
  for (Duration at = 1s; at < 5s; at += 100ms) {
    watched.observe(at, SampleArrived{TopicId(0), 1});
    watched.observe(at, Probed{ComponentId(0), at < 3s});
  }
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].alive, true) << "it is busy";
  watched.observe(5800ms, Probed{ComponentId(0), false});
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].alive, true);
  watched.observe(6s, Probed{ComponentId(0), false});
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].alive, false);
}

TEST(Monitor, ANodeThatNeverAnsweredProvesNothingByNotAnswering) {
  Watched watched(rule(kHeard));
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(1s, EndpointAppeared{"/c", EndpointKind::kPublisher, "/t"});
  for (Duration at = 1s; at < 3s; at += 100ms) watched.observe(at, SampleArrived{TopicId(0), 1});
  for (Duration at = 3s; at < 60s; at += 400ms) watched.observe(at, Probed{ComponentId(0), false});
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].alive, true);
}

TEST(Monitor, ALocalNodeOfWhichNothingElseIsHeardHangsIfItDoesNotAnswerForLong) {
  Watched watched(rule("!alive(c)"));
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(1s, Probed{ComponentId(0), true});
  for (Duration at = 2s; at < 3600ms; at += 400ms)
    watched.observe(at, Probed{ComponentId(0), false});
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].alive, true);
  watched.observe(3600ms, Probed{ComponentId(0), false});
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].alive, false);
}

TEST(Monitor, ALocalNodeThatWasHeardOnceIsGivenAsLongAsOneThatNeverWas) {
  Watched watched(rule(kHeard));
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(1s, EndpointAppeared{"/c", EndpointKind::kPublisher, "/t"});
  watched.observe(1s, SampleArrived{TopicId(0), 1});
  watched.observe(1s, Probed{ComponentId(0), true});
  for (Duration at = 3s; at < 4600ms; at += 400ms)
    watched.observe(at, Probed{ComponentId(0), false});
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].alive, true) << "it has no rhythm yet";
  watched.observe(4600ms, Probed{ComponentId(0), false});
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].alive, false);
}

TEST(Monitor, EndsOfANodeThatBeganAnewAreAwaitedForAWhile) {
  Watched watched(
      "COMPONENT c NODE /c\nCOMPONENT d NODE /d\nRULE R\nPOLICIES ERROR\n"
      "TRIGGER !alive(c) || !alive(d)\nSTRATEGY s 50 10\nADAPTATION c activate 1\n");
  const auto depends = [&] { return !watched.knowledge.graph.upstream(ComponentId(0)).empty(); };
  const auto& c = watched.knowledge.components[ComponentId(0)];
  const EndpointAppeared end{"/c", EndpointKind::kSubscriber, "/from_d"};
  watched.observe(1s, NodeAppeared{"/d", 6});
  watched.observe(1s, EndpointAppeared{"/d", EndpointKind::kPublisher, "/from_d"});
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(1s, end);
  const auto begins_anew = [&](Duration at, int pid) {
    watched.observe(at, EndpointVanished{"/c", EndpointKind::kSubscriber, "/from_d"});
    watched.observe(at, NodeVanished{"/c"});
    watched.observe(at, NodeAppeared{"/c", pid});
  };
  begins_anew(2s, 8);
  EXPECT_TRUE(depends()) << "it opens its device first";
  EXPECT_GT(c.awaits_ends_until, Time(2s));
  watched.observe(5s, end);
  EXPECT_TRUE(depends());
  EXPECT_EQ(c.awaits_ends_until, kLongAgo);
  EXPECT_EQ(c.ends_back, Time(5s));
  begins_anew(6s, 9);
  watched.monitor.advance(Time(15900ms));
  EXPECT_TRUE(depends());
  watched.monitor.advance(Time(16s));
  EXPECT_FALSE(depends()) << "it does not have that end any more";
}

// `run --launch` brings nodes up before the manager begins, which sees them only then.
TEST(Monitor, ANodeThatCulpritBroughtUpBeforeAndThatCrashedIsLeftToItself) {
  Watched watched(rule("!alive(c)"));
  const auto& c = watched.knowledge.components[ComponentId(0)];
  const ComingUp by_culprit{ComingUp::Driver::kCulprit, 300ms, 50ms};
  watched.monitor.remember(History{{Time(3s), CameUp{ComponentId(0), by_culprit}}});
  watched.observe(5s, NodeAppeared{"/c", 7});
  watched.observe(5500ms, NodeVanished{"/c"});
  EXPECT_EQ(c.coming_up.driver, ComingUp::Driver::kOther);
  EXPECT_EQ(c.coming_up.rising, 2500ms) << "the next one is left more time than that";
  watched.monitor.remember(History{{Time(6s), CameUp{ComponentId(0), by_culprit}}});
  watched.observe(7s, NodeAppeared{"/c", 8});
  watched.observe(8s, NodeVanished{"/c"});
  EXPECT_EQ(c.coming_up.driver, ComingUp::Driver::kCulprit) << "that was another process";
}

TEST(Monitor, AManagedNodeHangsWhoseTransitionTakesMuchLongerThanEver) {
  Watched watched(rule("!alive(c) || lifecycle(c) != \"active\""));
  const auto& c = watched.knowledge.components[ComponentId(0)];
  watched.knowledge.components[ComponentId(0)].coming_up.rising = 1s;
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(1s, LifecycleRead{ComponentId(0), Lifecycle::kInactive});
  watched.observe(1s, Probed{ComponentId(0), true});
  watched.observe(2s, LifecycleRead{ComponentId(0), Lifecycle::kTransition});
  for (Duration at = 2s; at < 6s; at += 400ms) watched.observe(at, Probed{ComponentId(0), false});
  EXPECT_EQ(c.alive, true) << "it has one thread, and that one is at work";
  watched.observe(6s, Probed{ComponentId(0), false});
  EXPECT_EQ(c.alive, false);
  EXPECT_TRUE(c.hangs());
  watched.knowledge.components[ComponentId(0)].coming_up.rising = 5s;  // the next gets more
  watched.observe(6400ms, Probed{ComponentId(0), false});
  EXPECT_TRUE(c.hangs());
}

TEST(Monitor, ATransitionThatTakesTooLongIsAStateAlsoWhereTheNodeAnswers) {
  Watched watched(rule("lifecycle(c) != \"active\""));
  const auto fires = [&] { return watched.knowledge.signals[InputId(0)]; };
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(1s, LifecycleRead{ComponentId(0), Lifecycle::kTransition});
  watched.observe(60s, Probed{ComponentId(0), true});
  EXPECT_FALSE(fires().known) << "somebody else asked for it, and it may be slow";
  watched.observe(61s, Probed{ComponentId(0), true});
  EXPECT_TRUE(fires().known);
  watched.observe(61s, LifecycleRead{ComponentId(0), Lifecycle::kTransition});
  EXPECT_TRUE(fires().known) << "it is read again";
  watched.observe(62s, LifecycleRead{ComponentId(0), Lifecycle::kActive});
  EXPECT_TRUE(fires().known);
}

TEST(Monitor, EndsStayWhileANodeIsBroughtUp) {
  Watched watched(
      "COMPONENT c NODE /c\nCOMPONENT d NODE /d\nRULE R\nPOLICIES ERROR\n"
      "TRIGGER !alive(c) || !alive(d)\nSTRATEGY s 50 10\nADAPTATION c activate 1\n");
  const auto depends = [&] { return !watched.knowledge.graph.upstream(ComponentId(0)).empty(); };
  const EndpointVanished gone{"/c", EndpointKind::kSubscriber, "/from_d"};
  watched.observe(1s, NodeAppeared{"/d", 6});
  watched.observe(1s, EndpointAppeared{"/d", EndpointKind::kPublisher, "/from_d"});
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(1s, EndpointAppeared{"/c", EndpointKind::kSubscriber, "/from_d"});
  watched.observe(1s, LifecycleRead{ComponentId(0), Lifecycle::kActive});
  EXPECT_TRUE(depends());
  watched.observe(2s, gone);
  watched.observe(2s, NodeVanished{"/c"});
  watched.observe(3s, NodeAppeared{"/c", 8});
  watched.observe(3s, LifecycleRead{ComponentId(0), Lifecycle::kUnconfigured});
  EXPECT_TRUE(depends()) << "it is not configured yet";
  watched.observe(4s, LifecycleRead{ComponentId(0), Lifecycle::kActive});
  EXPECT_FALSE(depends()) << "it came up without that end";
}

}  // namespace
}  // namespace culprit::test
