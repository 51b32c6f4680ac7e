#include "init/look.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iterator>
#include <set>
#include <string_view>
#include <thread>

#include "base/environment.h"
#include "base/tool_names.h"
#include "inbox/inbox.h"
#include "init/movement.h"
#include "init/values.h"
#include "owners/found_owner.h"
#include "owners/start_of.h"

namespace culprit::init {
namespace {

using namespace std::chrono_literals;

bool starts_with_any(std::string_view text, std::initializer_list<std::string_view> prefixes) {
  return std::ranges::any_of(prefixes, [&](auto prefix) { return text.starts_with(prefix); });
}

bool is_of_ros_or_dds(std::string_view variable) {
  return starts_with_any(variable, {"ROS_", "RMW_", "AMENT_", "COLCON_", "FASTRTPS_", "FASTDDS_",
                                    "CYCLONEDDS_", "PYTHONPATH=", "LD_LIBRARY_PATH="});
}

// Variables that shells and culprit set for themselves.
bool is_nobodys(std::string_view variable) {
  return starts_with_any(variable, {"PWD=", "OLDPWD=", "SHLVL=", "_=", "TERM=", "CULPRIT_"});
}

// Whether an argument names a file or folder below that one: then the command means something else anywhere else, and a
// service runs in another folder than a person who drafts.
bool depends_on(const std::string& folder, const std::vector<std::string>& command) {
  return std::ranges::any_of(command, [&](const std::string& word) {
    std::error_code error;
    const bool is_relative = !word.empty() && !word.starts_with('/') && !word.starts_with('-');
    return is_relative && std::filesystem::exists(std::filesystem::path(folder) / word, error);
  });
}

// `ros2 launch` makes a folder for each run, "2026-11-30-20-03-11-512345-rover-4711", and names it to its nodes. It is no
// part of their start.
bool is_log_folder_of_one_run(std::string_view variable) {
  constexpr std::string_view kForm = "0000-00-00-00-00-00-";
  if (!variable.starts_with("ROS_LOG_DIR=")) return false;
  while (variable.ends_with('/')) variable.remove_suffix(1);
  std::string_view run = variable.substr(variable.find_last_of("/=") + 1);
  run = run.substr(0, kForm.size());
  return std::ranges::equal(run, kForm, [](unsigned char c, char form) {
    return form == '0' ? std::isdigit(c) != 0 : c == static_cast<unsigned char>(form);
  });
}

Start start_as_written(const owners::Started& started) {
  Start start;
  start.command = started.command;
  if (started.folder != std::filesystem::current_path() ||
      depends_on(started.folder, started.command))
    start.folder = started.folder;
  for (const std::string& variable : started.environment) {
    const std::size_t equals = variable.find('=');
    if (equals == std::string::npos || is_nobodys(variable) || is_log_folder_of_one_run(variable))
      continue;
    const std::string name = variable.substr(0, equals);
    if (environment(name.c_str()) == variable.substr(equals + 1)) continue;
    if (is_of_ros_or_dds(variable))
      start.environment.push_back(variable);
    else
      start.withheld.push_back(name);
  }
  return start;
}

std::map<std::string, Start> starts_of(const LiveInventory& robot) {
  std::map<std::string, Start> starts;
  for (const auto& [name, node] : robot.nodes) {
    if (node.pid == 0 || is_tool_node(name)) continue;
    const auto started = owners::start_of(node.pid);
    if (!started) continue;
    Start& start = starts[name] = start_as_written(*started);
    if (const auto owner = owners::found_owner(node.pid, "")) {
      start.owner = owner->name;
      if (starts_with_any(owner->declare, {"UNIT", "CONTAINER"})) start.declare = owner->declare;
    }
  }
  return starts;
}

LiveInterest all_of(const LiveInventory& robot) {
  LiveInterest interest;
  for (const auto& [name, node] : robot.nodes) {
    if (!is_tool_node(name)) interest.nodes.insert(name);
  }
  for (const auto& [name, topic] : robot.topics) {
    if (is_topic_of_ros(name) || !topic.is_published()) continue;
    interest.fields_of_topics[name] = fields_of_movement(topic.type);
    interest.fields_of_topics[name].merge(fields_of_measurement(topic.type));
  }
  return interest;
}

std::set<std::string> names_of(const LiveInventory& robot) {
  std::set<std::string> names;
  for (const auto& each : robot.nodes) names.insert(each.first);
  return names;
}

}  // namespace

RobotProfile look(link::Survey& survey, std::uint32_t domain, Duration time) {
  constexpr Duration kTurn = 500ms;
  const Time end = later(live_now(), time);
  const Time half = end - time / 2;
  LiveInterest asked;
  std::set<std::string> early;
  while (live_now() < end) {
    if (early.empty() && live_now() >= half) early = names_of(survey.inventory());
    LiveInterest interest = all_of(survey.inventory());
    if (interest != asked) survey.ask_for(asked = std::move(interest));
    std::this_thread::sleep_for(std::min<Duration>(kTurn, end - live_now()));
  }
  RobotProfile seen{.robot = survey.inventory(),
                    .rhythms = survey.rhythms(),
                    .rhythms_of_publishers = survey.rhythms_of_publishers(),
                    .starts = {},
                    .fields = survey.fields(),
                    .statuses = survey.statuses(),
                    .came_late = {},
                    .left = {},
                    .looked = time,
                    .domain = domain};
  seen.starts = starts_of(seen.robot);
  const std::set<std::string> late = names_of(seen.robot);
  std::ranges::set_difference(late, early, std::inserter(seen.came_late, seen.came_late.end()));
  std::ranges::set_difference(early, late, std::inserter(seen.left, seen.left.end()));
  return seen;
}

}  // namespace culprit::init
