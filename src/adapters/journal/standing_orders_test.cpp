// People's orders outlive the process, the machine and damage. If clocks cannot show how much of a
// mute is left, it lasts longer rather than shorter.
#include "journal/standing_orders.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "language/checker.h"

namespace culprit::journal {
namespace {

using culprit::test::TestFolder;
using testing::HasSubstr;
using namespace std::chrono_literals;

constexpr const char* kOrderRules = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
RULE Silent
  POLICIES ERROR
  TRIGGER age(/rgb) > 300ms
    STRATEGY redeploy 50 10
      ADAPTATION camera redeploy 2
)";
constexpr std::int64_t kOrderedAt = 1'800'000'000'000'000'000;
constexpr std::int64_t kOneDay = 86'400'000'000'000;

Clocks clocks(Time robot, std::int64_t wall = kOrderedAt, const std::string& boot = "first") {
  return {boot, robot, wall, true};
}

StandingOrders with_all() {
  StandingOrders orders;
  orders.pause = {"ada", "the lens is being cleaned"};
  orders.dry_run = {"bob", ""};
  orders.silences = {{StandingOrders::About::kComponent, "camera", {"ada", ""}, Time(160s)},
                     {StandingOrders::About::kRule, "Silent", {"ada", ""}, kNever}};
  return orders;
}

StandingOrders again(const StandingOrders& orders, const Clocks& then, const Clocks& now) {
  const auto read = orders_from_text(to_text(orders, then), now);
  EXPECT_TRUE(read) << read.error();
  return *read;
}

TEST(StandingOrders, AreTheSameAfterARestartOfCulprit) {
  EXPECT_EQ(again(with_all(), clocks(Time(100s)), clocks(Time(110s))), with_all());
}

TEST(StandingOrders, LetSilencesEndWhileNobodyLooks) {
  const auto later = again(with_all(), clocks(Time(100s)), clocks(Time(161s)));
  ASSERT_EQ(later.silences.size(), 1u);
  EXPECT_EQ(later.silences[0].name, "Silent");
}

TEST(StandingOrders, GoByNoWallClockWithinOneStartOfTheMachine) {
  for (const std::int64_t jump : {40 * kOneDay, -40 * kOneDay}) {
    const auto later = again(with_all(), clocks(Time(100s)), clocks(Time(110s), kOrderedAt + jump));
    EXPECT_EQ(later, with_all());
  }
}

TEST(StandingOrders, GoByTheWallClockOverARestartOfTheMachineIfItIsSet) {
  const Clocks now = clocks(Time(5s), kOrderedAt + 20'000'000'000, "second");
  const auto later = again(with_all(), clocks(Time(100s)), now);
  ASSERT_EQ(later.silences.size(), 2u);
  EXPECT_EQ(later.silences[0].until, Time(45s)) << "60 s were left, 20 s ago";
}

TEST(StandingOrders, DoNotEndASilenceBecauseTheClockWasNotSetYet) {
  Clocks then = clocks(Time(100s), 100'000'000'000);  // 1970, no battery
  then.is_wall_set = false;
  const auto later = again(with_all(), then, clocks(Time(5s), kOrderedAt, "second"));
  ASSERT_EQ(later.silences.size(), 2u);
  EXPECT_EQ(later.silences[0].until, Time(65s));
}

TEST(StandingOrders, ChangeByOrders) {
  const RuleSet rules = *check(Source("test", kOrderRules)).rules;
  const auto order = [&](decltype(Order::what) what) {
    return by_name({1, "ada", "why", std::move(what)}, rules);
  };
  StandingOrders orders;
  orders = after(orders, order(Pause{}), Time(1s));
  orders = after(orders, order(SetDryRun{true}), Time(1s));
  orders = after(orders, order(Silence{ComponentId(0), 10s}), Time(1s));
  orders = after(orders, order(Silence{RuleId(0), {}}), Time(1s));
  EXPECT_TRUE(orders.pause && orders.dry_run);
  EXPECT_EQ(to_past(orders, rules, Time(2s)).size(), 2u);
  EXPECT_EQ(to_past(orders, rules, Time(20s)).size(), 1u);
  EXPECT_EQ(silences_of(to_past(orders, rules, Time(2s)), rules), orders.silences);
  orders = after(orders, order(LiftSilence{RuleId(0)}), Time(20s));
  orders = after(orders, order(Resume{}), Time(20s));
  orders = after(orders, order(SetDryRun{false}), Time(20s));
  EXPECT_TRUE(restrain_alike(orders, StandingOrders()));
  EXPECT_EQ(orders.revision, 7u);
}

TEST(StandingOrders, OfAnotherAreNewWhereTheyRestrainMore) {
  const RuleSet rules = *check(Source("test", kOrderRules)).rules;
  StandingOrders ours;
  ours.dry_run = StandingOrders::Said{"eve", ""};
  ours.silences = {{StandingOrders::About::kComponent, rules.components[0].name, {}, Time(9s)}};
  StandingOrders theirs = ours;
  EXPECT_TRUE(restraints_beyond(ours, theirs, rules, Time(1s)).empty());
  EXPECT_TRUE(restraints_beyond(ours, StandingOrders(), rules, Time(1s)).empty());
  theirs.pause = StandingOrders::Said{"ann", "hands in the machine"};
  theirs.silences[0].until = Time(20s);
  theirs.silences.push_back({StandingOrders::About::kRule, "of other rules", {}, kNever});
  const auto orders = restraints_beyond(ours, theirs, rules, Time(1s));
  ASSERT_EQ(orders.size(), 2u);
  EXPECT_TRUE(std::holds_alternative<Pause>(orders[0].what));
  EXPECT_EQ(orders[0].author, "ann");
  EXPECT_EQ(std::get<Silence>(orders[1].what).lasts, Duration(19s));
}

TEST(StandingOrders, OfTwoAreAllRestraints) {
  StandingOrders ours;
  ours.silences = {{StandingOrders::About::kComponent, "camera", {"eve", ""}, Time(9s)}};
  EXPECT_EQ(both(ours, with_all()).pause, with_all().pause);
  EXPECT_EQ(both(ours, with_all()).silences[0].until, Time(160s));
}

TEST(OrdersFile, IsReadAsItWasWritten) {
  const TestFolder folder;
  const auto path = orders_beside(folder / "a.journal");
  const auto none = read_orders(path, clocks(Time(1s)));
  ASSERT_TRUE(none) << none.error();
  EXPECT_FALSE(*none);
  ASSERT_TRUE(write_orders(path, with_all(), clocks(Time(100s))));
  const auto read = read_orders(path, clocks(Time(100s)));
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(**read, with_all());
}

// Wherever a bit flips and wherever it ends: the file never gives another text than was written.
TEST(OrdersFile, IsUnreadableWithAnyBitChangedOrAnyByteMissing) {
  const TestFolder folder;
  const auto path = orders_beside(folder / "a.journal");
  ASSERT_TRUE(write_orders(path, with_all(), clocks(Time(100s))));
  std::ifstream in(path, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), {}};
  const auto is_refused = [&](const std::string& content) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << content;
    const auto read = read_orders(path, clocks(Time(100s)));
    return !read && read.error().find(path.string()) != std::string::npos;
  };
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ (1 << (i % 8)));
    EXPECT_TRUE(is_refused(damaged)) << i;
    EXPECT_TRUE(is_refused(whole.substr(0, i))) << i;
  }
  EXPECT_TRUE(is_refused(whole + "\n"));
}

}  // namespace
}  // namespace culprit::journal
