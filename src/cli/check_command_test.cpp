#include <fstream>
#include <iterator>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "cli/commands.h"
#include "terminal/command.h"
#include "terminal/program.h"

namespace culprit::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

class CheckCommand : public testing::Test {
 protected:
  int check_file(const std::string& text, std::vector<std::string> words) {
    std::ofstream(file_) << text;
    words.insert(words.begin(), {"culprit", "check"});
    words.push_back(file_);
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    CLI::App app("culprit");
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int code = run_program(
        app, [&](int& exit_code) { add_check(app, exit_code); }, static_cast<int>(words.size()),
        argv.data());
    printed_ = testing::internal::GetCapturedStdout();
    said_ = testing::internal::GetCapturedStderr();
    return code;
  }
  std::string written() const {
    std::ifstream in(file_, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  }

  test::TestFolder folder_;
  const std::string file_ = folder_ / "my.rules";
  std::string printed_, said_;
};

constexpr const char* kGood =
    "COMPONENT camera NODE /camera LAUNCH \"sh -c true\"\n"
    "RULE Camera_Silent\n"
    "  POLICIES ERROR FOR 2s\n"
    "  TRIGGER age(/image) >= 2s && !alive(camera)\n"
    "    STRATEGY redeploy_it 80 50\n"
    "      ADAPTATION camera redeploy 10\n";

TEST_F(CheckCommand, FixesUntilNothingIsLeft) {
  EXPECT_EQ(check_file("component camera node /camera launch \"sh -c true\"\n"
                       "rule Camera Silent\n"
                       "  policies error for 2 seconds\n"
                       "  trigger age(/image) => 2s and not alive(camera)\n"
                       "    strategy redeploy-it 0.8 50\n"
                       "      adaptation redeploy camera 10\n",
                       {"--fix"}),
            kOk);
  EXPECT_EQ(written(), kGood);
  EXPECT_THAT(printed_, HasSubstr("my.rules:2:1: change 'rule' to 'RULE'"));
}

TEST_F(CheckCommand, LeavesAFileWithoutFixesAsItIs) {
  EXPECT_EQ(check_file(kGood, {"--fix"}), kOk);
  EXPECT_EQ(written(), kGood);
  EXPECT_EQ(check_file("CYCLE 200\n", {"--fix"}), kFailed) << "which unit?";
  EXPECT_EQ(written(), "CYCLE 200\n");
}

TEST_F(CheckCommand, WarnsOfAFileWithoutARule) {
  for (const char* empty : {"", "# later\n", "IGNORE TOPIC /clock\n"}) {
    EXPECT_EQ(check_file(empty, {}), kOk);
    EXPECT_THAT(said_, HasSubstr("warning[R006]: this file has no rule")) << empty;
    EXPECT_THAT(printed_, HasSubstr("0 components: 1 warning\n")) << empty;
  }
  EXPECT_EQ(check_file("CONST limit = 2s\n", {}), kOk) << "another file may include it";
  EXPECT_THAT(printed_, HasSubstr("0 components: ok\n"));
  EXPECT_EQ(said_, "");
}

TEST_F(CheckCommand, ReportsAWordOfTheShellOnce) {
  std::string rules = kGood;
  rules.replace(rules.find("sh -c true"), 10, "~/start.sh");
  EXPECT_EQ(check_file(rules, {}), kOk);
  EXPECT_THAT(said_, HasSubstr("no shell reads this command"));
  EXPECT_THAT(said_, Not(HasSubstr("could be started")));
}

TEST_F(CheckCommand, FailsOnWarningsIfAsked) {
  const std::string unused = std::string("COMPONENT lidar NODE /lidar\n") + kGood;
  EXPECT_EQ(check_file(unused, {}), kOk);
  EXPECT_EQ(check_file(unused, {"--fail-on", "warning"}), kFailed);
  EXPECT_EQ(check_file(kGood, {"--fail-on", "warning"}), kOk);
}

}  // namespace
}  // namespace culprit::cli
