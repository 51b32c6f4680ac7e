// Checks what a run takes from the previous one when rows were changed.
#include "journal/recovery.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_expected.h"
#include "base/test_folder.h"
#include "journal/event_json.h"
#include "journal/requests.h"
#include "journal/writer.h"
#include "language/checker.h"

namespace culprit::journal {
namespace {

using namespace std::chrono_literals;
using culprit::test::value_of;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t kRecoveredAt = 1'800'000'000'000'000'000;

struct JournalRecovery : testing::Test {
  JournalRecovery() {
    Session session;
    session.boot = boot_id();
    Batch all;
    all.entries.push_back(
        {0, kRecoveredAt, std::string(kind::kSession), to_line(to_json(session))});
    all.entries.push_back({0, kRecoveredAt, std::string(kind::kSteps), "anything"});
    all.entries.push_back({0, kRecoveredAt, std::string(kind::kEvent), found(4242)});
    Writer writer = value_of(Writer::open(path, {}));
    EXPECT_TRUE(writer.append(all, kRecoveredAt, Durability::kProcessEnd));
  }

  std::string found(int pid) const {
    Json row = to_json(Event{Time(), ComponentFound{ComponentId(0), pid}}, rules);
    return to_line(row);
  }
  void change(const std::string& sql) {
    auto database = value_of(Database::open(path, Database::Mode::kWrite));
    ASSERT_TRUE(database.run(sql));
  }
  Recovery recovered() {
    const Reader reader = value_of(Reader::open(path));
    return value_of(recover(reader, {}, rules, {Time(), kRecoveredAt}));
  }
  static std::vector<int> processes(const History& past) {
    std::vector<int> pids;
    for (const Event& event : past) {
      if (const auto* seen = std::get_if<ComponentFound>(&event.what)) pids.push_back(seen->pid);
    }
    return pids;
  }

  const RuleSet rules = *check(Source("my.rules", "COMPONENT camera NODE /camera\n")).rules;
  culprit::test::TestFolder folder;
  const std::filesystem::path path = folder / "a.journal";
};

TEST_F(JournalRecovery, KnowsTheProcessesOfRowsThatAreAsTheyWereWritten) {
  const Recovery recovery = recovered();
  EXPECT_THAT(processes(recovery.past), ElementsAre(4242));
  EXPECT_THAT(recovery.given_up, IsEmpty());
}

TEST_F(JournalRecovery, TakesNoProcessFromARowWithAWrongHash) {
  change("UPDATE entry SET body = '" + found(1) + "' WHERE id = 3");
  const Recovery recovery = recovered();
  EXPECT_THAT(processes(recovery.past), IsEmpty());
  EXPECT_THAT(recovery.given_up, ElementsAre(HasSubstr("row 3 (event) is not what was written")));
}

TEST_F(JournalRecovery, NorFromOneThatWasAdded) {
  change("INSERT INTO entry SELECT 4, at, kind, '" + found(1) + "', hash FROM entry WHERE id = 3");
  EXPECT_THAT(processes(recovered().past), ElementsAre(4242));
}

TEST_F(JournalRecovery, NorFromTheBeginningOfARun) {
  change("UPDATE entry SET body = json_set(body, '$.past', json('[" + found(1) +
         "]')) WHERE id = 1");
  const Recovery recovery = recovered();
  EXPECT_TRUE(recovery.had_run);
  EXPECT_TRUE(recovery.orders_kept) << "it does not show whether it was paused";
  EXPECT_THAT(processes(recovery.past), IsEmpty());
  EXPECT_THAT(recovery.given_up, ElementsAre(HasSubstr("row 1 (session)")));
}

// A run that saw the robot whole, and another one that begins.
struct ExpectedRobot : testing::Test {
  struct Told {
    int domain = 0;
    std::string boot = boot_id();
    Time latest = Time(100s);
    bool is_whole = true;
  };
  void write(const Told& told) { write_rows(told, {kind::kSession, kind::kRobot, kind::kEvent}); }
  void write_rows(const Told& told, const std::vector<std::string_view>& kinds) {
    Writer writer = value_of(Writer::open(path, {}));
    Batch all;
    for (const std::string_view kind : kinds) all.entries.push_back(row(kind, told));
    EXPECT_TRUE(writer.append(all, kRecoveredAt, Durability::kProcessEnd));
  }
  Entry row(std::string_view kind, const Told& told) const {
    Json body;
    if (kind == kind::kSession) {
      Session session;
      session.boot = told.boot;
      session.domain = told.domain;
      session.rules_text = "the rules";
      session.start = Time(50s);
      body = to_json(session);
    } else if (kind == kind::kRobot) {
      KnownRobot known;
      known.parts = {{"camera", "/camera", {}, 77, "rover2"}};
      known.topics = known.heard = {"/image"};
      known.read = {"signal hot"};
      known.is_whole = told.is_whole;
      body = robot_row(known, {told.domain, told.boot});
    } else {
      body = to_json(Event{told.latest, ComponentFound{ComponentId(0), 77}}, rules);
    }
    return {0, kRecoveredAt, std::string(kind), to_line(body)};
  }
  Recovery recovered(Time now = Time(110s), std::optional<int> manager_before = {},
                     std::int64_t wall = kRecoveredAt) {
    const Reader reader = value_of(Reader::open(path));
    return value_of(recover(reader, {}, rules, {now, wall, 0}, manager_before));
  }
  bool is_expected() { return recovered().known_robot.is_whole; }

