// A running culprit, asked and told from another terminal, as people do it.
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/environment.h"
#include "terminal/local_service.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kHandsRules =
    "ROBOT two_cameras\n" + replaced_when_gone("camera") + replaced_when_gone("depth", "WARNING");

struct Hands : testing::Test {
  struct Ended {
    int code = 0;
    std::string said;
  };
  // Asks the culprits of this test's domain.
  Ended ended(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "culprit");
    arguments.insert(arguments.end(), {"--domain", environment("ROS_DOMAIN_ID")});
    TestProgram program(world, std::move(arguments));
    const int code = program.wait().value_or(-1);
    return {code, program.output()};
  }
  // A component for a time and a rule until it is lifted, once they are muted.
  void lists_what_is_muted() const {
    EXPECT_EQ(ended({"mute", "CameraGone", "--reason", "new lens"}).code, 0);
    const Ended list = ended({"mute", "list"});
    EXPECT_EQ(list.code, 0);
    EXPECT_THAT(list.said, HasSubstr("these are muted"));
    EXPECT_THAT(list.said, HasSubstr("component depth, for another "));
    EXPECT_THAT(list.said, HasSubstr("rule CameraGone, by "));
    EXPECT_THAT(list.said, HasSubstr(": new lens"));
    const Ended json = ended({"mute", "list", "--json"});
    EXPECT_THAT(json.said, HasSubstr(R"("component":"depth")"));
    EXPECT_THAT(json.said, HasSubstr(R"("rule":"CameraGone")"));
    EXPECT_THAT(json.said, HasSubstr(R"("left_s":59)")) << "of ten minutes";
    EXPECT_EQ(ended({"silence", "CameraGone", "--lift"}).code, 0) << "its former name";
    EXPECT_THAT(ended({"mute", "list"}).said, Not(HasSubstr("CameraGone")));
  }
  // Until it says so; the last that was said.
  std::string status_says(const std::string& text) const {
    std::string said;
    for (int i = 0; i < 100 && said.find(text) == std::string::npos; ++i)
      said = ended({"status"}).said;
    return said;
  }
  std::unique_ptr<TestProgram> run(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"culprit", "run", world.write("two.rules", kHandsRules),
                                       "--state-dir", (world.folder() / "state").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return std::make_unique<TestProgram>(world, std::move(arguments));
  }

  TestWorld world;
};

TEST_F(Hands, SeeAndSteerARunningCulprit) {
  const Ended nobody = ended({"pause"});
  EXPECT_EQ(nobody.code, 1);
  EXPECT_THAT(nobody.said, HasSubstr("no culprit on this machine answers"));
  EXPECT_THAT(nobody.said, HasSubstr("Nothing was ordered"));

  TestProgram camera(world, {"sunset-node", "camera"});
  const TestProgram depth(world, {"sunset-node", "depth"});
  auto run_ = run({"--approve"});
  ASSERT_TRUE(run_->prints("culprit status")) << run_->output();
  ASSERT_TRUE(run_->prints("camera is there")) << run_->output();
  ASSERT_TRUE(run_->prints("depth is there")) << run_->output();
  EXPECT_THAT(status_says("all is well"), HasSubstr("two_cameras: all is well"));
  EXPECT_EQ(ended({"status"}).code, 0);

  // A repair that awaits approval is approved by name.
  camera.signal(SIGKILL);
  camera.wait();
  EXPECT_THAT(status_says("culprit approve"),
              HasSubstr("culprit approve CameraGone.camera_redeploy"));
  EXPECT_EQ(ended({"status"}).code, 1) << "somebody is ill";
  EXPECT_THAT(ended({"names", "incidents"}).said, HasSubstr("-")) << "the open one";
  const Ended mistyped = ended({"approve", "CameraGone.camera_redploy"});
  EXPECT_EQ(mistyped.code, 2);
  EXPECT_THAT(mistyped.said, HasSubstr("did you mean 'CameraGone.camera_redeploy'?"));
  EXPECT_EQ(ended({"approve", "camera_redeploy"}).code, 0);
  EXPECT_TRUE(run_->prints("CameraGone resolved by camera_redeploy")) << run_->output();

  // A pause is kept, and holds in the process that follows.
  const Ended paused = ended({"pause", "--reason", "people on the floor"});
  EXPECT_EQ(paused.code, 0) << paused.said;
  EXPECT_THAT(paused.said, HasSubstr("it also holds after a restart"));
  EXPECT_THAT(run_->output(), HasSubstr("people on the floor"));
  const Ended refused = ended({"run-strategy", "depth_redeploy"});
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.said, HasSubstr("paused"));

  // A killed culprit reports no end, and its silence counts for none.
  run_->signal(SIGKILL);
  run_->wait();
  const Ended dead = ended({"resume"});
  EXPECT_EQ(dead.code, 1);
  EXPECT_THAT(dead.said, HasSubstr("has ended without a word"));
  run_ = run();
  ASSERT_TRUE(run_->prints("culprit status")) << run_->output();
  EXPECT_THAT(status_says("[paused]"), HasSubstr("[paused]"));
  const Ended resumed = ended({"resume"});
  EXPECT_EQ(resumed.code, 0) << resumed.said;
  EXPECT_EQ(ended({"mute", "depth", "--for", "10min"}).code, 0);
  EXPECT_THAT(ended({"status"}).said, HasSubstr("Muted: depth until"));
  lists_what_is_muted();
  EXPECT_EQ(ended({"mute", "depth", "--lift"}).code, 0);

  // The names for completion in a shell.
  EXPECT_EQ(ended({"names", "names"}).said, "CameraGone\nDepthGone\ncamera\ndepth\n");
  EXPECT_EQ(ended({"names", "strategies"}).said,
            "CameraGone.camera_redeploy\nDepthGone.depth_redeploy\n");
  EXPECT_EQ(ended({"names", "nodes"}).said,
            "/managed_subsystem/camera\n/managed_subsystem/depth\n");
  EXPECT_EQ(ended({"names", "incidents"}).said, "") << "none is open";
}

