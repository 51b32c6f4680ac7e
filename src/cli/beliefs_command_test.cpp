// culprit beliefs as a user runs it.
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "cli/commands.h"
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
    CLI::App app;
    int exit_code = -1;
    add_beliefs(app, exit_code);
    std::reverse(words.begin(), words.end());
    testing::internal::CaptureStdout();
    app.parse(std::move(words));
    std::string printed = testing::internal::GetCapturedStdout();
    EXPECT_EQ(exit_code, kOk) << printed;
    return printed;
  }

  const test::TestFolder own;
  const std::filesystem::path path = own / "a.journal";
};

TEST_F(BeliefsCommand, ShowsAllThatWasLearned) {
  learn({{{"CameraDark", "brighten", {6, 2}, {5, 1}}},
         {{"CameraDark", "MapOld", {2, 1, 0}}, {"CameraDark", "RobotLost", {0, 0, 3.5}}},
         {{"MapOld", 4, 0.5, 2.25}}});
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
)");
  EXPECT_THAT(
      shown({"--json"}),
      testing::HasSubstr(R"("effect":"RobotLost","cleared":0.0,"stayed":0.0,"spared":3.5)"));
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