  const RuleSet rules = *check(Source("my.rules", "COMPONENT camera NODE /camera\n")).rules;
  culprit::test::TestFolder folder;
  const std::filesystem::path path = folder / "a.journal";
};

TEST_F(ExpectedRobot, IsWhatTheLastRunSawAMomentAgo) {
  write({});
  const Recovery recovery = recovered();
  EXPECT_TRUE(recovery.known_robot.is_whole);
  EXPECT_EQ(recovery.rules_text, "the rules");
  EXPECT_THAT(recovery.known_robot.heard, ElementsAre("/image"));
  EXPECT_THAT(recovery.known_robot.read, ElementsAre("signal hot"));
  ASSERT_EQ(recovery.known_robot.parts.size(), 1u);
  EXPECT_EQ(recovery.known_robot.parts[0].pid, 77);
  EXPECT_EQ(recovery.known_robot.parts[0].host, "rover2");
}

TEST_F(ExpectedRobot, IsNoneOfAnotherDomainOrAnotherStartOfTheMachine) {
  write({.domain = 7});
  EXPECT_FALSE(is_expected());
  write({.boot = "another"});
  EXPECT_FALSE(is_expected());
}

TEST_F(ExpectedRobot, IsNoneOfALongTimeAgo) {
  write({});
  EXPECT_TRUE(recovered(Time(100s) + kExpected).known_robot.is_whole);
  EXPECT_FALSE(recovered(Time(101s) + kExpected).known_robot.is_whole);
  EXPECT_FALSE(recovered(Time(100s) + std::chrono::weeks(3)).known_robot.is_whole);
}

// The robot's clock never goes back within one start of the machine.
TEST_F(ExpectedRobot, IsNoneOfTheFuture) {
  write({});
  EXPECT_FALSE(recovered(Time(99s)).known_robot.is_whole);
}

TEST_F(ExpectedRobot, DoesNotDependOnTheWallClock) {
  write({});
  for (const std::int64_t jump : {-kRecoveredAt, kRecoveredAt})
    EXPECT_TRUE(recovered(Time(110s), {}, kRecoveredAt + jump).known_robot.is_whole);
}

TEST_F(ExpectedRobot, IsNoneOfARunThatSawAPart) {
  write({.is_whole = false});
  EXPECT_FALSE(is_expected());
}

// It was killed before it saw anything; its record was made under the rules of the one before.
TEST_F(ExpectedRobot, IsNoneOfTheRunBeforeTheLast) {
  write({});
  write_rows({}, {kind::kSession, kind::kEvent});
  EXPECT_FALSE(is_expected());
}

TEST_F(ExpectedRobot, IsNoneOnceAnotherCulpritManagedIt) {
  write({});
  EXPECT_FALSE(recovered(Time(110s), 4711).known_robot.is_whole);
}

TEST_F(ExpectedRobot, IsNoneIfAnyRowIsNotAsItWasWritten) {
  for (int row = 1; row <= 3; ++row) {
    std::filesystem::remove(path);
    write({});
    auto database = value_of(Database::open(path, Database::Mode::kWrite));
    ASSERT_TRUE(
        database.run("UPDATE entry SET body = body || ' ' WHERE id = " + std::to_string(row)));
    EXPECT_FALSE(is_expected()) << row;
  }
}

TEST_F(ExpectedRobot, IsNoneIfARowIsMissing) {
  write({});
  auto database = value_of(Database::open(path, Database::Mode::kWrite));
  ASSERT_TRUE(database.run("DELETE FROM entry WHERE id = 2"));
  EXPECT_FALSE(is_expected());
}

// A restart failed, and a person has the process replaced before anything else is chosen.
struct OrderedRun : testing::Test {
  Entry event(decltype(Event::what) what) const {
    return {0, kRecoveredAt, std::string(kind::kEvent),
            to_line(to_json(Event{Time(100s), std::move(what)}, rules))};
  }
  Entry intent(std::uint64_t number, decltype(Command::what) what, StrategyId strategy) const {
    const Command command{{number}, ComponentId(0), std::move(what), 1s, {strategy}};
    return {0, kRecoveredAt, std::string(kind::kIntent), line_of(command, rules)};
  }
  std::vector<Interrupted> left_by(std::vector<Entry> rows) const {
    Session session;
    session.boot = boot_id();
    session.start = Time(50s);
    rows.insert(rows.begin(),
                {0, kRecoveredAt, std::string(kind::kSession), to_line(to_json(session))});
    Writer writer = value_of(Writer::open(path, {}));
    Batch all;
    all.entries = std::move(rows);
    EXPECT_TRUE(writer.append(all, kRecoveredAt, Durability::kProcessEnd));
    const Reader reader = value_of(Reader::open(path));
    return value_of(recover(reader, {}, rules, {Time(101s), kRecoveredAt, 0})).interrupted;
  }

