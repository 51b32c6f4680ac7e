// culprit policy as a user runs it. The policy's effect on DDS is tested in ros2/policy_test.cpp.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "cli/commands.h"
#include "cli/unit_settings.h"
#include "language/checker.h"

namespace culprit::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

struct PolicyCommand : testing::Test {
  PolicyCommand() { setenv("ROS_DOMAIN_ID", "42", 1); }
  ~PolicyCommand() override { unsetenv("ROS_DOMAIN_ID"); }

  // Gives the exit code; what was written is in `written`, what was said in `said`.
  int run(std::vector<std::string> arguments) {
    const std::string output = (folder / "out").string();
    arguments.insert(arguments.end(), {"-o", output});
    arguments.insert(arguments.begin(), "policy");
    CLI::App app;
    int exit_code = -1;
    add_policy(app, exit_code);
    std::reverse(arguments.begin(), arguments.end());
    testing::internal::CaptureStderr();
    app.parse(std::move(arguments));
    said = testing::internal::GetCapturedStderr();
    std::ifstream in(output);
    written.assign(std::istreambuf_iterator<char>(in), {});
    return exit_code;
  }

  const test::TestFolder own;
  const std::filesystem::path folder = own.path();
  std::string written;
  std::string said;
};

TEST_F(PolicyCommand, WritesAPolicyOfSros2AndSaysHowItIsSigned) {
  ASSERT_EQ(run({"rules/sunset.rules"}), kOk) << said;
  EXPECT_THAT(written, HasSubstr("<enclave path=\"/culprit\">"));
  EXPECT_THAT(said, HasSubstr("ros2 security create_permission KEYSTORE /culprit "));
}

TEST_F(PolicyCommand, WritesPermissionsOfTheDomainForSoManyDays) {
  ASSERT_EQ(run({"rules/sunset.rules", "--format", "permissions", "--enclave", "/robot/culprit"}),
            kOk)
      << said;
  EXPECT_THAT(written, HasSubstr("<subject_name>CN=/robot/culprit</subject_name>"));
  EXPECT_THAT(written, HasSubstr("<domains><id>42</id></domains>"));
  EXPECT_THAT(said, HasSubstr("openssl smime -sign -text"));
}

TEST_F(PolicyCommand, RefusesWhatIsNoEnclave) {
  EXPECT_EQ(run({"rules/sunset.rules", "--enclave", "/a\"/><x"}), kUsage);
  EXPECT_THAT(said, HasSubstr("is no enclave; it is a path such as /culprit"));
  EXPECT_EQ(written, "");
}

TEST_F(PolicyCommand, ANodeThatWantsSnapshotsMayAskForThem) {
  ASSERT_EQ(run({"rules/sunset.rules"}), kOk);
  EXPECT_THAT(written, Not(HasSubstr("snapshot")));
  ASSERT_EQ(run({"rules/sunset.rules", "--snapshot", "/rosbag2_recorder"}), kOk);
  EXPECT_THAT(written, HasSubstr("<service>/rosbag2_recorder/snapshot</service>"));
}

TEST_F(PolicyCommand, ImprovisedRulesNeedMore) {
  const std::string rules = (folder / "my.rules").string();
  std::ofstream(rules) << "COMPONENT camera NODE /camera LAUNCH \"camera\"\n";
  ASSERT_EQ(run({rules}), kOk);
  EXPECT_THAT(written, Not(HasSubstr("/camera/change_state")));
  ASSERT_EQ(run({rules, "--improvise"}), kOk);
  EXPECT_THAT(written, HasSubstr("/camera/change_state"));
}

// The settings for rules about a camera and a base, each with its action.
std::string settings(const std::string& camera, const std::string& base,
                     const UnitOptions& options = {"/etc/culprit/robot.rules"}) {
  const std::string rules =
      "COMPONENT camera LAUNCH \"camera\"\nCOMPONENT base LAUNCH \"base\"\nRULE r\n POLICIES "
      "ERROR\n"
      " TRIGGER age(/rgb) > 1s\n  STRATEGY a 50 10\n   ADAPTATION camera " +
      camera + " 1\n  STRATEGY b 50 10\n   ADAPTATION base " + base + " 1\n";
  return unit_settings(*check(Source("test.rules", rules)).rules, options);
}

TEST(UnitSettings, SayWhatIsRun) {
  UnitOptions options{"/home/me/100 % \"best\" for $.rules"};
  options.environment = {{"ROS_DOMAIN_ID", "42"}, {"ROS_SECURITY_KEYSTORE", "/etc/keys"}};
  const std::string text = settings("restart", "restart", options);
  EXPECT_THAT(text, HasSubstr("ExecStart=\nExecStart=/usr/bin/culprit run "
                              "\"/home/me/100 %% \\\"best\\\" for $$.rules\" --state-dir "));
  EXPECT_THAT(text, HasSubstr("Environment=\"ROS_DOMAIN_ID=42\"\n"
                              "Environment=\"ROS_SECURITY_KEYSTORE=/etc/keys\"\n"));
}

TEST(UnitSettings, WhatStartsNothingCanExecuteNothing) {
  EXPECT_THAT(settings("stop", "restart"), HasSubstr("NoExecPaths=/\n"));
  EXPECT_THAT(settings("stop", "restart"), HasSubstr("MemoryMax=1G\n"));
  EXPECT_THAT(settings("redeploy", "restart"), Not(HasSubstr("MemoryMax=1G\n")))
      << "it would count what is started";
  EXPECT_THAT(settings("redeploy", "restart"), Not(HasSubstr("NoExecPaths")));
  EXPECT_THAT(settings("redeploy", "start"),
              HasSubstr("These are started and live in this sandbox: camera, base."));
}

