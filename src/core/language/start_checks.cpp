#include "language/start_checks.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

#include "base/closest.h"
#include "base/ros_names.h"
#include "language/symbols.h"

namespace culprit {
namespace {

using Words = std::vector<std::string>;

struct CommandFlaw {
  Severity severity = Severity::kError;  // the command cannot start anything
  std::string cause;
  std::string remedy;
};

constexpr std::array<std::string_view, 22> kCommandsOfRos2 = {
    "action",     "bag",       "component", "control",   "daemon",    "doctor", "extension_points",
    "extensions", "interface", "launch",    "lifecycle", "multicast", "node",   "param",
    "pkg",        "plugin",    "run",       "security",  "service",   "topic",  "trace",
    "wtf"};

bool is_launch_file(std::string_view word) {
  return word.ends_with(".launch.py") || word.ends_with(".launch.xml") ||
         word.ends_with(".launch.yaml") || word.ends_with(".launch.yml");
}

// The words behind "ros2 run" that are no options and no arguments of the program; nothing if an option
// is unknown here.
std::optional<Words> plain_words(const Words& command) {
  Words plain;
  for (std::size_t i = 2; i < command.size(); ++i) {
    const std::string& word = command[i];
    if (word == "--ros-args" || word == "--") break;
    if (word.starts_with("--prefix=")) continue;
    if (word == "--prefix") {
      ++i;
    } else if (word.starts_with('-')) {
      if (plain.size() >= 2) break;  // it is the program's
      return std::nullopt;
    } else if (word.find(":=") == std::string::npos) {
      plain.push_back(word);
    }
  }
  return plain;
}

std::optional<CommandFlaw> flaw_of_ros2(const Words& command) {
  if (command.size() < 2)
    return CommandFlaw{.cause = "ros2 by itself starts no node",
                       .remedy = "write LAUNCH \"ros2 run package program\""};
  const std::string& verb = command[1];
  const std::string near = closest(verb, {"run", "launch"});
  if (std::ranges::find(kCommandsOfRos2, verb) == kCommandsOfRos2.end() && !near.empty())
    return CommandFlaw{Severity::kWarning, "ros2 has no command '" + verb + "'",
                       "did you mean '" + near + "'?"};
  if (verb != "run" && verb != "launch") return std::nullopt;
  const auto plain = plain_words(command);
  if (!plain || plain->size() >= 2) return std::nullopt;
  if (plain->empty())
    return CommandFlaw{.cause = "this command names no package",
                       .remedy = "write LAUNCH \"ros2 run package program\""};
  const std::string& package = plain->front();
  if (verb == "run")
    return CommandFlaw{
        .cause = "this command names the package '" + package + "', and no program of it",
        .remedy = "write the program behind it, as ros2 pkg executables " + package + " lists it"};
  const bool is_file = is_launch_file(package) || package.find('/') != std::string::npos ||
                       package.find('.') != std::string::npos;
  if (is_file) return std::nullopt;
  return CommandFlaw{
      .cause = "this command names the package '" + package + "', and no launch file of it",
      .remedy =
          "for one node of a launch file write LAUNCH \"" + package + "/robot.launch.py#node\""};
}

bool sets_name_or_parameter(std::string_view word) {
  const auto sign = word.find(":=");
  return sign != std::string_view::npos && sign > 0;
}

// Nodes stop at the start with ROS arguments that have no flag, and ignore flags outside of --ros-args.
std::optional<CommandFlaw> flaw_of_ros_arguments(const Words& command) {
  const bool is_run = command.size() > 2 && command[1] == "run";
  bool is_inside = false;
  for (std::size_t i = 1; i < command.size(); ++i) {
    const std::string& word = command[i];
    if (word == "--ros-args" || word == "--") {
      is_inside = word == "--ros-args";
      continue;
    }
    const std::string& before = command[i - 1];
    const bool is_first = before == "--ros-args";
    if (is_inside && sets_name_or_parameter(word) && !word.starts_with('-') &&
        (is_first || !before.starts_with('-')))
      return CommandFlaw{
          .cause = "the node refuses '" + word + "': no flag stands in front of it",
          .remedy = word.starts_with("__")
                        ? "write -r " + word
                        : "write -p " + word + " for a parameter, -r " + word + " for a name"};
    const bool is_set = before == "-p" || before == "--param";
    const bool is_mapped = before == "-r" || before == "--remap";
    if (const auto equals = word.find('='); is_inside && (is_set || is_mapped) &&
                                            equals != std::string::npos &&
                                            !sets_name_or_parameter(word))
      return CommandFlaw{.cause = "the node refuses '" + word + "': its '=' lacks a ':'",
                         .remedy = "write " + before + " " + word.substr(0, equals) +
                                   ":=" + word.substr(equals + 1)};
    const bool is_flag = word == "-p" || word == "--param" || word == "--params-file";
    if (is_run && !is_inside && is_flag && i > 3 && i + 1 < command.size() &&
        (word == "--params-file" || sets_name_or_parameter(command[i + 1])))
      return CommandFlaw{Severity::kWarning,
                         "the node ignores '" + word + "': --ros-args is missing in front of it",
                         "write --ros-args " + word + " " + command[i + 1]};
  }
  return std::nullopt;
}

// "systemctl --user restart camera": the unit as UNIT names it.
std::string unit_in(const Words& command) {
  const bool is_users = std::ranges::find(command, "--user") != command.end();
  const std::string& last = command.back();
  return last + (last.find('.') == std::string::npos ? ".service" : "") + (is_users ? " USER" : "");
}

// A program that another one runs: culprit would watch the wrong process.
std::optional<CommandFlaw> flaw_of_program(const Words& command) {
  const bool has_sudo = command.front() == "sudo" && command.size() > 1;
  const std::string& program = command[has_sudo ? 1 : 0];
  if (program == "systemctl")
    return CommandFlaw{Severity::kWarning,
                       "'systemctl' ends at once, so culprit would watch no process",
                       "write UNIT " + unit_in(command) + " in place of LAUNCH"};
  if (program == "docker" || program == "podman")
    return CommandFlaw{
        Severity::kWarning, "'" + program + "' runs the process elsewhere: in a container",
        "write CONTAINER " + program + " and the container's name in place of LAUNCH"};
  if (!has_sudo) return std::nullopt;
  return CommandFlaw{Severity::kWarning, "'sudo' may ask for a password, which nobody can enter",
                     "leave it out, or let systemd run the program: UNIT name.service"};
}

std::optional<CommandFlaw> flaw_of(const Words& command) {
  if (auto flaw = flaw_of_program(command)) return flaw;
  const std::string& program = command.front();
  if (is_launch_file(program) && program.find('#') == std::string::npos)
    return CommandFlaw{Severity::kWarning, "a launch file is no program",
                       "name the node of it to start: LAUNCH \"" + program + "#node\""};
  const bool is_ros2 = std::string_view(program).substr(program.rfind('/') + 1) == "ros2";
  if (is_ros2) {
    if (auto flaw = flaw_of_ros2(command)) return flaw;
  }
  return flaw_of_ros_arguments(command);
}

}  // namespace

void check_command(const syntax::Component& written, const Component& component,
                   std::vector<Diagnostic>& diagnostics) {
  if (!written.launch || component.launch.empty()) return;
  auto flaw = flaw_of(component.launch);
  if (!flaw) return;
  diagnostics.push_back({Code::kBadCommand, flaw->severity, written.launch->span,
                         std::move(flaw->cause), std::move(flaw->remedy)});
}

void check_containers(const syntax::File& file, const RuleSet& rules,
                      std::vector<Diagnostic>& diagnostics) {
  // A file that needs more has thousands of unknown containers, which are no slips.
  std::size_t comparisons_left = Symbols::kMaxComparisons;
  std::vector<std::string_view> nodes;
  std::unordered_map<std::string_view, const Component*> by_node;  // the first
  std::unordered_set<std::string_view> without_node;               // names
  for (const Component& component : rules.components) {
    if (!component.node.empty() && !component.composed) nodes.push_back(component.node);
    if (component.declared && component.node.empty()) without_node.insert(component.name);
    by_node.emplace(component.node, &component);
    for (const std::string& other : component.other_nodes) by_node.emplace(other, &component);
  }
  // Declared components come first, in the order of the file.
  for (std::size_t i = 0; i < file.components.size(); ++i) {
    const syntax::Component& written = file.components[i];
    if (!written.container || !rules.components[i].composed) continue;
    const std::string& container = written.container->text;
    const auto other = by_node.find(container);
    if (other == by_node.end() && without_node.contains(own_name(container))) {
      const std::string name = own_name(container);
      diagnostics.push_back(
          {Code::kNoContainer, Severity::kWarning, written.container->span,
           "component '" + name + "' has no NODE, so culprit cannot know that it is this container",
           "write NODE " + container + " on the line of COMPONENT " + name});
    } else if (other == by_node.end()) {
      const bool is_compared = nodes.size() <= comparisons_left;
      if (is_compared) comparisons_left -= nodes.size();
      const std::string near = is_compared ? closest_full_name(container, nodes) : "";
      diagnostics.push_back(
          {Code::kNoContainer, Severity::kWarning, written.container->span,
           "no component has the node '" + container + "', so culprit cannot start this container",
           near.empty() ? "declare it: COMPONENT container NODE " + container +
                              ", with the LAUNCH or UNIT that starts it"
                        : "did you mean '" + near + "'?",
           replacement(written.container->span, near)});
    } else if (other->second->composed) {
      diagnostics.push_back(
          {Code::kNoContainer, Severity::kError, written.container->span,
           "component '" + other->second->name + "' is no container: a container loads it itself",
           "name the node of the container, as ros2 component list shows it"});
    }
  }
}

void check_topics_as_nodes(const syntax::File& file, std::vector<Diagnostic>& diagnostics) {
  constexpr std::array<std::string_view, 10> kTopics = {
      "/scan",   "/cmd_vel",     "/tf",           "/tf_static",        "/clock",
      "/rosout", "/diagnostics", "/joint_states", "/parameter_events", "/robot_description"};
  for (const syntax::Component& component : file.components) {
    if (!component.node || std::ranges::find(kTopics, component.node->text) == kTopics.end())
      continue;
    diagnostics.push_back(
        {Code::kUnknownName, Severity::kWarning, component.node->span,
         "'" + component.node->text + "' is the name of a topic, and NODE names a node",
         "write the node's full name, as ros2 node list shows it"});
  }
}

}  // namespace culprit
