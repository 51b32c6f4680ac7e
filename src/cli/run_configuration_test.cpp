#include "cli/run_configuration.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <sys/stat.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/environment.h"
#include "base/test_folder.h"
#include "cli/run_options.h"

namespace culprit::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class RunConfigurationFile : public testing::Test {
 protected:
  std::string write(const std::string& text) {
    std::ofstream(file_) << text;
    return file_;
  }
  Expected<RunConfiguration> with(const std::string& text,
                                  std::vector<std::string> words = {"run"}) {
    words.insert(words.end(), {"--config", write(text)});
    return with_configuration(std::move(words));
  }
  std::string error_of(const std::string& text) {
    const auto result = with(text);
    return result ? "no error" : result.error();
  }
  std::vector<std::string> added(const std::string& text, const std::vector<std::string>& words) {
    const auto result = with(text, words);
    if (!result) return {result.error()};
    return {result->words.begin() + static_cast<std::ptrdiff_t>(words.size()) + 2,
            result->words.end()};
  }

  test::TestFolder folder_;
  const std::string file_ = folder_.path() / "culprit.toml";
};

TEST_F(RunConfigurationFile, StandsForOptions) {
  EXPECT_THAT(
      added("# a comment\nrules = \"my.rules\"\nweb = true\ndry-run = false\nsettle = \"8s\"\n",
            {"run"}),
      ElementsAre("my.rules", "--web", "--settle=8s"));
}

// It chooses the rules and the programs that are run.
TEST_F(RunConfigurationFile, IsOneThatNobodyElseCanChange) {
  write("rules = \"my.rules\"\n");
  std::filesystem::permissions(file_, std::filesystem::perms(0666));
  EXPECT_THAT(
      error_of("rules = \"my.rules\"\n"),
      HasSubstr("another user could change it: " + file_ + " is writable by others; chmod"));
}

// Reading it would wait for that user.
TEST_F(RunConfigurationFile, IsNoPipeThatOthersCanChange) {
  ASSERT_EQ(mkfifo(file_.c_str(), 0600), 0);
  ASSERT_EQ(chmod(file_.c_str(), 0666), 0);
  const auto result = with_configuration({"run", "--config", file_});
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error(), HasSubstr("another user could change it"));
}

TEST_F(RunConfigurationFile, GivesWayToTheCommandLine) {
  EXPECT_THAT(added("rules = \"my.rules\"\nweb = true\nsettle = \"8s\"\n",
                    {"run", "other.rules", "--settle", "3s"}),
              ElementsAre("--web"));
}

TEST_F(RunConfigurationFile, GivesWayToTheEnvironment) {
  setenv("CULPRIT_SETTLE", "3s", 1);
  EXPECT_THAT(added("web = true\nsettle = \"8s\"\n", {"run", "my.rules"}), ElementsAre("--web"));
  unsetenv("CULPRIT_SETTLE");
}

TEST_F(RunConfigurationFile, NamesTheLineOfAMistake) {
  EXPECT_EQ(error_of("web = true\nsettel = \"8s\"\n"),
            file_ + ":2: culprit run has no option 'settel'; did you mean 'settle'?");
  EXPECT_EQ(error_of("dry_run = true\n"),
            file_ + ":1: culprit run has no option 'dry_run'; did you mean 'dry-run'?");
  EXPECT_THAT(error_of("\nsettle = \"soon\"\n"), HasSubstr(":2: --settle: "));
  EXPECT_EQ(error_of("web = \"maybe\"\n"), file_ + ":1: web is true or false, not 'maybe'");
  EXPECT_THAT(error_of("settle: 5s\n"), HasSubstr("is no setting; write settle = \"5s\""));
  EXPECT_THAT(error_of("web = true\nweb = true\n"), HasSubstr("web is given twice; keep one"));
  EXPECT_THAT(error_of("planner = \"foo\"\n"), HasSubstr("'foo' is none of bayes, paper"));
  EXPECT_THAT(error_of("[run]\nweb = true\n"), HasSubstr("the file has no sections"));
  EXPECT_THAT(error_of("config = \"other.toml\"\n"), HasSubstr("has no option 'config'"));
  EXPECT_EQ(error_of("web = true\nweb-cert = \"\"\n"),
            file_ + ":2: web-cert is empty; write a value, or remove the line for the default");
  EXPECT_THAT(error_of("rules = \"\"\n"), HasSubstr("rules is empty; write a value"));
}

