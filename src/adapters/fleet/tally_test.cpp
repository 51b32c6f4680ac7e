#include "fleet/tally.h"

#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "fleet/incident_number.h"
#include "fleet/journal_tail.h"
#include "fleet/test_journal.h"
#include "journal/reader.h"

namespace culprit::fleet {
namespace {

struct Folded : testing::Test {
  Tally tally() const {
    Tally tally;
    const auto reader = journal::Reader::open(journal.path());
    auto rows = reader->entries(journal::Which::kReadable);
    journal::Entry entry;
    while (*rows->next(entry)) tally.take(entry, rows->hash());
    return tally;
  }
  const test::TestFolder folder;
  TestJournal journal{folder / "a.journal"};
};

using TallyOfAJournal = Folded;

TEST_F(TallyOfAJournal, CountsOutcomesOfTheNewestRun) {
  journal.begins("indoors");
  journal.outcome("restart", true);
  const std::string first = tally().run()->id;
  journal.begins();
  journal.outcome("restart", true);
  journal.outcome("restart", false);
  journal.outcome("redeploy", true);
  journal.event("outcome_counted", R"(,"rule":"Silent","strategy":"redeploy","as":"nothing")");
  const Tally now = tally();
  EXPECT_NE(now.run()->id, first);
  EXPECT_EQ(now.run()->id.size(), 32u);
  EXPECT_EQ(now.run()->model, "rover");
  EXPECT_EQ(now.counts().at({"Silent", "restart"}), (Counts{1, 1}));
  EXPECT_EQ(now.counts().at({"Silent", "redeploy"}), (Counts{1, 0}));
}

TEST_F(TallyOfAJournal, FollowsFailuresFromTheirDetectionToTheirEnd) {
  journal.begins();
  journal.event("failure_detected", R"(,"rule":"Silent","criticality":"ERROR")");
  journal.event("failure_detected", R"(,"rule":"Slow","criticality":"WARNING")");
  journal.event("strategy_chosen",
                R"(,"rule":"Silent","strategy":"restart","suspects":[{"component":"camera"}])");
  journal.event("strategy_failed", R"(,"rule":"Silent","strategy":"restart")");
  journal.event("failure_resolved", R"(,"rule":"Silent","strategy":"redeploy","reaction_s":2.5)");
  Tally now = tally();
  const auto failures = now.take_failures();
  ASSERT_EQ(failures.size(), 2u);
  const Failure& resolved = failures[0];
  EXPECT_EQ(resolved.rule, "Silent");
  EXPECT_EQ(resolved.component, "camera");
  EXPECT_EQ(resolved.how, "resolved");
  EXPECT_EQ(resolved.helped_by, "redeploy");
  EXPECT_EQ(resolved.repair_seconds, 2.5);
  EXPECT_EQ(resolved.strategies, 1);
  EXPECT_EQ(resolved.failed, 1);
  EXPECT_EQ(failures[1].ended, 0);
  EXPECT_EQ(failures[1].incident, resolved.incident);
  EXPECT_TRUE(now.take_failures().empty());
}

TEST_F(TallyOfAJournal, FailuresHaveTheIncidentsThatTheManagerTold) {
  journal.begins("", 1'800'000'000'000'000'000);
  journal.event("failure_detected", R"(,"rule":"Silent","criticality":"ERROR")");
  EXPECT_TRUE(tally().take_failures().empty()) << "its incident is not told yet";
  journal.event("incident_opened", R"(,"incident":"mywpiwzf-0k7","rule":"Silent")");
  journal.event("failure_detected", R"(,"rule":"Dark","criticality":"WARNING")");
  journal.event("incident_opened", R"(,"incident":"mywpj001-00a","rule":"Dark")");
  Tally now = tally();
  const auto failures = now.take_failures();
  ASSERT_EQ(failures.size(), 2u);
  EXPECT_EQ(incident_id(failures[0].incident), "mywpj001-00a");
  EXPECT_EQ(incident_id(failures[1].incident), "mywpiwzf-0k7");
}

TEST(IncidentNumber, IsItsIdAndNoRow) {
  EXPECT_EQ(incident_id(incident_number("mywpiwzf-0k7")), "mywpiwzf-0k7");
  EXPECT_EQ(incident_id(4711), "") << "a row";
  for (const char* other : {"", "-", "mywpiwzf", "4711-000", "a b-00a", "zzzzzzzzzzzzzzzz-000"})
    EXPECT_EQ(incident_number(other), 0) << other;
}

TEST_F(TallyOfAJournal, FailuresOfARunThatIsOverAreLeft) {
  journal.begins();
  journal.event("failure_detected", R"(,"rule":"Silent","criticality":"ERROR")");
  journal.begins();
  Tally now = tally();
  const auto failures = now.take_failures();
  ASSERT_EQ(failures.size(), 1u);
  EXPECT_EQ(failures[0].how, "left");
}

TEST_F(TallyOfAJournal, TakesNoHarmFromRowsThatAreDamaged) {
  journal.begins();
  for (const char* more : {R"(,"rule":7)", R"(,"rule":"Silent","as":[])", R"(,"suspects":{})",
                           R"(,"rule":"\u0000","strategy":"\ud800","as":"success")"}) {
    for (const char* type : {"outcome_counted", "failure_detected", "strategy_chosen", "", "x"})
      journal.event(type, more);
  }
  EXPECT_TRUE(tally().run());
}

struct Followed : Folded {
  std::map<std::string, Counts> sums() const {
    std::map<std::string, Counts> all;
    const auto waiting = outbox.waiting(1000);
    for (const Outcome& each : waiting->outcomes) {
      all[each.name.strategy].helped += each.counts.helped;
      all[each.name.strategy].failed += each.counts.failed;
    }
    return all;
  }
  Outbox outbox = std::move(*Outbox::open(outbox_beside(journal.path()), "machine"));
  const std::atomic<bool> stop = false;
};

// The process that follows may be killed at any instant, and begins anew with the run.
TEST_F(Followed, NothingIsCountedTwiceHoweverOftenTheJournalIsReadAnew) {
  JournalTail kept(journal.path());
  for (int run = 0; run < 4; ++run) {
    journal.begins();
    for (int i = 0; i < 5; ++i) {
      journal.outcome("restart", i % 2 == 0);
      JournalTail anew(journal.path());
      const auto followed = i == 3 ? kept.follow(outbox, stop) : anew.follow(outbox, stop);
      ASSERT_TRUE(followed) << followed.error();
    }
  }
  ASSERT_TRUE(kept.follow(outbox, stop));
  EXPECT_EQ(sums().at("restart"), (Counts{12, 8}));
}

TEST_F(Followed, AnotherJournalInItsPlaceIsReadFromItsBeginning) {
  JournalTail tail(journal.path());
  journal.begins();
  journal.outcome("restart", true);
  ASSERT_TRUE(tail.follow(outbox, stop));
  journal.ends();
  for (const char* part : {"", "-wal", "-shm", "-learned"})
    std::filesystem::remove(journal.path().string() + part);
  journal.begins();
  journal.outcome("restart", true);
  ASSERT_TRUE(tail.follow(outbox, stop));
  EXPECT_EQ(sums().at("restart"), (Counts{2, 0}));
}

TEST_F(Followed, WhatAStrategyDoesIsKnownFromTheRulesOfTheRun) {
  journal.begins();
  journal.outcome("restart", true);
  journal.outcome("redeploy", true);
  journal.outcome("invented", true);
  ASSERT_TRUE(JournalTail(journal.path()).follow(outbox, stop));
  std::map<std::string, std::string> definitions;
  const auto waiting = outbox.waiting(1000);
  for (const Outcome& each : waiting->outcomes) definitions[each.name.strategy] = each.definition;
  EXPECT_EQ(definitions.at("restart").size(), 16u);
  EXPECT_NE(definitions.at("restart"), definitions.at("redeploy"));
  EXPECT_EQ(definitions.at("invented"), "");
}

}  // namespace
}  // namespace culprit::fleet
