#include "fleet/outbox.h"

#include <fstream>

#include <gtest/gtest.h>

#include "base/test_folder.h"

namespace culprit::fleet {
namespace {

const Run kRun{"0123456789abcdef0123456789abcdef", 1, 5, "0.1.0", "rover", "rules", ""};

Failure failure_at(std::int64_t row) {
  Failure failure;
  failure.row = failure.incident = failure.began = row;
  return failure;
}

TEST(Outbox, ARobotKeepsItsNumberOnItsComputer) {
  const test::TestFolder folder;
  const std::string robot = Outbox::open(folder / "o", "one")->identity().robot;
  const Identity again = Outbox::open(folder / "o", "one")->identity();
  EXPECT_EQ(again.robot, robot);
  EXPECT_FALSE(again.is_copy);
  EXPECT_EQ(Outbox::open(folder / "o", "")->identity().robot, robot)
      << "an unknown computer keeps its number";
}

TEST(Outbox, OnAnotherComputerItIsAnotherRobotThatKnowsTheFirst) {
  const test::TestFolder folder;
  const std::string robot = Outbox::open(folder / "o", "one")->identity().robot;
  const Identity copy = Outbox::open(folder / "o", "two")->identity();
  EXPECT_TRUE(copy.is_copy);
  EXPECT_NE(copy.robot, robot);
  EXPECT_EQ(copy.before, robot);
  const Identity again = Outbox::open(folder / "o", "two")->identity();
  EXPECT_EQ(again.robot, copy.robot);
  EXPECT_FALSE(again.is_copy) << "said once";
}

TEST(Outbox, WhatChangedWhileItWasSentGoesAgain) {
  const test::TestFolder folder;
  Outbox outbox = std::move(*Outbox::open(folder / "o", "one"));
  ASSERT_TRUE(outbox.keep(kRun, {{{"R", "s"}, {1, 0}}}, {}, {failure_at(7)}));
  const Waiting sent = *outbox.waiting(10);
  ASSERT_EQ(sent.outcomes.size(), 1u);
  ASSERT_EQ(sent.failures.size(), 1u);
  ASSERT_EQ(sent.runs.size(), 1u);
  ASSERT_TRUE(outbox.keep(kRun, {{{"R", "s"}, {1, 1}}}, {}, {}));
  ASSERT_TRUE(outbox.sent(sent));
  const Waiting rest = *outbox.waiting(10);
  ASSERT_EQ(rest.outcomes.size(), 1u);
  EXPECT_EQ(rest.outcomes[0].counts, (Counts{1, 1}));
  EXPECT_TRUE(rest.failures.empty());
}

TEST(Outbox, ARuleThatIsExhaustedIsUrgentUntilItIsSentOrOver) {
  const test::TestFolder folder;
  Outbox outbox = std::move(*Outbox::open(folder / "o", "one"));
  EXPECT_EQ(*outbox.news(), Outbox::News::kNone);
  ASSERT_TRUE(outbox.keep(kRun, {{{"R", "s"}, {1, 0}}}, {}, {}));
  EXPECT_EQ(*outbox.news(), Outbox::News::kSome);
  Failure failure = failure_at(7);
  failure.ended = 0;
  failure.is_exhausted = true;
  ASSERT_TRUE(outbox.keep(kRun, {}, {}, {failure}));
  EXPECT_EQ(*outbox.news(), Outbox::News::kUrgent);
  ASSERT_TRUE(outbox.sent(*outbox.waiting(10)));
  EXPECT_EQ(*outbox.news(), Outbox::News::kNone);
  failure.ended = 8;
  ASSERT_TRUE(outbox.keep(kRun, {}, {}, {failure}));
  EXPECT_EQ(*outbox.news(), Outbox::News::kSome);
}

TEST(Outbox, AnOlderCountTakesNothingBack) {
  const test::TestFolder folder;
  Outbox outbox = std::move(*Outbox::open(folder / "o", "one"));
  ASSERT_TRUE(outbox.keep(kRun, {{{"R", "s"}, {5, 2}}}, {}, {}));
  ASSERT_TRUE(outbox.keep(kRun, {{{"R", "s"}, {3, 4}}}, {}, {}));
  EXPECT_EQ(outbox.waiting(10)->outcomes[0].counts, (Counts{5, 4}));
}

TEST(Outbox, IsBoundedAndKnowsWhatItDropped) {
  const test::TestFolder folder;
  Outbox outbox = std::move(*Outbox::open(folder / "o", "one"));
  std::vector<Failure> failures;
  for (std::int64_t row = 1; row <= Outbox::kMostFailures; ++row)
    failures.push_back(failure_at(row));
  ASSERT_TRUE(outbox.keep(kRun, {}, {}, failures));
  EXPECT_EQ(*outbox.dropped(), 0);
  // Sent rows go first.
  ASSERT_TRUE(outbox.sent({{}, {}, {{kRun.id, failures[100]}}}));
  ASSERT_TRUE(outbox.keep(kRun, {}, {}, {failure_at(Outbox::kMostFailures + 1)}));
  EXPECT_EQ(*outbox.dropped(), Outbox::kMostFailures / 20);
  const Waiting rest = *outbox.waiting(1 << 20);
  EXPECT_EQ(rest.failures.size(), Outbox::kMostFailures * 19u / 20);
  EXPECT_EQ(rest.failures.back().failure.row, Outbox::kMostFailures + 1);
  EXPECT_LT(std::filesystem::file_size(folder / "o"), 16u << 20);
}

TEST(Outbox, WhatIsDamagedIsSetAsideAndSaid) {
  const test::TestFolder folder;
  std::ofstream(folder / "o") << std::string(8192, 'x');
  const auto outbox = Outbox::open(folder / "o", "one");
  ASSERT_TRUE(outbox);
  EXPECT_NE(outbox->remark().find("damaged-1"), std::string::npos) << outbox->remark();
  EXPECT_TRUE(std::filesystem::exists(folder / "o.damaged-1"));
}

}  // namespace
}  // namespace culprit::fleet