TEST_F(RunConfigurationFile, SaysHowALineIsWritten) {
  EXPECT_EQ(error_of("rules = \"a.rules\"\nweb: true\n"),
            file_ + ":2: 'web: true' is no setting; write web = true");
  EXPECT_EQ(error_of("web true\n"), file_ + ":1: 'web true' is no setting; write web = true");
  EXPECT_EQ(error_of("--web = true\n"),
            file_ + ":1: culprit run has no option '--web'; did you mean 'web'?");
  EXPECT_EQ(error_of("for the lab\n"),
            file_ +
                ":1: 'for the lab' is no setting; write settle = \"5s\", and # in front of a "
                "comment");
  EXPECT_EQ(error_of("watch = true\n"),
            file_ + ":1: culprit run has no option 'watch'; culprit run --print-config lists all");
  EXPECT_EQ(error_of("web = true\nrules = \"a.rules\n"),
            file_ + ":2: this value has no end; write the closing quote, or the ] of its list");
  EXPECT_EQ(error_of("record-topics = [\"/scan\", \"/odom\"\nweb = true\n"),
            file_ + ":1: this value has no end; write the closing quote, or the ] of its list");
  EXPECT_EQ(error_of("record-topics = [\"/scan\",\n  \"/odom\"]\nweb = true\n"), "no error");
  EXPECT_EQ(error_of("allow-host = [\"a=b]\", # c = d\n  'e']\nweb = true\n"), "no error");
  EXPECT_EQ(error_of("CULPRIT_SETTLE = \"8s\"\n"),
            file_ + ":1: culprit run has no option 'CULPRIT_SETTLE'; did you mean 'settle'?");
  EXPECT_EQ(error_of("RULES = \"a.rules\"\n"),
            file_ + ":1: culprit run has no option 'RULES'; did you mean 'rules'?");
  EXPECT_EQ(error_of("web = true\nport = 1\nweb = false\n"),
            file_ + ":3: web is given twice; keep one");
}

TEST_F(RunConfigurationFile, NamesTheHomeFolderAsAShellDoes) {
  const auto home = environment("HOME");
  setenv("HOME", "/home/ada", 1);
  EXPECT_THAT(added("rules = \"~/my.rules\"\nstate-dir = \"~/state\"\n", {"run"}),
              ElementsAre("/home/ada/my.rules", "--state-dir=/home/ada/state"));
  EXPECT_EQ(error_of("state-dir = \"$HOME/state\"\n"),
            file_ + ":1: state-dir: no shell reads '$HOME/state' here; write \"~/state\"");
  EXPECT_THAT(error_of("alerts = \"$ALERTS\"\n"), HasSubstr("write the variable's value"));
  unsetenv("HOME");
  EXPECT_THAT(error_of("rules = \"~/my.rules\"\n"),
              HasSubstr(":1: rules: '~' stands for no folder"));
  setenv("HOME", home.c_str(), 1);
}

