// Programs of another user that listen where root looks for running culprits: they are silent, trickle, never end, or say
// that they are one. None of them keeps root's pause from the real one, delays it, or answers in its place.
#include <csignal>
#include <filesystem>
#include <sched.h>
#include <string>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/environment.h"
#include "base/live_clock.h"
#include "cli/test_hostile_sockets.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kLocalRules = R"(
ROBOT yard
COMPONENT camera NODE /managed_subsystem/camera
RULE CameraGone
  POLICIES ERROR
  TRIGGER alive(camera) == false
    STRATEGY camera_redeploy 90 10
      ADAPTATION camera restart 5
)";

// Private /tmp and /run for this process and its children. Root's command looks through both for all culprits of the machine, and would find those of other
// tests. Without the right to mount, it does nothing.
class OwnFolders {
 public:
  OwnFolders() {
    const std::string programs = own_folder();
    if (geteuid() != 0 || programs.starts_with("/tmp/") || programs.starts_with("/run/")) return;
    are_own_ = unshare(CLONE_NEWNS) == 0 &&
               mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
               mount("none", "/tmp", "tmpfs", 0, "mode=1777") == 0 &&
               mount("none", "/run", "tmpfs", 0, "mode=0755") == 0;
    // The folder for temporary files of all tests is not there any more.
    if (are_own_) unsetenv("TMPDIR");
  }
  ~OwnFolders() {
    if (!are_own_) return;
    umount2("/tmp", MNT_DETACH);
    umount2("/run", MNT_DETACH);
  }
  OwnFolders(const OwnFolders&) = delete;
  bool are_own() const { return are_own_; }

 private:
  bool are_own_ = false;
};

struct HostileNeighbours : testing::Test {
  HostileNeighbours() {
    if (geteuid() != 0) return;
    for (const std::string& folder : folders())
      neighbours.push_back(start_hostile(folder, environment("ROS_DOMAIN_ID"), 50));
  }
  ~HostileNeighbours() override {
    for (const pid_t each : neighbours) {
      kill(each, SIGKILL);
      waitpid(each, nullptr, 0);
    }
    std::error_code error;
    for (const std::string& folder : folders()) std::filesystem::remove_all(folder, error);
  }
  static std::vector<std::string> folders() {
    return {"/tmp/culprit-" + std::to_string(kStranger),
            "/tmp/culprit-guest-" + std::to_string(getpid())};
  }

  struct Ended {
    int code = 0;
    std::string said;
    Duration took{};
  };
  Ended ended(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "culprit");
    const Time begin = live_now();
    TestProgram program(world, std::move(arguments));
    const int code = program.wait().value_or(-1);
    return {code, program.output(), live_now() - begin};
  }

  OwnFolders own;  // before what is made in them
  TestWorld world;
  std::vector<pid_t> neighbours;
};

TEST_F(HostileNeighbours, DoNotDelayOrFalsifyAPause) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become somebody else";
  if (!own.are_own()) GTEST_SKIP() << "other tests' culprits would be found, too";
  // They are there before the real one is, and alone.
  const Ended nobody = ended({"pause"});
  EXPECT_EQ(nobody.code, 1);
  EXPECT_THAT(nobody.said, HasSubstr("no culprit on this machine answers"));
  EXPECT_THAT(nobody.said, HasSubstr("Nothing was ordered"));

  TestProgram run(world, {"culprit", "run", world.write("yard.rules", kLocalRules), "--state-dir",
                          (world.folder() / "state").string()});
  ASSERT_TRUE(run.prints("culprit status")) << run.output();
  constexpr int kRounds = 20;
  Duration longest{};
  for (int i = 0; i < kRounds; ++i) {
    const Ended paused = ended({"pause", "--reason", "people on the floor"});
    EXPECT_EQ(paused.code, 0) << paused.said;
    EXPECT_THAT(paused.said, HasSubstr("culprit of yard (process " + std::to_string(run.pid())));
    EXPECT_THAT(paused.said, HasSubstr("it also holds after a restart"));
    EXPECT_THAT(paused.said, Not(HasSubstr("process 1,"))) << "what lies is not believed";
    longest = std::max(longest, paused.took);
    const Ended resumed = ended({"resume"});
    EXPECT_EQ(resumed.code, 0) << resumed.said;
    longest = std::max(longest, resumed.took);
  }
  RecordProperty("longest_ms", static_cast<int>(seconds(longest) * 1000));
  EXPECT_LT(longest, Duration(std::chrono::seconds(10)))
      << "one silent socket alone cost 5 s, and they are 50";

  // To all, as root may say: the real one receives it at once, and the others do not delay it.
  const Ended all = ended({"pause", "--all"});
  EXPECT_EQ(all.code, 1) << "some did not answer";
  EXPECT_THAT(all.said, HasSubstr("culprit of yard (process " + std::to_string(run.pid())));
  EXPECT_THAT(all.said, HasSubstr("it also holds after a restart"));
  EXPECT_LT(all.took, Duration(std::chrono::seconds(20)));
  EXPECT_THAT(ended({"status"}).said, HasSubstr("[paused]"));
}

// As in all ROS tools, the environment says which robot is meant.
TEST_F(HostileNeighbours, AndAnotherDomainIsOrderedOnlyByItsNumber) {
  TestProgram run(world, {"culprit", "run", world.write("yard.rules", kLocalRules), "--state-dir",
                          (world.folder() / "state").string()});
  ASSERT_TRUE(run.prints("culprit status")) << run.output();
  const std::string domain = environment("ROS_DOMAIN_ID");
  setenv("ROS_DOMAIN_ID", "231", 1);
  const Ended other = ended({"pause"});
  EXPECT_EQ(other.code, 1);
  EXPECT_THAT(other.said, HasSubstr("a culprit on domain " + domain +
                                    " was not asked: culprit status "
                                    "--domain " +
                                    domain));
  EXPECT_EQ(ended({"pause", "--domain", domain}).code, 0);
  setenv("ROS_DOMAIN_ID", "many", 1);
  EXPECT_EQ(ended({"pause"}).code, 2);
  setenv("ROS_DOMAIN_ID", domain.c_str(), 1);
  EXPECT_EQ(ended({"resume"}).code, 0);
}

}  // namespace
}  // namespace culprit::cli
