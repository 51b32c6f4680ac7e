#include "owners/launch_file.h"

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <sys/wait.h>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "owners/proc.h"
#include "owners/start_needs.h"

namespace culprit::owners {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
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

// The parts of `launch_ros` and `ros2launch` that are used to find out what is loaded into containers. A node of a launch
// would be made by get_ros_node.
void write_launch_of_composed_nodes(const Folder& folder) {
  fs::create_directories(folder.path / "python/launch_ros/actions");
  fs::create_directories(folder.path / "python/ros2launch");
  folder.write("python/launch_ros/actions/lifecycle_node.py", "get_ros_node = None\n");
  folder.write("python/launch_ros/actions/load_composable_nodes.py", R"(
def get_ros_node(context): raise AssertionError('nothing is loaded')
class LoadComposableNodes:
    def __init__(self, container, *requests): self.container, self.requests = container, requests
    def execute(self, context):
        self.__final_target_container_name = self.container
        get_ros_node(context).create_client()
        self._load_in_sequence(self.requests, context)
)");
  folder.write(
      "python/ros2launch/api.py",
      "import os\ndef get_share_file_path_from_package(package_name, file_name):\n"
      "    return os.path.join(os.environ['WS'], 'share', package_name, 'launch', file_name)\n");
  folder.write("ws/share/cam/launch/robot.launch.py", R"(
from types import SimpleNamespace as Is
from launch import ExecuteLocal
from launch_ros.actions.load_composable_nodes import LoadComposableNodes
def actions(arguments):
    yield ExecuteLocal('/box', ['component_container'])
    yield LoadComposableNodes('/box', Is(
        package_name='cam', plugin_name='cam::Camera', node_name='camera', node_namespace='/front',
        remap_rules=['image:=rgb'], parameters=[
            Is(name='fps', value=Is(type=2, integer_value=int(arguments['fps']))),
            Is(name='frame', value=Is(type=4, string_value='7'))]))
)");
  folder.write("ros2", "import time\ntime.sleep(60)\n");
}

TEST(LaunchFile, OfARunningLaunchShowsHowComponentsWereLoaded) {
  const Folder folder;
  write_launch_of_composed_nodes(folder);
  Program program{{"python3", (folder.path / "ros2").native(), "launch", "-d", "cam",
                   "robot.launch.py", "fps:=30"},
                  {},
                  folder.path / "log"};
  program.environment = {"PYTHONPATH=" + (folder.path / "python").native(),
                         "WS=" + (folder.path / "ws").native()};
  const auto pid = spawn(program);
  ASSERT_TRUE(pid) << pid.error();
  // `python3` may be a script that finds the right one first.
  const auto is_launch = [&] {
    const auto what = identity_of(*pid);
    return what && what->script == folder.path / "ros2" &&
           what->program.find("python") != std::string::npos;
  };
  for (int i = 0; i < 1000 && !is_launch(); ++i) std::this_thread::sleep_for(20ms);
  const auto text = composed_nodes_of_launch(*pid, 20s);
  kill(*pid, SIGKILL);
  waitpid(*pid, nullptr, 0);
  ASSERT_TRUE(text) << text.error();
  EXPECT_EQ(*text,
            R"({"load_node": [{"target_container_name": "/box", "package": "cam", )"
            R"("plugin": "cam::Camera", "node_name": "camera", "namespace": "/front", )"
            R"("remaps": [["image", "rgb"]], "params": [["fps", 30], ["frame", "7", "text"]]}]})"
            "\n");
}

TEST(LaunchFile, IsNotSoughtInAnotherProcess) {
  const auto text = composed_nodes_of_launch(getpid(), 20s);
  ASSERT_FALSE(text);
  EXPECT_THAT(text.error(), HasSubstr("is no ros2 launch"));
}

TEST(LaunchFile, ThatHasNoSuchNodeSaysWhichItHas) {
  const Folder folder;
  const auto ended = folder.run("drver");
  EXPECT_NE(ended.status, 0);
  EXPECT_THAT(ended.said, HasSubstr("starts no node drver; it starts: /lidar, /driver"));
}

}  // namespace
}  // namespace culprit::owners
