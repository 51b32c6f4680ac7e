// The tests that ship with the rules: they are examples, and they hold.
#include <filesystem>
#include <fstream>
#include <utility>

#include <gtest/gtest.h>

#include "language/checker.h"
#include "plan/bayes/bayes_planner.h"
#include "plan/paper_planner.h"
#include "rule_files/rule_files.h"
#include "rule_test/file_run.h"

namespace culprit::rule_test {
namespace {

std::unique_ptr<const Planner> paper() { return std::make_unique<PaperPlanner>(); }
std::unique_ptr<const Planner> bayes() { return std::make_unique<BayesPlanner>(); }

class ShippedTests : public testing::TestWithParam<PlannerFactory> {};

TEST_P(ShippedTests, AllHold) {
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator("rules/tests")) {
    if (entry.path().extension() != ".test") continue;
    ++files;
    const FileRun run = run_file(entry.path().string(), "", GetParam(), Colour::kOff);
    ASSERT_TRUE(run.is_usable) << run.complaints;
    EXPECT_EQ(run.complaints, "");
    for (const SuiteReport& suite : run.suites) {
      EXPECT_FALSE(suite.cases.empty());
      for (const auto& test : suite.cases) EXPECT_EQ(test.failure, "") << entry.path();
    }
  }
  EXPECT_GE(files, 14);
}

INSTANTIATE_TEST_SUITE_P(WithEachPlanner, ShippedTests, testing::Values(paper, bayes),
                         [](const auto& test) { return test.index == 0 ? "paper" : "bayes"; });

// Absent is not dead: whatever a pack is for, it does nothing to a robot that has nothing of it.
TEST(Packs, DoNothingToARobotThatHasNothingOfThem) {
  int packs = 0;
  for (const auto& entry : std::filesystem::directory_iterator("rules/tests/packs")) {
    if (entry.path().extension() != ".rules") continue;
    ++packs;
    const auto rules = rule_files::read(entry.path().string());
    const Checked checked = check(*rules);
    ASSERT_TRUE(checked.rules) << render(checked.diagnostics, rules->source);
    std::string text = "RULES " + std::filesystem::absolute(entry.path()).string() + "\n";
    // Topics of absent components were never published; all others were before a test begins.
    std::string publishes = " PUBLISHES";
    for (const Topic& topic : checked.rules->topics) publishes += " " + topic.name;
    if (checked.rules->topics.empty()) publishes.clear();
    for (const Component& component : checked.rules->components)
      text += "COMPONENT " + component.name + " STATE absent" + std::exchange(publishes, "") + "\n";
    text += "TEST absent\n  RUN 3min\n  EXPECT NO STRATEGY\n";
    for (const Rule& rule : checked.rules->rules)
      text += "  EXPECT NOT " + rule.name + " DETECTED\n";
    const auto path = std::filesystem::path(testing::TempDir()) / "absent_pack.test";
    std::ofstream(path) << text;
    const FileRun run = run_file(path.string(), "", bayes, Colour::kOff);
    ASSERT_TRUE(run.is_usable) << run.complaints;
    EXPECT_EQ(run.suites.at(0).cases.at(0).failure, "") << entry.path();
  }
  EXPECT_GE(packs, 12);
}

TEST(FileRun, TakesOnlyTestsThatTheFilterNames) {
  const FileRun run = run_file("rules/tests/sunset.test", "F3:", bayes, Colour::kOff);
  ASSERT_EQ(run.suites.size(), 1u);
  ASSERT_EQ(run.suites[0].cases.size(), 1u);
  EXPECT_EQ(run.suites[0].cases[0].name, "F3: only the segmentation falls silent");
}

std::string write(const std::string& name, const std::string& text) {
  const auto path = std::filesystem::path(testing::TempDir()) / name;
  std::ofstream(path, std::ios::binary) << text;
  return path.string();
}

constexpr const char* kRules =
    "COMPONENT c NODE /c LAUNCH \"c\"\nRULE Dead\n  POLICIES ERROR\n  TRIGGER !alive(c)\n"
    "    STRATEGY redeploy 90 10\n      ADAPTATION c redeploy 5\n";
constexpr const char* kTest =
    "TEST t\n  AT 1s c KILLED\n  RUN 5s\n  EXPECT Dead RESOLVED WITH redeploy\n";

TEST(FileRun, RunsEachTestWithEachRuleFile) {
  write("file_run_a.rules", kRules);
  write("file_run_b.rules", kRules);
  const FileRun run =
      run_file(write("both.test", std::string("RULES file_run_a.rules file_run_b.rules\n") + kTest),
               "", bayes, Colour::kOff);
  ASSERT_TRUE(run.is_usable) << run.complaints;
  ASSERT_EQ(run.suites.size(), 2u);
  EXPECT_EQ(run.suites[1].cases.at(0).failure, "");
}

TEST(FileRun, RunsNothingOfAFileThatCannotBeUsed) {
  EXPECT_FALSE(run_file("no/such.test", "", bayes, Colour::kOff).is_usable);
  const FileRun no_rules = run_file(write("no_rules.test", kTest), "", bayes, Colour::kOff);
  EXPECT_FALSE(no_rules.is_usable);
  EXPECT_NE(no_rules.complaints.find("does not say which rules it tests"), std::string::npos);
  const FileRun rules = run_file(write("alone.rules", kRules), "", bayes, Colour::kOff);
  EXPECT_NE(rules.complaints.find("which begins with RULES alone.rules"), std::string::npos)
      << rules.complaints;
  const FileRun lost = run_file(write("lost.test", std::string("RULES gone.rules\n") + kTest), "",
                                bayes, Colour::kOff);
  EXPECT_FALSE(lost.is_usable);
  EXPECT_NE(lost.complaints.find("gone.rules"), std::string::npos);
  write("broken.rules", "RULE\n");
  const FileRun broken = run_file(write("broken.test", std::string("RULES broken.rules\n") + kTest),
                                  "", bayes, Colour::kOff);
  EXPECT_FALSE(broken.is_usable);
  EXPECT_NE(broken.complaints.find("broken.rules:1"), std::string::npos) << broken.complaints;
  EXPECT_EQ(broken.output, "");
}

}  // namespace
}  // namespace culprit::rule_test
