#include "owners/launch_file.h"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <sys/wait.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "owners/start_needs.h"

namespace culprit::owners {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(LaunchFile, IsTheFirstWordWithTheNodeBehindIt) {
  const auto what = launch_file_node({"my_robot/robot.launch.py#front/driver", "fps:=30"});
  ASSERT_TRUE(what);
  EXPECT_EQ(what->file, "my_robot/robot.launch.py");
  EXPECT_EQ(what->node, "front/driver");
  EXPECT_FALSE(launch_file_node({"/opt/driver", "robot.launch.py#x"}));
  EXPECT_FALSE(launch_file_node({"/opt/driver#1"}));
  EXPECT_FALSE(launch_file_node({"robot.launch.py"}));
}

TEST(LaunchFile, OfAPackageIsNeededInOneOfItsFolders) {
  const auto needs = start_needs({"cam/robot.launch.py#driver"}, "/ws:/opt");
  ASSERT_EQ(needs.size(), 1u);
  EXPECT_THAT(
      needs[0].places,
      ElementsAre("/ws/share/cam/launch/robot.launch.py", "/ws/share/cam/robot.launch.py",
                  "/opt/share/cam/launch/robot.launch.py", "/opt/share/cam/robot.launch.py"));
  EXPECT_EQ(needs[0].missing, "there is no launch file 'cam/robot.launch.py'");
  EXPECT_THAT(start_needs({"cam/robot.launch.py#driver"}, ""), IsEmpty());
  EXPECT_THAT(start_needs({"/a/robot.launch.py#driver"}, "")[0].places,
              ElementsAre("/a/robot.launch.py"));
}

// The part of the package `launch` that the script uses. A launch file is a function `actions` here.
constexpr const char* kLaunch = R"(
class Described:
    def __init__(self, command, env): self.command, self.env = command, env
    def prepare(self):
        import os
        self.final_cmd, self.final_cwd = self.command, None
        self.final_env = {**os.environ, **self.env}

class ExecuteLocal:
    shell = False
    def __init__(self, name, command, **env):
        self.node_name, self.process_description = name, Described(command, env)
    def prepare(self, context): self.process_description.prepare()
    def execute(self, context): raise AssertionError('nothing is started')

class IncludeLaunchDescription:
    def __init__(self, source, launch_arguments): self.source, self.arguments = source, launch_arguments

class LaunchDescription:
    def __init__(self, entities): self.entities = entities

class LaunchService:
    def include_launch_description(self, description): self.included = description.entities[0]
    def run(self):
        names = {}
        exec(open(self.included.source).read(), names)
        for action in names['actions'](dict(self.included.arguments)): action.execute(None)
        return 0
)";

struct Folder {
  Folder() {
    fs::create_directories(path / "python/launch/actions");
    write("python/launch/__init__.py", kLaunch);
    write("python/launch/actions/__init__.py", "from launch import IncludeLaunchDescription\n");
    write("python/launch/actions/execute_local.py", "from launch import ExecuteLocal\n");
    write("python/launch/launch_description_sources.py", "AnyLaunchDescriptionSource = str\n");
    fs::create_directories(path / "ws/share/cam/launch");
    rate("1");
  }
  ~Folder() { fs::remove_all(path); }
  // The launch file as a person edits it.
  void rate(const std::string& rate) const {
    write("ws/share/cam/launch/robot.launch.py",
          R"(
from launch import ExecuteLocal
def actions(arguments):
    yield ExecuteLocal('/lidar', ['sh', '-c', 'echo lidar'])
    yield ExecuteLocal('<node_namespace_unspecified>/driver',
                       ['sh', '-c', 'echo $$ driver $NAME )" +
              rate + R"( ' + arguments.get('fps', '')], NAME='front')
)");
  }
  void write(const std::string& file, const std::string& text) const {
    std::ofstream(path / file) << text;
  }
  struct Ended {
    int pid;
    int status;
    std::string said;
  };
  // Starts it as the supervisor does, and waits for its end.
  Ended run(const std::string& node, const std::vector<std::string>& arguments = {}) const {
    std::vector<std::string> launch = {"cam/robot.launch.py#" + node};
    launch.insert(launch.end(), arguments.begin(), arguments.end());
    fs::remove(path / "log");
    Program program{program_of_launch(launch, (path / "ws").native()), {}, path / "log"};
    program.environment = {"PYTHONPATH=" + (path / "python").native()};
    const auto pid = spawn(program);
    if (!pid) return {0, -1, pid.error()};
    int status = 0;
    waitpid(*pid, &status, 0);
    std::stringstream text;
    text << std::ifstream(path / "log").rdbuf();
    return {*pid, status, text.str()};
  }

  const fs::path path = fs::temp_directory_path() / ("launch_file_" + std::to_string(getpid()));
};

TEST(LaunchFile, IsEvaluatedAtEachStartAndItsProcessBecomesTheNode) {
  const Folder folder;
  const auto first = folder.run("driver", {"fps:=30"});
  EXPECT_EQ(first.status, 0);
  EXPECT_EQ(first.said, std::to_string(first.pid) + " driver front 1 30\n");
  folder.rate("2");
  EXPECT_THAT(folder.run("/driver").said, HasSubstr("driver front 2"));
}

TEST(LaunchFile, ThatHasNoSuchNodeSaysWhichItHas) {
  const Folder folder;
  const auto ended = folder.run("drver");
  EXPECT_NE(ended.status, 0);
  EXPECT_THAT(ended.said, HasSubstr("starts no node drver; it starts: /lidar, /driver"));
}

}  // namespace
}  // namespace culprit::owners