TEST(UnitSettings, WhatEndsNothingNeedNotBeAnybody) {
  EXPECT_THAT(settings("restart", "restart"), HasSubstr("DynamicUser=yes"));
  EXPECT_THAT(settings("start", "restart"), Not(HasSubstr("DynamicUser")));
  EXPECT_THAT(settings("stop", "restart"), HasSubstr("User= must be their user: camera."));
}

TEST(UnitSettings, WhatSystemdStartsAndEndsTakesARightAndNothingElse) {
  const std::string rules =
      "COMPONENT camera UNIT camera.service\nRULE r\n POLICIES ERROR\n TRIGGER age(/rgb) > 1s\n"
      "  STRATEGY a 50 10\n   ADAPTATION camera redeploy 1\n";
  const std::string text = unit_settings(*check(Source("test.rules", rules)).rules, {"/r"});
  EXPECT_THAT(text, HasSubstr("NoExecPaths=/\n"));
  EXPECT_THAT(text, Not(HasSubstr("DynamicUser")));
  EXPECT_THAT(text, HasSubstr("User= needs the right to (docs/security.md): camera."));
}

TEST(UnitSettings, WhatAnEngineOrAContainerStartsIsNoProgramOfCulprits) {
  const std::string rules =
      "COMPONENT slam CONTAINER docker slam\nCOMPONENT box NODE /box LAUNCH \"box\"\n"
      "COMPONENT part NODE /part IN /box PLUGIN p::P\n"
      "RULE r\n POLICIES ERROR\n TRIGGER age(/rgb) > 1s\n"
      "  STRATEGY a 50 10\n   ADAPTATION slam redeploy 1\n   ADAPTATION part redeploy 1\n";
  const std::string text = unit_settings(*check(Source("test.rules", rules)).rules, {"/r"});
  EXPECT_THAT(text, HasSubstr("User= needs their sockets (docs/security.md): slam."));
  EXPECT_THAT(text, HasSubstr("box"));
  EXPECT_THAT(text, Not(HasSubstr("part")));
}

TEST(UnitSettings, WhatIsAskedOverSshTakesAProgramAndAKey) {
  const std::string rules =
      "COMPONENT camera UNIT camera.service HOST rover2\nRULE r\n POLICIES ERROR\n"
      " TRIGGER age(/rgb) > 1s\n  STRATEGY a 50 10\n   ADAPTATION camera redeploy 1\n";
  const std::string text = unit_settings(*check(Source("test.rules", rules)).rules, {"/r"});
  EXPECT_THAT(text, Not(HasSubstr("NoExecPaths"))) << "ssh is executed";
  EXPECT_THAT(text, Not(HasSubstr("DynamicUser")));
  EXPECT_THAT(text, HasSubstr("asked over ssh, so User=\n# needs a home with a key"));
}

// systemd reads each line of the unit, and scores it (docs/security.md).
TEST(ServiceUnit, IsTakenBySystemdAsItIs) {
  const auto run = [](const std::string& command) { return std::system(command.c_str()); };
  if (run("command -v systemd-analyze > /dev/null") != 0)
    GTEST_SKIP() << "there is no systemd here";
  EXPECT_EQ(run("systemd-analyze security --offline=true --threshold=18 packaging/culprit.service "
                "> /dev/null"),
            0);
  const test::TestFolder folder;
  std::ofstream unit(folder / "culprit.service");
  std::ifstream from("packaging/culprit.service");
  std::set<std::string> lines;
  for (std::string text; std::getline(from, text);) {
    lines.insert(text);
    // There need be neither that program nor that user here.
    if (text.starts_with("ExecStart=")) text = "ExecStart=/bin/true";
    if (text.starts_with("Documentation=") || text.starts_with("User=")) continue;
    unit << text << "\n";
  }
  unit.close();
  const std::string said = (folder / "said").string();
  EXPECT_EQ(run("systemd-analyze verify " + (folder / "culprit.service").string() + " 2> " + said),
            0);
  std::ifstream words(said);
  EXPECT_THAT(std::string(std::istreambuf_iterator<char>(words), {}),
              Not(HasSubstr("culprit.service")));
  for (const char* each : {"OOMScoreAdjust=-500", "TasksMax=4096", "MemoryMax=75%",
                           "ProtectSystem=strict", "RuntimeDirectoryMode=0700",
                           "StateDirectoryMode=0700", "UMask=0077", "NoNewPrivileges=yes"})
    EXPECT_TRUE(lines.contains(each)) << each;
}

TEST(UnitSettings, OtherUsersProcessesTakeCapabilities) {
  const UnitOptions options{"/r", NodeOwner::kOtherUsers};
  EXPECT_THAT(settings("stop", "redeploy", options),
              HasSubstr("\nAmbientCapabilities=CAP_KILL CAP_SYS_PTRACE\n"));
  EXPECT_THAT(settings("restart", "restart", options),
              HasSubstr("\nAmbientCapabilities=CAP_SYS_PTRACE\n"));
}

}  // namespace
}  // namespace culprit::cli