TEST_F(Hands, AreToldWhenACulpritThatIsStoppedDoesNotAnswer) {
  const TestProgram camera(world, {"sunset-node", "camera"});
  const auto run_ = run({"--no-journal"});
  ASSERT_TRUE(run_->prints("culprit status")) << run_->output();
  const Ended unkept = ended({"pause"});
  EXPECT_EQ(unkept.code, 1) << "a restart would forget it";
  EXPECT_THAT(unkept.said, HasSubstr("in force, not kept: of --no-journal"));
  run_->signal(SIGSTOP);
  const Ended unheard = ended({"resume"});
  EXPECT_EQ(unheard.code, 1);
  EXPECT_THAT(unheard.said, HasSubstr("is stopped and does nothing: kill -CONT"));
  EXPECT_THAT(unheard.said, HasSubstr("Nothing was ordered"));
  run_->signal(SIGCONT);
  EXPECT_THAT(status_says("[paused]"), HasSubstr("[paused]")) << "and so it is";

  // The terminal's view, on a terminal.
  TestProgram top(
      world, {"script", "-qec",
              (own_folder() / "culprit").string() + " top --domain " + environment("ROS_DOMAIN_ID"),
              "/dev/null"});
  EXPECT_TRUE(top.prints("q ends, p pauses culprit")) << top.output();
  EXPECT_TRUE(top.prints("two_cameras: ") && top.prints("[paused]")) << top.output();
  EXPECT_EQ(ended({"top"}).code, 2) << "there is no terminal";
}

// As after the last logout of a user: the folder of the user's sockets is removed, and made anew at the next login.
TEST_F(Hands, ReachACulpritAfterItsUserLoggedOutAndInAgain) {
  const std::filesystem::path folder = world.folder() / "runtime";
  std::filesystem::create_directory(folder);
  const std::string before = environment("XDG_RUNTIME_DIR");
  setenv("XDG_RUNTIME_DIR", folder.c_str(), 1);
  const auto run_ = run();
  ASSERT_TRUE(run_->prints("culprit status")) << run_->output();
  EXPECT_THAT(status_says("two_cameras"), HasSubstr("two_cameras"));
  std::filesystem::remove_all(folder);
  std::this_thread::sleep_for(2 * LocalService::kLook);
  EXPECT_THAT(ended({"pause"}).said, HasSubstr("no culprit on this machine answers"));
  std::filesystem::create_directory(folder);
  std::this_thread::sleep_for(2 * LocalService::kLook);
  EXPECT_EQ(ended({"pause"}).code, 0);
  if (before.empty()) {
    unsetenv("XDG_RUNTIME_DIR");
  } else {
    setenv("XDG_RUNTIME_DIR", before.c_str(), 1);
  }
}

}  // namespace
}  // namespace culprit::cli
