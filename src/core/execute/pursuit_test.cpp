// One goal, request by request: nothing is changed without looking first, and nothing twice.
#include "execute/pursuit.h"

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit::execute {
namespace {

using namespace std::chrono_literals;

constexpr Time kStart{100s};

struct One {
  RuleSet rules =
      *check(Source("one.rules",
                    "COMPONENT c NODE /c LAUNCH \"c\"\nRULE Dead\nPOLICIES ERROR\n"
                    "TRIGGER !alive(c)\nSTRATEGY again 90 10\nADAPTATION c redeploy 5\n"))
           .rules;
  Knowledge knowledge{rules};
  ComponentId c{0};

  ComponentState& state() { return knowledge.components[c]; }
  // A process, and whether its node is in the graph.
  void runs(int pid, bool in_graph) {
    state().pid = pid;
    state().process = ProcessState::kRunning;
    state().in_graph = in_graph;
    state().node_pid = in_graph ? pid : 0;
  }
};

template <class What>
bool is(const std::optional<Pursuit::Request>& request) {
  return request && std::holds_alternative<What>(*request);
}

Reply done(decltype(Reply::value) value = {}) { return {{}, Outcome::kDone, std::move(value), ""}; }

// ---- a process that may have been started before culprit ended

TEST(PursuitOfAProcess, StartsNoneWhereAnotherHasTakenTheOldOnesPlace) {
  One one;
  one.runs(8, true);
  Pursuit pursuit(PresentGoal{7}, one.c, kStart);
  EXPECT_FALSE(pursuit.advance(one.knowledge, kStart));
  EXPECT_TRUE(pursuit.is_reached());
  EXPECT_FALSE(pursuit.has_changed_anything());
}

TEST(PursuitOfAProcess, WaitsForOneThatRunsAndIsNotInTheGraphYet) {
  One one;
  one.runs(8, false);
  Pursuit pursuit(PresentGoal{7}, one.c, kStart);
  EXPECT_FALSE(pursuit.advance(one.knowledge, kStart));
  EXPECT_TRUE(pursuit.is_under_way());
  one.runs(8, true);
  EXPECT_FALSE(pursuit.advance(one.knowledge, kStart + 1s));
  EXPECT_TRUE(pursuit.is_reached());
  EXPECT_FALSE(pursuit.has_changed_anything());
}

TEST(PursuitOfAProcess, StartsNoneBesideOneThatWasStopped) {
  One one;
  one.runs(8, false);
  one.state().process = ProcessState::kStopped;
  Pursuit pursuit(PresentGoal{7}, one.c, kStart);
  for (int s = 0; pursuit.is_under_way() && s < 1000; ++s)
    EXPECT_FALSE(pursuit.advance(one.knowledge, kStart + s * 1s));
  EXPECT_FALSE(pursuit.is_under_way());
  EXPECT_FALSE(pursuit.is_reached());
}

TEST(PursuitOfAProcess, StartsOneWhereTheOldOneIsGone) {
  One one;
  one.runs(7, false);
  one.state().process = ProcessState::kGone;
  Pursuit pursuit(PresentGoal{7}, one.c, kStart);
  EXPECT_TRUE(is<StartProcess>(pursuit.advance(one.knowledge, kStart)));
}

// ---- how long it is waited for

// Until when it is waited for a process that was started and whose node does not come.
Duration waits(Duration works_until) {
  One one;
  Pursuit pursuit(PresentGoal{}, one.c, kStart);
  EXPECT_TRUE(is<StartProcess>(pursuit.advance(one.knowledge, kStart)));
  one.runs(7, false);
  pursuit.answered(done(Value(std::int64_t{7})), kStart);
  Duration at{};
  for (; pursuit.is_under_way() && at < 1h; at += 100ms) {
    if (at <= works_until) one.state().worked = kStart + at;
    pursuit.advance(one.knowledge, kStart + at);
  }
  EXPECT_EQ(pursuit.is_under_way(), false);
  EXPECT_TRUE(pursuit.took_too_long());
  return at - 100ms;
}

TEST(PursuitOfAProcess, WaitsLongerForOneThatWorks) {
  EXPECT_EQ(waits(-1s), 60s) << "it runs and may wait for something";
  EXPECT_EQ(waits(30s), 60s);
  EXPECT_EQ(waits(90s), 110s);
  EXPECT_EQ(waits(1h), 300s) << "for good is too long";
}

TEST(PursuitOfAProcess, GivesMoreTimeToWhatTookTooLongBefore) {
  One one;
  const Adaptation& redeploy = one.rules.strategies[0].adaptations[0];
  const auto patience_of_start = [&] { return patience((*goals_of(redeploy, one.knowledge))[1]); };
  EXPECT_EQ(patience_of_start(), 20s);
  one.state().coming_up.joining = 60s;
  EXPECT_EQ(patience_of_start(), 240s);
}

TEST(PursuitOfAProcess, SaysOfWhatHangsThatItDoes) {
  One one;
  one.runs(7, true);
  one.state().alive = false;
  Pursuit pursuit(GoneGoal{}, one.c, kStart);
  const auto request = pursuit.advance(one.knowledge, kStart);
  ASSERT_TRUE(is<StopProcess>(request));
  EXPECT_TRUE(std::get<StopProcess>(*request).hangs);
}

// A node that gets SIGTERM at kStart, when it had not answered for `unanswered`; half a second later it is known to
// hang.
struct Ended {
  explicit Ended(Duration unanswered) {
    one.runs(7, true);
    one.state().alive = true;
    one.state().answers_probes = true;
    one.state().answered = kStart - unanswered;
    const auto stop = pursuit.advance(one.knowledge, kStart);
    EXPECT_TRUE(is<StopProcess>(stop));
    EXPECT_FALSE(std::get<StopProcess>(*stop).hangs);
  }
  std::optional<Pursuit::Request> when_it_hangs() {
    EXPECT_FALSE(pursuit.must_insist(one.knowledge));
    one.state().alive = false;
    return pursuit.advance(one.knowledge, kStart + 500ms);
  }
  One one;
  Pursuit pursuit{GoneGoal{}, one.c, kStart};
};

TEST(PursuitOfAProcess, SaysOnceMoreWhatIsKnownToHangOnlyWhileItIsEnded) {
  Ended ended(600ms);
  const auto again = ended.when_it_hangs();
  ASSERT_TRUE(is<StopProcess>(again));
  EXPECT_TRUE(std::get<StopProcess>(*again).hangs);
  EXPECT_EQ(std::get<StopProcess>(*again).pid, 7);
  EXPECT_FALSE(ended.pursuit.must_insist(ended.one.knowledge)) << "that is said once";
  EXPECT_FALSE(ended.pursuit.advance(ended.one.knowledge, kStart + 600ms));
}

TEST(PursuitOfAProcess, LetsOneEndInPeaceThatAnsweredWhenItWasAsked) {
  Ended ended(200ms);
  EXPECT_FALSE(ended.when_it_hangs()) << "who ends answers nothing any more";
}

TEST(PursuitOfAProcess, SaysNothingTwiceToSystemd) {
  Ended ended(600ms);
  ended.one.rules.components[0].unit = SystemdUnit{"c.service"};
  EXPECT_FALSE(ended.when_it_hangs());
}

TEST(PursuitOfALifecycle, EndsWhenTheNodeHangs) {
  One one;
  one.runs(7, true);
  one.state().alive = true;
  Pursuit pursuit(LifecycleGoal{}, one.c, kStart);
  ASSERT_TRUE(is<ReadLifecycle>(pursuit.advance(one.knowledge, kStart)));
  pursuit.answered(done(Lifecycle::kInactive), kStart);
  ASSERT_TRUE(is<ChangeLifecycle>(pursuit.advance(one.knowledge, kStart)));
  one.state().alive = false;
  EXPECT_FALSE(pursuit.advance(one.knowledge, kStart + 2s));
  EXPECT_EQ(pursuit.remark(), "it does not answer any more");
  EXPECT_TRUE(pursuit.took_too_long());
}

TEST(PursuitOfAProcess, EndsNoneThatHasTakenTheOldOnesPlace) {
  One one;
  one.runs(8, true);
  Pursuit pursuit(GoneGoal{7}, one.c, kStart);
  EXPECT_FALSE(pursuit.advance(one.knowledge, kStart));
  EXPECT_TRUE(pursuit.is_reached());
}

// systemd may have started another process before its report arrives that the old one has ended.
TEST(PursuitOfAProcess, IsOverWhenAnotherHasTakenThePlaceOfTheOneThatWasEnded) {
  One one;
  one.runs(7, true);
  Pursuit pursuit(GoneGoal{7}, one.c, kStart);
  ASSERT_TRUE(is<StopProcess>(pursuit.advance(one.knowledge, kStart)));
  one.runs(8, true);
  EXPECT_FALSE(pursuit.advance(one.knowledge, kStart + 1ms));
  EXPECT_FALSE(pursuit.is_reached()) << "it may be the wrong one";
  pursuit.answered(done(), kStart + 2ms);
  EXPECT_FALSE(pursuit.advance(one.knowledge, kStart + 3ms));
  EXPECT_TRUE(pursuit.is_reached());
}

// systemd knows the processes of a unit, also those of other users, which culprit may not see.
TEST(PursuitOfAProcess, EndsAUnitOfWhichTheProcessIsNotKnown) {
  One one;
  one.runs(0, true);
  Pursuit of_nobody(GoneGoal{}, one.c, kStart);
  EXPECT_FALSE(of_nobody.advance(one.knowledge, kStart));
  one.rules.components[0].unit = SystemdUnit{"c.service"};
  Pursuit of_systemd(GoneGoal{}, one.c, kStart);
  EXPECT_TRUE(is<StopProcess>(of_systemd.advance(one.knowledge, kStart)));
}

TEST(PursuitOfAProcess, BelievesNoAnswerWhileTheOperatingSystemSaysThatItRuns) {
  One one;
  one.runs(7, true);
  Pursuit pursuit(GoneGoal{}, one.c, kStart);
  ASSERT_TRUE(is<StopProcess>(pursuit.advance(one.knowledge, kStart)));
  pursuit.answered(done(), kStart + 1ms);
  EXPECT_FALSE(pursuit.advance(one.knowledge, kStart + 2ms));
  EXPECT_FALSE(pursuit.is_reached());
  one.state().process = ProcessState::kGone;
  one.state().in_graph = false;
  EXPECT_FALSE(pursuit.advance(one.knowledge, kStart + 3ms));
  EXPECT_TRUE(pursuit.is_reached());
}

// The process is its container's, which goes on.
TEST(PursuitOfAProcess, IsOverWhenAComposedNodeHasLeftTheGraph) {
  One one;
  one.rules.components[0].composed = Composition{"/box", "p", "p::C"};
  one.runs(7, true);
  Pursuit pursuit(GoneGoal{7}, one.c, kStart);
  ASSERT_TRUE(is<StopProcess>(pursuit.advance(one.knowledge, kStart)));
  pursuit.answered(done(), kStart + 1ms);
  EXPECT_FALSE(pursuit.advance(one.knowledge, kStart + 2ms));
  EXPECT_FALSE(pursuit.is_reached()) << "its node is there";
  one.state().in_graph = false;
  EXPECT_FALSE(pursuit.advance(one.knowledge, kStart + 1s));
  EXPECT_TRUE(pursuit.is_reached());
}

// An earlier culprit loaded it, and was killed before the answer arrived.
TEST(PursuitOfAProcess, BelievesAContainerThatAComposedNodeIsLoadedAlready) {
  One one;
  one.rules.components[0].composed = Composition{"/box", "p", "p::C"};
  one.runs(7, true);
  one.state().node_seen = kStart - 1s;
  Pursuit pursuit(PresentGoal{7}, one.c, kStart);
  ASSERT_TRUE(is<StartProcess>(pursuit.advance(one.knowledge, kStart)));
  pursuit.answered(done(), kStart + 1ms);
  EXPECT_FALSE(pursuit.advance(one.knowledge, kStart + 2ms));
  EXPECT_TRUE(pursuit.is_reached());
}

// ---- a state that is looked at before it is changed

TEST(PursuitOfALifecycle, ChangesNothingThatIsSoAlready) {
  One one;
  Pursuit pursuit(LifecycleGoal{Lifecycle::kActive, {}}, one.c, kStart);
  ASSERT_TRUE(is<ReadLifecycle>(pursuit.advance(one.knowledge, kStart)));
  pursuit.answered(done(Lifecycle::kActive), kStart);
  EXPECT_FALSE(pursuit.advance(one.knowledge, kStart));
  EXPECT_TRUE(pursuit.is_reached());
  EXPECT_FALSE(pursuit.has_changed_anything());
}

TEST(PursuitOfALifecycle, AsksForATransitionOnceThoughTheAnswerIsLost) {
  One one;
  Pursuit pursuit(LifecycleGoal{Lifecycle::kActive, {}}, one.c, kStart);
  int asked = 0;
  for (Time now = kStart; now < kStart + 30s && pursuit.is_under_way(); now += 50ms) {
    const auto request = pursuit.advance(one.knowledge, now);
    if (is<ReadLifecycle>(request)) pursuit.answered(done(Lifecycle::kInactive), now);
    if (is<ChangeLifecycle>(request)) ++asked;
  }
  EXPECT_EQ(asked, 1);
  EXPECT_FALSE(pursuit.is_reached());
}

TEST(PursuitOfAParameter, RestoresOnlyWhatIsAnother) {
  One one;
  const ParameterGoal goal{"gain", Value(0.5), ParameterGoal::Kind::kRestore, {}};
  Pursuit same(goal, one.c, kStart);
  ASSERT_TRUE(is<ReadParameter>(same.advance(one.knowledge, kStart)));
  same.answered(done(Value(0.5)), kStart);
  EXPECT_FALSE(same.advance(one.knowledge, kStart));
  EXPECT_TRUE(same.is_reached());
  Pursuit other(goal, one.c, kStart);
  ASSERT_TRUE(is<ReadParameter>(other.advance(one.knowledge, kStart)));
  other.answered(done(Value(0.7)), kStart);
  EXPECT_TRUE(is<SetParameter>(other.advance(one.knowledge, kStart)));
}

TEST(PursuitOfAParameter, RestoresItOnlyWhereNothingElseHasSetItSince) {
  One one;
  const ParameterGoal goal{"gain", Value(1.0), ParameterGoal::Kind::kRestore, {}, Value(2.0)};
  Pursuit ours(goal, one.c, kStart);
  ASSERT_TRUE(is<ReadParameter>(ours.advance(one.knowledge, kStart)));
  ours.answered(done(Value(2.0)), kStart);
  EXPECT_TRUE(is<SetParameter>(ours.advance(one.knowledge, kStart)));
  Pursuit theirs(goal, one.c, kStart);
  ASSERT_TRUE(is<ReadParameter>(theirs.advance(one.knowledge, kStart)));
  theirs.answered(done(Value(3.0)), kStart);
  EXPECT_FALSE(theirs.advance(one.knowledge, kStart));
  EXPECT_FALSE(theirs.is_reached());
  EXPECT_EQ(theirs.remark(), "something else has set it to 3.0 since");
}

// A process that came in another's place may be another version, without the parameter.
TEST(PursuitOfAParameter, HasNothingToRestoreWhereThereIsNone) {
  One one;
  const Reply none{{}, Outcome::kRefused, {}, "there is no parameter gain"};
  Pursuit restored(ParameterGoal{"gain", Value(0.5), ParameterGoal::Kind::kRestore, {}}, one.c,
                   kStart);
  ASSERT_TRUE(is<ReadParameter>(restored.advance(one.knowledge, kStart)));
  restored.answered(none, kStart);
  EXPECT_FALSE(restored.advance(one.knowledge, kStart));
  EXPECT_TRUE(restored.is_reached());
  EXPECT_EQ(restored.remark(), "nothing to restore: there is no parameter gain");
  Pursuit set(ParameterGoal{"gain", Value(0.5), ParameterGoal::Kind::kSet, {}}, one.c, kStart);
  ASSERT_TRUE(is<ReadParameter>(set.advance(one.knowledge, kStart)));
  set.answered(none, kStart);
  EXPECT_FALSE(set.advance(one.knowledge, kStart));
  EXPECT_FALSE(set.is_reached());
}

// ---- a parameter whose value is known

TEST(PursuitOfAParameter, DoesNotLookForWhatIsKnown) {
  One one;
  Pursuit pursuit(ParameterGoal{"gain", Value(0.7), ParameterGoal::Kind::kSet, Value(0.5)}, one.c,
                  kStart);
  EXPECT_TRUE(is<SetParameter>(pursuit.advance(one.knowledge, kStart)));
}

TEST(PursuitOfAParameter, LooksFirstForWhatIsNot) {
  One one;
  Pursuit pursuit(ParameterGoal{"gain", Value(0.7)}, one.c, kStart);
  EXPECT_TRUE(is<ReadParameter>(pursuit.advance(one.knowledge, kStart)));
}

TEST(Pursuit, ComparesListsAsListsAndInTheirType) {
  const auto text = [](const char* list) { return Value(std::string(list)); };
  EXPECT_EQ(in_type_of(text("[1,2]"), text("[0.5]")), text("[1.0, 2.0]"));
  EXPECT_EQ(in_type_of(text("[left]"), text("[\"a\", \"b\"]")), text("[\"left\"]"));
  EXPECT_EQ(in_type_of(text("[]"), text("[1]")), text("[]"));
  EXPECT_EQ(in_type_of(text("[left]"), text("plain")), text("[left]")) << "it is a text";
  EXPECT_EQ(in_type_of(text("[left]"), text("[right]")), text("[left]")) << "it was written so";
}

}  // namespace
}  // namespace culprit::execute
