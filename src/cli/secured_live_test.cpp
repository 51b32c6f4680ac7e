// culprit on a secured domain, with the permissions that `culprit policy` wrote for its rules.
#include <csignal>
#include <cstdlib>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/environment.h"
#include "ros2/test_keystore.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

// As members of the enclave /robot.
std::vector<std::string> node(const std::string& name) {
  return {"env", "ROS_SECURITY_ENCLAVE_OVERRIDE=/robot", own_folder() / "sunset-node", name};
}

std::string launch_of(const std::string& name) {
  std::string line;
  for (const std::string& word : node(name)) line += (line.empty() ? "" : " ") + word;
  return line;
}

std::string component() {
  return "ROBOT secured\nCOMPONENT camera NODE /managed_subsystem/camera LAUNCH \"" +
         launch_of("camera") + "\"\n";
}

// A parameter is not as it should be, and setting it takes a restart.
constexpr const char* kMistuned = R"(
RULE Mistuned
  POLICIES WARNING
  TRIGGER parameter(camera, image_degradation) != 0.25
    STRATEGY tune 90 10
      ADAPTATION camera restart 3
      ADAPTATION camera set_parameter image_degradation 0.25 2
)";

constexpr const char* kSilent = R"(
RULE CameraSilent
  POLICIES ERROR
  TRIGGER age(/managed_subsystem/rgb_camera) > 1s
    STRATEGY redeploy 90 10
      ADAPTATION camera redeploy 10
)";

class Secured : public testing::Test {
 protected:
  Secured() {
    keys_.add("/robot", ros2::TestKeystore::everything("/robot"));
    setenv("ROS_SECURITY_ENABLE", "true", 1);
    setenv("ROS_SECURITY_STRATEGY", "Enforce", 1);
    setenv("ROS_SECURITY_KEYSTORE", keys_.path().c_str(), 1);
  }
  ~Secured() override {
    for (const char* name : {"ROS_SECURITY_ENABLE", "ROS_SECURITY_STRATEGY",
                             "ROS_SECURITY_KEYSTORE", "ROS_SECURITY_ENCLAVE_OVERRIDE"})
      unsetenv(name);
  }

  TestProgram culprit(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "culprit");
    return TestProgram(world_, std::move(arguments));
  }
  // Makes the keys of an enclave that may do what `culprit policy` says of these rules.
  void add(const std::string& enclave, const std::string& rules) {
    const std::string path = (world_.folder() / "permissions.xml").string();
    auto policy = culprit({"policy", world_.write("allowed.rules", rules), "--format",
                           "permissions", "--enclave", enclave, "--output", path});
    EXPECT_EQ(policy.wait(), 0) << policy.output();
    std::ifstream written(path);
    keys_.add(enclave, std::string(std::istreambuf_iterator<char>(written), {}));
  }
  TestProgram run(const std::string& file) {
    return culprit({"run", file, "--state-dir", (world_.folder() / "state").string()});
  }

  TestWorld world_;
  ros2::TestKeystore keys_;
};

TEST_F(Secured, HealsWithThePermissionsOfItsPolicyAndSaysWhatOthersLack) {
  const std::string file = world_.write("secured.rules", component() + kMistuned + kSilent);
  add("/culprit", component() + kMistuned + kSilent);
  add("/deaf", component() + kMistuned);
  add("/stranger", component());
  const TestProgram sea(world_, node("world"));
  TestProgram camera(world_, node("camera"));
  auto healer = run(file);
  ASSERT_TRUE(healer.prints("Mistuned resolved by tune")) << healer.output();
  camera.signal(SIGKILL);
  ASSERT_EQ(camera.wait(), -SIGKILL);
  ASSERT_TRUE(healer.prints("CameraSilent resolved by redeploy")) << healer.output();
  EXPECT_THAT(healer.output(), Not(HasSubstr("permissions"))) << "nothing is missing";
  healer.signal(SIGINT);
  EXPECT_EQ(healer.wait(), 0);

  setenv("ROS_SECURITY_ENCLAVE_OVERRIDE", "/deaf", 1);
  auto deaf = run(file);
  EXPECT_TRUE(
      deaf.prints("cannot watch /managed_subsystem/rgb_camera: no reader of "
                  "rt/managed_subsystem/rgb_camera can be created; do the permissions of "
                  "the enclave /deaf allow it?"))
      << deaf.output();
  setenv("ROS_SECURITY_ENCLAVE_OVERRIDE", "/stranger", 1);
  auto stranger = run(file);
  EXPECT_EQ(stranger.wait(), 1);
  EXPECT_THAT(stranger.output(),
              HasSubstr("do the permissions of the enclave /stranger allow it?"));
  kill(pid_in(healer.output(), "camera"), SIGKILL);  // culprit leaves the robot running
}

}  // namespace
}  // namespace culprit::cli
