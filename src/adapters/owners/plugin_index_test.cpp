#include "owners/plugin_index.h"

#include <csignal>
#include <fstream>
#include <sys/wait.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "owners/spawn.h"

namespace culprit::owners {
namespace {

using testing::HasSubstr;

struct PluginIndex : testing::Test {
  void index(const std::string& prefix, const std::string& package, const std::string& text) {
    const auto folder = own.path() / prefix / "share/ament_index/resource_index/rclcpp_components";
    std::filesystem::create_directories(folder);
    std::ofstream(folder / package) << text;
  }
  void start(const std::string& prefixes) {
    const auto started = spawn({.arguments = {"sleep", "60"},
                                .search_first = {},
                                .log = own.path() / "log",
                                .environment = {"AMENT_PREFIX_PATH=" + prefixes}});
    ASSERT_TRUE(started) << started.error();
    pid = *started;
  }
  void TearDown() override {
    if (pid == 0) return;
    kill(pid, SIGKILL);
    waitpid(pid, nullptr, 0);
  }
  test::TestFolder own;
  int pid = 0;
};

TEST_F(PluginIndex, FindsWhatTheContainersOwnEnvironmentHas) {
  index("over", "vision", "vision::Detector;lib/libvision.so\nvision::Tracker;lib/libvision.so\n");
  index("under", "vision", "vision::Old;lib/libvision.so\n");
  index("under", "drivers", "drivers::Lidar;lib/libdrivers.so\n");
  start((own.path() / "over").string() + ":" + (own.path() / "under").string());
  EXPECT_TRUE(find_plugin(pid, "vision", "vision::Tracker"));
  EXPECT_TRUE(find_plugin(pid, "drivers", "drivers::Lidar"));
  // The container takes the first one that has the package.
  EXPECT_FALSE(find_plugin(pid, "vision", "vision::Old"));
  EXPECT_THAT(find_plugin(pid, "vision", "vision::Detecter").error(),
              HasSubstr("has no component vision::Detecter; did you mean vision::Detector?"));
  EXPECT_THAT(find_plugin(pid, "driver", "drivers::Lidar").error(),
              HasSubstr("did you mean drivers?"));
}

TEST_F(PluginIndex, SaysWhatItCannotSee) {
  EXPECT_THAT(find_plugin(1 << 30, "vision", "vision::Detector").error(),
              HasSubstr("its container could load are unknown"));
}

}  // namespace
}  // namespace culprit::owners
