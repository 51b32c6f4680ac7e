// Restart intensity, back-off and quiet periods, promise by promise (docs/governor.md).
#include "execute/limits.h"

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit::execute {
namespace {

using namespace std::chrono_literals;

constexpr Time kBegin{100s};

struct Two {
  RuleSet rules =
      *check(Source("two.rules",
                    "COMPONENT up NODE /up LAUNCH \"u\"\nCOMPONENT down NODE /down LAUNCH \"d\"\n"
                    "COMPONENT other NODE /other LAUNCH \"o\"\nDEPENDENCY down ON up\n"
                    "RULE Up\nPOLICIES ERROR\nTRIGGER !alive(up)\n"
                    "STRATEGY up_again 90 10\nADAPTATION up redeploy 5\n"
                    "RULE Down\nPOLICIES ERROR\nTRIGGER !alive(down)\n"
                    "STRATEGY down_again 90 10\nADAPTATION down redeploy 5\n"
                    "STRATEGY down_tuned 90 10\nADAPTATION down set_parameter p 1 5\n"
                    "STRATEGY down_off 90 10\nADAPTATION down stop 5\n"
                    "STRATEGY both_again 90 10\nADAPTATION up redeploy 5\n"
                    "ADAPTATION down redeploy 5\n"
                    "RULE Other\nPOLICIES ERROR\nTRIGGER !alive(other)\n"
                    "STRATEGY other_again 90 10\nADAPTATION other redeploy 5\n"))
           .rules;
  Knowledge knowledge{rules};

  StrategyId strategy(std::string_view name) const {
    for (std::size_t s = 0; s < rules.strategies.size(); ++s) {
      if (rules.strategies[s].name == name) return StrategyId(s);
    }
    return {};
  }
};

std::optional<Restraint> restraint(const std::optional<Limits::Limit>& limit) {
  return limit ? std::optional(limit->restraint) : std::nullopt;
}

TEST(Limits, LetALaunchSettleBeforeTheComponentOrWhatDependsOnItIsTouched) {
  Two two;
  Limits limits(two.knowledge, {.quiet_after_launch = 1s, .quiet_downstream = 1s});
  EXPECT_FALSE(limits.on(two.strategy("up_again"), kBegin));
  limits.note({kBegin, AdaptationDone{two.strategy("up_again"), 0, ""}});
  for (const char* quiet : {"up_again", "down_again", "down_tuned"}) {
    EXPECT_EQ(restraint(limits.on(two.strategy(quiet), kBegin + 999ms)), Restraint::kQuietPeriod)
        << quiet;
    EXPECT_FALSE(limits.on(two.strategy(quiet), kBegin + 1s)) << quiet;
  }
  EXPECT_FALSE(limits.on(two.strategy("other_again"), kBegin)) << "it has nothing to do with it";
}

TEST(Limits, LeaveWhatDependsOnALaunchAloneUntilItPublishesAgain) {
  Two two;
  Limits limits(two.knowledge, {.quiet_after_launch = 1s, .quiet_downstream = 1s});
  limits.note({kBegin, AdaptationDone{two.strategy("up_again"), 0, ""}});
  ComponentState& up = two.knowledge.components[ComponentId(0)];
  up.awaits_ends_until = kBegin + 10s;
  EXPECT_EQ(restraint(limits.on(two.strategy("down_again"), kBegin + 3s)), Restraint::kQuietPeriod);
  EXPECT_FALSE(limits.on(two.strategy("up_again"), kBegin + 3s)) << "it may be what is broken";
  up.awaits_ends_until = kLongAgo;
  up.ends_back = kBegin + 4s;
  EXPECT_EQ(restraint(limits.on(two.strategy("down_again"), kBegin + 4999ms)),
            Restraint::kQuietPeriod);
  EXPECT_FALSE(limits.on(two.strategy("down_again"), kBegin + 5s));
}

// Whether culprit or another program started it again: its consumers have to discover the new
// process first.
TEST(Limits, LeaveWhatDependsOnWhatCameBackAloneUntilItIsFound) {
  Two two;
  Limits limits(two.knowledge, {.quiet_after_launch = 1s, .quiet_downstream = 3s});
  limits.note({kBegin, ComponentFound{ComponentId(0), 7}});
  EXPECT_FALSE(limits.on(two.strategy("down_again"), kBegin))
      << "it was only seen for the first time";
  limits.note({kBegin + 1s, ComponentLost{ComponentId(0), ""}});
  limits.note({kBegin + 2s, ComponentFound{ComponentId(0), 8}});
  EXPECT_EQ(restraint(limits.on(two.strategy("down_again"), kBegin + 4999ms)),
            Restraint::kQuietPeriod);
  EXPECT_FALSE(limits.on(two.strategy("up_again"), kBegin + 2s));
  EXPECT_FALSE(limits.on(two.strategy("down_again"), kBegin + 5s));
  two.knowledge.components[ComponentId(1)].alive = false;
  EXPECT_FALSE(limits.on(two.strategy("down_again"), kBegin + 3s)) << "it is down of itself";
}

TEST(Limits, AreQuietOnlyAfterALaunch) {
  Two two;
  Limits limits(two.knowledge, {.quiet_after_launch = 1s, .quiet_downstream = 1s});
  limits.note({kBegin, AdaptationDone{two.strategy("down_tuned"), 0, ""}});
  EXPECT_FALSE(limits.on(two.strategy("down_again"), kBegin));
}

TEST(Limits, RememberTheLaunchOfAnEarlierProcess) {
  Two two;
  Limits limits(two.knowledge, {.quiet_after_launch = 1s, .quiet_downstream = 1s});
  limits.remember({{kBegin, AdaptationDone{two.strategy("up_again"), 0, ""}}});
  EXPECT_EQ(restraint(limits.on(two.strategy("down_again"), kBegin + 500ms)),
            Restraint::kQuietPeriod);
}

TEST(Limits, DoubleTheTimeBetweenRestarts) {
  Two two;
  Limits limits(two.knowledge, {.backoff = {1s, 4s, 60s}});
  const StrategyId again = two.strategy("up_again");
  Time now = kBegin;
  for (const Duration wait : {1s, 2s, 4s, 4s}) {
    limits.began(again, now);
    EXPECT_EQ(restraint(limits.on(again, now + wait - 1ms)), Restraint::kBackoff);
    EXPECT_FALSE(limits.on(again, now + wait));
    now += wait;
  }
  EXPECT_FALSE(limits.on(two.strategy("down_again"), now)) << "each component has its own";
}

TEST(Limits, ForgetTheRestartsOfWhatHasBeenWellSinceThen) {
  Two two;
  Limits limits(two.knowledge, {.backoff = {100s, 400s, 60s}});
  const StrategyId again = two.strategy("up_again");
  const RuleId rule = two.knowledge.rules[again].rule;
  limits.began(again, kBegin);
  limits.note({kBegin, FailureResolved{rule, FailureResolved::How::kByStrategy, again, {}}});
  two.knowledge.states.state(rule).failing_since = kBegin + 59s;
  EXPECT_EQ(restraint(limits.on(again, kBegin + 61s)), Restraint::kBackoff);
  two.knowledge.states.state(rule).failing_since = kBegin + 60s;
  EXPECT_FALSE(limits.on(again, kBegin + 61s));
}

TEST(Limits, BoundWhatIsBegunAtAComponentInItsPeriod) {
  Two two;
  Limits limits(two.knowledge, {.per_component = {2, 60s}});
  limits.began(two.strategy("down_again"), kBegin);
  limits.began(two.strategy("down_tuned"), kBegin + 10s);
  EXPECT_EQ(restraint(limits.on(two.strategy("down_again"), kBegin + 59s)),
            Restraint::kComponentIntensity);
  EXPECT_FALSE(limits.on(two.strategy("up_again"), kBegin + 59s));
  EXPECT_FALSE(limits.on(two.strategy("down_again"), kBegin + 60s));
}

TEST(Limits, SayHowManyThereWere) {
  Two two;
  Limits limits(two.knowledge, {.restarts = {1, 1h}});
  limits.began(two.strategy("down_again"), kBegin);
  EXPECT_EQ(limits.on(two.strategy("down_again"), kBegin)->reason,
            "1 restart of down in 1h, and no more are allowed");
}

TEST(Limits, BoundTheRestartsOfAComponentWhicheverRulesAsk) {
  Two two;
  Limits limits(two.knowledge, {.restarts = {2, 1h}, .backoff = {1s, 4s, 10s}});
  limits.began(two.strategy("down_again"), kBegin);
  limits.began(two.strategy("down_tuned"), kBegin + 1min);
  limits.began(two.strategy("both_again"), kBegin + 10min);
  const auto refused = limits.on(two.strategy("down_again"), kBegin + 59min);
  ASSERT_EQ(restraint(refused), Restraint::kRestarts) << "proven health in between is no excuse";
  EXPECT_EQ(refused->reason, "2 restarts of down in 1h, and no more are allowed");
  EXPECT_FALSE(limits.on(two.strategy("down_tuned"), kBegin + 59min)) << "it restarts nothing";
  EXPECT_FALSE(limits.on(two.strategy("down_off"), kBegin + 59min)) << "a stop may be what is safe";
  EXPECT_FALSE(limits.on(two.strategy("up_again"), kBegin + 59min)) << "each has its own";
  EXPECT_FALSE(limits.on(two.strategy("down_again"), kBegin + 1h));
}

TEST(Limits, RememberTheRestartsOfEarlierProcesses) {
  Two two;
  Limits limits(two.knowledge, {.restarts = {2, 1h}});
  const StrategyId again = two.strategy("down_again");
  limits.remember(
      {{kBegin, StrategyChosen{again, {}, {}, false}}, {kBegin + 10min, StrategyResumed{again}}});
  EXPECT_EQ(restraint(limits.on(again, kBegin + 20min)), Restraint::kRestarts);
}

}  // namespace
}  // namespace culprit::execute
