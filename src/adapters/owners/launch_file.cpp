#include "owners/launch_file.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <sstream>
#include <string_view>
#include <unistd.h>

#include "owners/piped_program.h"
#include "owners/proc.h"
#include "owners/start_of.h"

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

// Arguments: the folder, and those of `ros2 launch`. Actions are visited as above; each request to load a node is printed instead of sent.
constexpr const char* kDescribe = R"(
import json, os, sys
from unittest.mock import MagicMock
from launch import LaunchDescription, LaunchService
from launch.actions import IncludeLaunchDescription
from launch.actions.execute_local import ExecuteLocal
from launch.launch_description_sources import AnyLaunchDescriptionSource
from launch_ros.actions import lifecycle_node, load_composable_nodes

os.chdir(sys.argv[1])
words = [word for word in sys.argv[2:] if not word.startswith('-')]
arguments = [word.split(':=', 1) for word in words if ':=' in word]
file, *more = [word for word in words if ':=' not in word]
if not os.path.isfile(file):
    from ros2launch.api import get_share_file_path_from_package
    file = get_share_file_path_from_package(package_name=file, file_name=more[0])
KINDS = ['', 'bool', 'integer', 'double', 'string', 'byte_array', 'bool_array', 'integer_array', 'double_array', 'string_array']
load_node = []

def parameter(one):
    kind = KINDS[one.value.type]
    value = getattr(one.value, kind + '_value')
    value = list(value) if kind.endswith('array') else value
    return [one.name, value] + (['text'] if kind.startswith('string') else [])

def describe(action, requests, context):
    container = getattr(action, '_LoadComposableNodes__final_target_container_name')
    for one in requests:
        parameters = [parameter(each) for each in one.parameters if each.value.type != 0]
        load_node.append({
            'target_container_name': container, 'package': one.package_name, 'plugin': one.plugin_name,
            'node_name': one.node_name, 'namespace': one.node_namespace or '/',
            'remaps': [rule.split(':=', 1) for rule in one.remap_rules],
            'params': [each for each in parameters if each[1] != []]})

ExecuteLocal.execute = lambda action, context: None
load_composable_nodes.LoadComposableNodes._load_in_sequence = describe
load_composable_nodes.get_ros_node = lifecycle_node.get_ros_node = lambda context: MagicMock()
service = LaunchService()
service.include_launch_description(LaunchDescription([IncludeLaunchDescription(
    AnyLaunchDescriptionSource(file), launch_arguments=arguments)]))
failed = service.run()
print()
print(json.dumps({'load_node': [one for one in load_node if one['node_name']]}))
sys.exit(failed)
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

Expected<std::string> composed_nodes_of_launch(int pid, Duration limit) {
  const auto identity = identity_of(pid);
  const auto started = start_of(pid);
  if (!identity || !started || identity->user != geteuid())
    return Error{"process " + std::to_string(pid) + " is of another user, or not there"};
  const auto& words = started->command;
  const auto verb = std::ranges::find(words, "launch");
  const bool is_launch =
      words.end() - verb > 1 && verb != words.begin() && fs::path(*(verb - 1)).filename() == "ros2";
  if (!is_launch) return Error{"process " + std::to_string(pid) + " is no ros2 launch"};
  std::vector<std::string> program = {words.front(), "-c", kDescribe, started->folder};
  program.insert(program.end(), verb + 1, words.end());
  const auto run = run_piped(std::move(program), started->environment, limit);
  if (!run) return Error{run.error()};
  const std::size_t last = run->out.rfind("\n{\"load_node\"");
  if (run->end != PipedRun::End::kItself || run->status != 0 || last == std::string::npos)
    return Error{"its launch file cannot be evaluated: " + last_line(run->err)};
  return run->out.substr(last + 1);
}

}  // namespace culprit::owners
