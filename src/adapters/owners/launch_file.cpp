#include "owners/launch_file.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <sstream>
#include <string_view>

namespace culprit::owners {
namespace {

namespace fs = std::filesystem;

// Arguments: the file, the node, and the arguments of the launch file. Actions are visited as `ros2
// launch` does, so conditions and substitutions count; but a process is only looked at, and the one
// that is meant takes the place of this one. Composable nodes are loaded by nobody here. Lifecycle
// nodes would open a node of launch_ros.
constexpr const char* kBecome = R"(
import os, sys
from unittest.mock import MagicMock
from launch import LaunchDescription, LaunchService
from launch.actions import IncludeLaunchDescription
from launch.actions.execute_local import ExecuteLocal
from launch.launch_description_sources import AnyLaunchDescriptionSource

file, wanted, *arguments = sys.argv[1:]
names = []

def become(action, context):
    action.prepare(context)
    what = action.process_description
    command = what.final_cmd
    name = getattr(action, 'node_name', '').replace('<node_namespace_unspecified>', '')
    if not name or '<node_name_unspecified>' in name:
        name = '/' + os.path.basename(command[0])
    names.append(name)
    if name != '/' + wanted.lstrip('/'):
        return
    if action.shell:
        command = ['sh', '-c', ' '.join(command)]
    os.chdir(what.final_cwd or '.')
    os.execvpe(command[0], command, what.final_env)

ExecuteLocal.execute = become
try:
    from launch_ros.actions import LoadComposableNodes, lifecycle_node
    LoadComposableNodes.execute = lambda action, context: None
    lifecycle_node.get_ros_node = lambda context: MagicMock()
except ImportError:
    pass
service = LaunchService()
service.include_launch_description(LaunchDescription([IncludeLaunchDescription(
    AnyLaunchDescriptionSource(file),
    launch_arguments=[argument.split(':=', 1) for argument in arguments])]))
failed = service.run()
sys.exit(failed or f'{file} starts no node {wanted}; it starts: {", ".join(names)}')
)";

// As ros2 launch finds it, in the folders where packages install launch files.
std::vector<std::string> places_of(const std::string& file, const std::string& prefixes) {
  if (file.starts_with('/')) return {file};
  std::vector<std::string> places;
  const auto slash = file.find('/');
  const std::string package = file.substr(0, slash);
  const std::string name = file.substr(slash + 1);
  std::istringstream list(prefixes);
  for (std::string prefix; std::getline(list, prefix, ':');) {
    for (const char* folder : {"/launch/", "/"})
      places.push_back(prefix + "/share/" + package + folder + name);
  }
  return places;
}

}  // namespace

std::optional<LaunchFileNode> launch_file_node(const std::vector<std::string>& launch) {
  constexpr std::array<std::string_view, 4> kEndings = {".py", ".xml", ".yaml", ".yml"};
  if (launch.empty()) return std::nullopt;
  const auto mark = launch[0].find('#');
  if (mark == std::string::npos || mark + 1 == launch[0].size()) return std::nullopt;
  LaunchFileNode what{launch[0].substr(0, mark), launch[0].substr(mark + 1)};
  const bool is_file = what.file.find('/') != std::string::npos &&
                       std::ranges::any_of(kEndings, [&](std::string_view ending) {
                         return what.file.ends_with(ending);
                       });
  return is_file ? std::optional(std::move(what)) : std::nullopt;
}

std::optional<StartNeed> need_of(const LaunchFileNode& what, const std::string& prefixes) {
  std::vector<std::string> places = places_of(what.file, prefixes);
  if (places.empty()) return std::nullopt;
  return StartNeed{std::move(places), "there is no launch file '" + what.file + "'"};
}

std::vector<std::string> program_of_launch(const std::vector<std::string>& launch,
                                           const std::string& prefixes) {
  const auto what = launch_file_node(launch);
  if (!what) return launch;
  const std::vector<std::string> places = places_of(what->file, prefixes);
  const auto place = std::ranges::find_if(places, [](const std::string& each) {
    std::error_code error;
    return fs::exists(each, error);
  });
  std::vector<std::string> program = {"python3", "-c", kBecome,
                                      place != places.end() ? *place : what->file, what->node};
  program.insert(program.end(), launch.begin() + 1, launch.end());
  return program;
}

}  // namespace culprit::owners
