#include "http/thread_room.h"

#include <fstream>

#include <gtest/gtest.h>

#include "base/test_folder.h"

namespace culprit::http {
namespace {

struct ThreadRoom : testing::Test {
  void limit(const std::string& group, const std::string& most, const std::string& now) {
    std::filesystem::create_directories(folder / group);
    std::ofstream(folder / group / "pids.max") << most << "\n";
    std::ofstream(folder / group / "pids.current") << now << "\n";
  }
  std::optional<std::size_t> left(const std::string& groups) {
    return threads_left(groups, folder.path());
  }
  test::TestFolder folder;
};

TEST_F(ThreadRoom, IsThatOfTheTightestGroup) {
  limit("system.slice", "100", "90");
  limit("system.slice/culprit.service", "40", "10");
  EXPECT_EQ(left("0::/system.slice/culprit.service\n"), 10u);
  limit("system.slice", "max", "90");
  EXPECT_EQ(left("0::/system.slice/culprit.service\n"), 30u);
  limit("system.slice/culprit.service", "40", "41");
  EXPECT_EQ(left("0::/system.slice/culprit.service\n"), 0u) << "it was lowered";
}

TEST_F(ThreadRoom, OfTheFirstVersionIsThatOfItsController) {
  limit("pids/robot", "50", "20");
  limit("memory/robot", "5", "4");
  EXPECT_EQ(left("9:name=systemd:/x\n8:memory:/robot\n7:cpu,pids:/robot\n0::/\n"), 30u);
}

// Where the path is that of the machine, and the mount that of the container.
TEST_F(ThreadRoom, InAContainerIsThatOfTheContainer) {
  limit("", "64", "4");
  EXPECT_EQ(left("0::/docker/0123\n"), 60u);
}

TEST_F(ThreadRoom, IsUnlimitedWhereNothingIsSaid) {
  EXPECT_EQ(left("0::/user.slice\n"), std::nullopt);
  EXPECT_EQ(left("nonsense"), std::nullopt);
  EXPECT_EQ(left(""), std::nullopt);
}

}  // namespace
}  // namespace culprit::http