TEST_F(RunConfigurationFile, SaysWhatOtherFilesAreWrittenAs) {
  EXPECT_EQ(error_of("rules: my.rules\n"),
            file_ + ":1: 'rules: my.rules' is no setting; write rules = \"my.rules\"");
  EXPECT_EQ(error_of("rules = [\"a.rules\", \"b.rules\"]\n"),
            file_ + ":1: rules is one file; INCLUDE in it reads others");
  EXPECT_EQ(error_of("web = true\nlog-level = \"debug\"\n"),
            file_ +
                ":2: culprit run has no option 'log-level'; culprit log -f shows each event as "
                "it comes");
  EXPECT_THAT(error_of("export ROS_DOMAIN_ID=7\n"), HasSubstr("set the variable where culprit"));
  EXPECT_EQ(error_of("restarts = 5\n"),
            file_ + ":1: --restarts: '5' is no intensity; write 5/1min");
  EXPECT_THAT(error_of("record-topics = \"/scan, /odom\"\n"),
              HasSubstr("give each topic by itself"));
}

TEST_F(RunConfigurationFile, MustBeThere) {
  const auto result = with_configuration({"run", "--config", folder_.path() / "none.toml"});
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error(), HasSubstr("none.toml"));
  EXPECT_THAT(result.error(), HasSubstr("--print-config > culprit.toml writes one"));
  const auto folder = with_configuration({"run", "--config", folder_.path()});
  ASSERT_FALSE(folder);
  EXPECT_THAT(folder.error(), testing::Not(HasSubstr("--print-config")));
}

TEST_F(RunConfigurationFile, IsPrintedWithEveryOption) {
  const auto result = with("web = true\n", {"run", "my.rules", "--print-config"});
  ASSERT_TRUE(result) << result.error();
  EXPECT_THAT(result->printed, HasSubstr("\nrules = \"my.rules\"\n"));
  EXPECT_THAT(result->printed, HasSubstr("\nweb = true\n"));
  EXPECT_THAT(result->printed, HasSubstr("\n# dry-run = false\n"));
  EXPECT_THAT(result->printed, HasSubstr("\n# settle = "));
  const auto again = with(result->printed, {"run"});
  ASSERT_TRUE(again) << again.error();
  EXPECT_THAT(again->words, testing::Contains("--web"));
}

TEST_F(RunConfigurationFile, MayHaveEachPrintedOptionWithoutItsCommentSign) {
  const auto result = with("", {"run", "my.rules", "--print-config"});
  ASSERT_TRUE(result) << result.error();
  std::istringstream lines(result->printed);
  int count = 0;
  for (std::string line; std::getline(lines, line);) {
    const auto sign = line.find(" = ");
    const bool is_option =
        line.starts_with("# ") && sign != std::string::npos && line.find(' ', 2) == sign;
    if (!is_option) continue;
    ++count;
    EXPECT_EQ(error_of(line.substr(2) + "\n"), "no error") << line;
  }
  EXPECT_GT(count, 20);
  EXPECT_THAT(result->printed, HasSubstr("\n# web-cert is not set\n"));
}

TEST(RunOptions, SayWhichHaveNoEffect) {
  RunOptions options;
  EXPECT_EQ(options.remarks(), "");
  options.fleet.context = "lab";
  EXPECT_THAT(options.remarks(), HasSubstr("--fleet-context have no effect without --fleet\n"));
  options.fleet.address = "postgresql://hub/fleet";
  EXPECT_EQ(options.remarks(), "");
  options.governor.backoff_seconds = 120;
  EXPECT_THAT(options.remarks(), HasSubstr("--backoff-most limits the back-off to 1min"));
}

TEST_F(RunConfigurationFile, LeavesAWrongLineToItsParser) {
  const auto result = with_configuration({"run", "--no-such-option"});
  ASSERT_TRUE(result);
  EXPECT_THAT(result->words, ElementsAre("run", "--no-such-option"));
}

TEST_F(RunConfigurationFile, IsPrintedWithAFlagThatTheEnvironmentTurnsOff) {
  setenv("CULPRIT_APPROVE", "false", 1);
  const auto result = with_configuration({"run", "my.rules", "--print-config"});
  unsetenv("CULPRIT_APPROVE");
  ASSERT_TRUE(result) << result.error();
  EXPECT_THAT(result->printed, HasSubstr("\napprove = false\n"));
}

}  // namespace
}  // namespace culprit::cli
