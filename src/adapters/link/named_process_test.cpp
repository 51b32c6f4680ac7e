#include "link/named_process.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "base/test_folder.h"

namespace culprit::link {
namespace {

using Words = std::vector<std::string>;

TEST(NamedProcess, KnowsNodesByTheirRemapping) {
  EXPECT_TRUE(names_node({"camera", "--ros-args", "-r", "__node:=front"}, "/front"));
  EXPECT_TRUE(names_node({"c", "--ros-args", "-r", "__node:=a", "-r", "__ns:=/b/c"}, "/b/c/a"));
  EXPECT_TRUE(names_node({"c", "--ros-args", "-r", "lens:__node:=a"}, "/a"));
  EXPECT_FALSE(names_node({"c", "--ros-args", "-r", "__node:=a", "-r", "__ns:=/b"}, "/a"));
  EXPECT_FALSE(names_node({"c", "--ros-args", "-r", "__node:=a"}, "/b/a"));
  EXPECT_FALSE(names_node({"c", "x__node:=a"}, "/a"));
  EXPECT_FALSE(names_node({"a"}, "/a"));
}

TEST(NamedProcess, KnowsWhatALaunchStarts) {
  EXPECT_TRUE(is_launched_as({"/opt/driver", "-v"}, {"/opt/driver", "-v"}));
  EXPECT_TRUE(is_launched_as({"/usr/bin/python3", "/opt/node.py", "a"}, {"/opt/node.py", "a"}));
  EXPECT_TRUE(is_launched_as({"python3", "node.py", "a"}, {"/usr/bin/python3", "node.py", "a"}));
  EXPECT_TRUE(
      is_launched_as({"/ros/lib/demo/talker", "-x"}, {"ros2", "run", "demo", "talker", "-x"}));
  EXPECT_TRUE(
      is_launched_as({"python3", "/ros/lib/demo/talker"}, {"ros2", "run", "demo", "talker"}));
  EXPECT_FALSE(
      is_launched_as({"/ros/lib/demo/talker", "-y"}, {"ros2", "run", "demo", "talker", "-x"}));
  EXPECT_FALSE(is_launched_as({"/ros/lib/other/talker"}, {"ros2", "run", "demo", "talker"}));
  EXPECT_FALSE(is_launched_as({"python3", "node.py", "b"}, {"python3", "node.py", "a"}));
  EXPECT_FALSE(is_launched_as({}, {"a"}));
  EXPECT_FALSE(is_launched_as({"a"}, {}));
}

TEST(NamedProcess, KnowsWhatALaunchFileStarts) {
  const Words launch = {"bot/robot.launch.py#lidar", "x:=1"};
  const Words starter = {"python3", "/ros/bin/ros2", "launch", "bot", "robot.launch.py"};
  EXPECT_TRUE(is_of_launch_file({"python3", "node.py", "lidar"}, starter, launch, "/lidar"));
  EXPECT_FALSE(is_of_launch_file({"python3", "node.py", "filter"}, starter, launch, "/lidar"));
  EXPECT_FALSE(is_of_launch_file({"python3", "node.py", "lidar"}, {"bash"}, launch, "/lidar"));
  EXPECT_FALSE(is_of_launch_file({"lidar"}, starter, {"lidar"}, "/lidar"));
}

// A /proc of these processes.
class Processes {
 public:
  void add(int pid, const Words& words,
           const std::string& library = "/opt/librmw_fastrtps_cpp.so") {
    const auto folder = proc / std::to_string(pid);
    std::filesystem::create_directories(folder);
    std::ofstream line(folder / "cmdline", std::ios::binary);
    for (const std::string& word : words) line << word << '\0';
    std::ofstream(folder / "maps") << "7f00-7f01 r-xp 0 00:00 1 " << library << "\n";
  }
  ros2::FoundProcess find(int announced = 0) const {
    ros2::ParticipantInfo participant;
    participant.pid = announced;
    return NamedProcess(proc.path()).find(participant, {{"/lidar", {"lidar", "-v"}, "0/r/lidar"}});
  }
  test::TestFolder proc;
};

TEST(NamedProcess, ProvesTheOneThatFits) {
  Processes all;
  all.add(300, {"/opt/lidar", "-v"});
  all.add(301, {"/bin/sh", "/opt/other"});
  all.add(302, {"python3", "/opt/lidar", "-v"}, "/lib/libc.so");  // no node: it has no middleware
  EXPECT_EQ(all.find().pid, 300);
  EXPECT_EQ(all.find(300).pid, 300);
}

TEST(NamedProcess, KnowsAProgramByItsFile) {
  Processes all;
  all.add(300, {"l", "-v"});
  std::filesystem::create_symlink("/opt/lidar", all.proc / "300/exe");
  EXPECT_EQ(all.find().pid, 300);
}

TEST(NamedProcess, KnowsWhatCulpritStarted) {
  Processes all;
  all.add(300, {"python3", "node.py"});
  all.add(301, {"python3", "node.py"});
  std::ofstream(all.proc / "301/environ") << "A=b" << '\0' << "CULPRIT_COMPONENT=0/r/lidar" << '\0';
  EXPECT_EQ(all.find().pid, 301);
}

TEST(NamedProcess, BelievesNoProcessIdAlone) {
  Processes all;
  all.add(300, {"/opt/lidar", "-v"});
  all.add(301, {"/opt/planner"});
  EXPECT_EQ(all.find(301).pid, 0);
  EXPECT_NE(all.find(301).missing, "");
}

TEST(NamedProcess, TwoThatFitAreNoProofUnlessOneIsAnnounced) {
  Processes all;
  all.add(300, {"/opt/lidar", "-v"});
  all.add(301, {"/opt/lidar", "-v"});
  EXPECT_EQ(all.find().pid, 0);
  EXPECT_NE(all.find().missing, "");
  EXPECT_EQ(all.find(301).pid, 301);
}

// Another user can give a process the camera's command line and environment.
TEST(NamedProcess, BelievesNoProcessOfAnotherUser) {
  Processes all;
  all.add(300, {"/opt/lidar", "-v"});
  const NamedProcess::Sought sought{"/lidar", {"lidar", "-v"}, "0/r/lidar"};
  EXPECT_EQ(NamedProcess(all.proc.path(), geteuid()).find({}, {sought}).pid, 300);
  const ros2::FoundProcess found = NamedProcess(all.proc.path(), geteuid() + 1).find({}, {sought});
  EXPECT_EQ(found.pid, 0);
  EXPECT_NE(found.missing, "");
}

TEST(NamedProcess, KnowsProcessesByTheSixteenBitsThatAreAnnounced) {
  Processes all;
  all.add(70'000, {"/opt/lidar", "-v"});
  EXPECT_EQ(all.find(70'000 & 0xffff).pid, 70'000);
}

}  // namespace
}  // namespace culprit::link
