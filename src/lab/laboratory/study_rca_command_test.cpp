#include <algorithm>
#include <filesystem>
#include <vector>

#include <CLI/CLI.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/text_file.h"
#include "laboratory/commands.h"

namespace culprit::lab {
namespace {

using testing::HasSubstr;

class StudyRcaCommand : public testing::Test {
 protected:
  // On a small robot, with `more` options. Gives what is printed, or the complaint.
  std::string run(const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"rca",        "--components", "8",        "--faults",
                                          "2",          "--episodes",   "2",        "--planner",
                                          "patient:2s", "informed",     "--format", "csv"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    std::reverse(arguments.begin(), arguments.end());
    CLI::App study;
    int exit_code = -1;
    add_study_rca(study, "test", exit_code);
    testing::internal::CaptureStdout();
    std::string complaint;
    try {
      study.parse(arguments);
    } catch (const CLI::ParseError& error) {
      complaint = error.what();
    }
    const std::string printed = testing::internal::GetCapturedStdout();
    return complaint.empty() ? printed : complaint;
  }
};

TEST_F(StudyRcaCommand, RecordsTheFactorsThatDifferFromTheUsual) {
  EXPECT_THAT(run({"--detector-latency", "0..3s", "--stated", "--pass", "0.5", "--delay", "1..2s",
                   "--unwatched", "25%", "--hidden", "10%", "--common-causes", "1",
                   "--false-alarms", "0.5"}),
              HasSubstr("--detector-latency 0..3s --stated --pass 50% --delay 1..2s "
                        "--unwatched 25% --hidden 10% --common-causes 1 --false-alarms 0.5"));
  const std::string usual = run({});
  EXPECT_THAT(usual, HasSubstr("patient:2s,8,2,"));
  EXPECT_THAT(usual, HasSubstr("informed,8,2,"));
  EXPECT_EQ(run({"--detector-latency", "0..400ms", "--not-stated", "--pass", "90%", "--delay",
                 "0.1..0.8s", "--unwatched", "0%", "--hidden", "0", "--common-causes", "0",
                 "--false-alarms", "0"}),
            usual);
}

TEST_F(StudyRcaCommand, RefusesFactorsThatMakeNoSense) {
  EXPECT_EQ(run({"--detector-latency", "3..1s"}),
            "--detector-latency: '3..1s' ends before it begins; write the smaller value first, as "
            "in 1s..3s");
  EXPECT_EQ(run({"--unwatched", "95%"}),
            "--unwatched: '95%' is out of range; write a share from 0 to 90%, such as 30% or 0.3");
  EXPECT_THAT(run({"--common-causes", "11"}), HasSubstr("--common-causes"));
  EXPECT_THAT(run({"--false-alarms", "-1"}), HasSubstr("--false-alarms"));
}

TEST_F(StudyRcaCommand, RefusesFactorsWhereTheyChangeNothing) {
  EXPECT_THAT(run({"--regret", "--hidden", "10%"}), HasSubstr("--hidden excludes --regret"));
  EXPECT_THAT(run({"--learn", "10", "--unwatched", "10%"}),
              HasSubstr("--unwatched excludes --learn"));
}

// Exports into `folder` with `more` options, and gives the exit code.
int export_to(const std::filesystem::path& folder, std::vector<std::string> more) {
  more.insert(more.begin(), {"rca", "--export-cases", folder.string()});
  std::reverse(more.begin(), more.end());
  CLI::App study;
  int exit_code = -1;
  add_study_rca(study, "test", exit_code);
  study.parse(more);
  return exit_code;
}

TEST(StudyRcaExport, WritesTheSmallSetOnce) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "culprit-study-rca-export";
  std::filesystem::remove_all(folder);
  EXPECT_EQ(export_to(folder, {"--cases", "1", "--seed", "3", "--hidden-seed", "3"}), kUsage);
  EXPECT_FALSE(std::filesystem::exists(folder));
  EXPECT_EQ(export_to(folder, {"--cases", "1", "--common-causes", "1"}), kOk);
  EXPECT_TRUE(std::filesystem::exists(folder / "public/case-0001/truth.json"));
  EXPECT_FALSE(std::filesystem::exists(folder / "hidden"));
  for (const char* robot : {"rover", "sunset"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / robot / "case-0001/truth.json")) << robot;
    EXPECT_TRUE(std::filesystem::exists(folder / (std::string(robot) + "-answers-bayes.json")))
        << robot;
  }
  EXPECT_THAT(*read_text((folder / "README.md").string()),
              HasSubstr("--cases 1 --components 12,16,20 --faults 1,2,3 --noise 0 "
                        "--detector-latency 0..3s --unwatched 20% --hidden 10% --common-causes 1 "
                        "--false-alarms 0.5 --objective balanced --seed 1"));
  EXPECT_EQ(export_to(folder, {"--cases", "1"}), kUsage) << "it is not empty";
  std::filesystem::remove_all(folder);
}

TEST(StudyRcaExport, HidesCasesOfEachKindOfRobot) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "culprit-study-rca-hidden";
  std::filesystem::remove_all(folder);
  EXPECT_EQ(
      export_to(folder, {"--cases", "1", "--hidden-seed", "98765432123", "--hidden-cases", "1"}),
      kOk);
  for (const std::string set : {"hidden", "hidden-rover", "hidden-sunset"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / set / "case-0001/signals.csv")) << set;
    EXPECT_FALSE(std::filesystem::exists(folder / set / "case-0001/truth.json")) << set;
    EXPECT_TRUE(std::filesystem::exists(folder / (set + "-truth.json"))) << set;
  }
  std::filesystem::remove_all(folder);
}

TEST(StudyRcaExport, HasASmallSetOfFiveMegabytesAtMost) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "culprit-study-rca-small";
  std::filesystem::remove_all(folder);
  EXPECT_EQ(export_to(folder, {"--hidden-seed", "98765432123"}), kOk);
  std::uintmax_t bytes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    bytes += entry.is_regular_file() ? entry.file_size() : 0;
  EXPECT_GT(bytes, 100'000U);
  EXPECT_LE(bytes, 5'000'000U);
  std::filesystem::remove_all(folder);
}

TEST_F(StudyRcaCommand, RefusesOptionsThatAnExportDoesNotUse) {
  EXPECT_THAT(run({"--export-cases", "nowhere"}), HasSubstr("--export-cases"));
  EXPECT_THAT(run({"--hidden-seed", "4"}), HasSubstr("--hidden-seed requires --export-cases"));
}

}  // namespace
}  // namespace culprit::lab
