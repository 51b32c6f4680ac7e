// Rule tests about situations of real robots: src/tools/rule_test/decisions.
// Each file says what is right and why.
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "plan/bayes/bayes_planner.h"
#include "rule_files/rule_files.h"
#include "rule_test/file_run.h"

namespace culprit::rule_test {
namespace {

const auto kFiles = rule_files::files_in("src/tools/rule_test/decisions", ".test");

class Decisions : public testing::TestWithParam<std::string> {};

TEST_P(Decisions, AreRight) {
  const FileRun run = run_file(
      GetParam(), "", [] { return std::make_unique<BayesPlanner>(); }, Colour::kOff);
  ASSERT_TRUE(run.is_usable) << run.complaints;
  for (const SuiteReport& suite : run.suites) {
    EXPECT_FALSE(suite.cases.empty());
    for (const auto& test : suite.cases) EXPECT_EQ(test.failure, "") << test.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Files, Decisions, testing::ValuesIn(*kFiles), [](const auto& test) {
  std::string name = test.param.substr(test.param.rfind('/') + 1);
  name.resize(name.find('.'));
  return name;
});

}  // namespace
}  // namespace culprit::rule_test