  const RuleSet rules =
      *check(Source("my.rules",
                    "COMPONENT camera NODE /camera LAUNCH \"camera\"\nRULE Silent\nPOLICIES "
                    "ERROR\nTRIGGER age(/rgb) > 1s\nSTRATEGY restart 50 10\nADAPTATION camera "
                    "restart 5\nSTRATEGY redeploy 50 10\nADAPTATION camera redeploy 5\n"))
           .rules;
  const StrategyId restart{0};
  const StrategyId redeploy{1};
  culprit::test::TestFolder folder;
  const std::filesystem::path path = folder / "a.journal";
};

TEST_F(OrderedRun, OnlyTheLastStrategyOfARuleIsUnderWay) {
  const auto left =
      left_by({event(StrategyChosen{restart, {}, {}, false, {}, {}}),
               intent(1, ChangeLifecycle{Transition::kDeactivate}, restart),
               event(StrategyFailed{restart, "no"}), intent(2, StopProcess{}, redeploy)});
  ASSERT_EQ(left.size(), 1u);
  EXPECT_EQ(left[0].strategy, redeploy);
}

TEST_F(OrderedRun, OneThatFailedAndIsOrderedAnewHasNotFailed) {
  const auto left =
      left_by({event(StrategyChosen{redeploy, {}, {}, false, {}, {}}),
               intent(1, StopProcess{}, redeploy), event(StrategyFailed{redeploy, "no"}),
               event(OrderAccepted{{1, "Ann", "", RunStrategy{redeploy}}, {}}),
               intent(2, StopProcess{}, redeploy)});
  ASSERT_EQ(left.size(), 1u);
  EXPECT_FALSE(left[0].has_failed);
  EXPECT_EQ(left[0].requests.size(), 1u);
}

// A restart was paused half-way, and then the camera was activated: nothing of that is to be continued.
TEST_F(OrderedRun, WhatAnAbandonedStrategyOwedIsNoStrategyUnderWay) {
  const Command activates{
      {2}, ComponentId(0), ChangeLifecycle{Transition::kActivate}, 1s, {restart, 0, true}};
  const auto left =
      left_by({event(StrategyChosen{restart, {}, {}, false, {}, {}}),
               intent(1, ChangeLifecycle{Transition::kDeactivate}, restart),
               event(StrategyAbandoned{restart, "paused by Ann"}),
               {0, kRecoveredAt, std::string(kind::kIntent), line_of(activates, rules)}});
  EXPECT_TRUE(left.empty());
}

}  // namespace
}  // namespace culprit::journal
