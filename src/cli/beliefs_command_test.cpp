// culprit beliefs as a user runs it.
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "cli/commands.h"
#include "cli/test_command.h"
#include "journal/writer.h"

namespace culprit::cli {
namespace {

struct BeliefsCommand : testing::Test {
  void learn(const journal::Learned& learned) const {
    auto writer = journal::Writer::open(path, {});
    ASSERT_TRUE(writer) << writer.error();
    ASSERT_TRUE(writer->append({{}, learned}, 1, journal::Durability::kPowerFailure));
  }
  // Gives what `culprit beliefs show` prints.
  std::string shown(std::vector<std::string> options = {}) const {
    std::vector<std::string> words = {"beliefs", "show", "--journal", path.string()};
    words.insert(words.end(), options.begin(), options.end());
    const CommandEnd end = end_of_command(add_beliefs, std::move(words));
    EXPECT_EQ(end.exit_code, kOk) << end.out;
    return end.out;
  }

  const test::TestFolder own;
  const std::filesystem::path path = own / "a.journal";
};

TEST_F(BeliefsCommand, ShowsAllThatWasLearned) {
  learn({{{"CameraDark", "brighten", {6, 2}, {5, 1}}},
         {{"CameraDark", "MapOld", {2, 1, 0}}, {"CameraDark", "RobotLost", {0, 0, 3.5}}},
         {{"MapOld", 4, 0.5, 2.25}},
         {{"CameraDark", "CameraDark", 9},
          {"CameraDark", "MapOld", 1},
          {"CameraDark", "RobotLost", 3},
          {"MapOld", "MapOld", 1},
          {"RobotLost", "RobotLost", 4}}});
  EXPECT_EQ(
      shown(),
      R"(rule                         strategy                       rules     now   helped  did not
CameraDark                   brighten                      83.3 %  75.0 %        1        1

when this was resolved       this cleared                      yes       no unaffected
CameraDark                   MapOld                              2        1          0
CameraDark                   RobotLost                           0        0        3.5

How late rules are
rule                            count     from       to
MapOld                              4    0.5 s   2.25 s

Failures that begin together
rule                         rule                         together       of
CameraDark                   RobotLost                           3        4
)");
  EXPECT_THAT(
      shown({"--json"}),
      testing::HasSubstr(R"("effect":"RobotLost","cleared":0.0,"stayed":0.0,"spared":3.5)"));
  EXPECT_THAT(shown({"--json"}),
              testing::HasSubstr(R"({"rule":"CameraDark","other":"RobotLost","count":3})"));
}

TEST_F(BeliefsCommand, ShowsFailuresThatBeginTogetherAloneAndNotOnce) {
  learn({{}, {}, {}, {{"MapOld", "MapOld", 1}, {"MapOld", "RobotLost", 1}}});
  EXPECT_THAT(shown(), testing::HasSubstr("nothing was learned yet"));
  learn({{},
         {},
         {},
         {{"MapOld", "MapOld", 2}, {"MapOld", "RobotLost", 2}, {"RobotLost", "RobotLost", 5}}});
  EXPECT_THAT(shown(), testing::ContainsRegex("MapOld +RobotLost +2 +2"));
}

// A repair that worked is learned from only once it lasted. Until then it is said that it waits.
TEST_F(BeliefsCommand, ShowsHowManyOutcomesArePending) {
  const auto write = [&](std::string_view kind, const std::string& body) {
    auto writer = journal::Writer::open(path, {});
    ASSERT_TRUE(writer) << writer.error();
    ASSERT_TRUE(writer->append({{{0, 1, std::string(kind), body}}, {}}, 1,
                               journal::Durability::kPowerFailure));
  };
  const auto outcome = [&](const char* type, const char* strategy) {
    write(journal::kind::kEvent, std::string(R"({"type":")") + type + R"(","rule":"CameraDark",)" +
                                     R"("strategy":")" + strategy + R"("})");
  };
  write(journal::kind::kSession,
        R"({"past":[{"type":"outcome_pending","rule":"MapOld","strategy":"reload"}]})");
  outcome("outcome_pending", "brighten");
  outcome("outcome_pending", "brighten");
  outcome("outcome_pending", "restart");
  outcome("outcome_counted", "restart");
  const std::string all =
      "\n3 outcomes are pending, not counted yet\n  brighten of CameraDark (2)\n"
      "  reload of MapOld\n";
  EXPECT_THAT(shown(), testing::AllOf(testing::HasSubstr("nothing was learned yet"),
                                      testing::EndsWith(all)));
  learn({{{"CameraDark", "restart", {6, 2}, {5, 1}}}, {}, {}});
  EXPECT_THAT(shown(), testing::EndsWith("\n" + all));
  write(journal::kind::kEnd, R"({"text":"culprit was asked to stop"})");
  EXPECT_THAT(shown(), testing::Not(testing::HasSubstr("pending")));
}

TEST_F(BeliefsCommand, ShowsExposureAloneAndNoCouplingThatWasForgotten) {
  learn({{}, {{"CameraDark", "RobotLost", {0, 0, 3.5}}, {"CameraDark", "MapOld", {}}}, {}});
  EXPECT_THAT(shown(), testing::HasSubstr("RobotLost"));
  EXPECT_THAT(shown(), testing::Not(testing::HasSubstr("MapOld")));
  learn({{}, {{"CameraDark", "RobotLost", {}}}, {}});
  EXPECT_THAT(shown(), testing::HasSubstr("nothing was learned yet"));
}

}  // namespace
}  // namespace culprit::cli
