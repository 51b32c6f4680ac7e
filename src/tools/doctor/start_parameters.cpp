#include "doctor/start_parameters.h"

#include <filesystem>

#include "base/ros_names.h"
#include "owners/parameter_file.h"

namespace culprit::doctor {
namespace {

// "rate:=10", or of one node of several "camera:rate:=10".
struct Assignment {
  std::string node;  // empty: of all
  std::string name, value;
};
Assignment parse(const std::string& text) {
  const std::size_t assign = text.find(":=");
  if (assign == std::string::npos) return {};
  Assignment parsed{{}, text.substr(0, assign), text.substr(assign + 2)};
  if (const std::size_t colon = parsed.name.rfind(':'); colon != std::string::npos) {
    parsed.node = parsed.name.substr(0, colon);
    parsed.name = parsed.name.substr(colon + 1);
  }
  return parsed;
}

bool is_of(const Assignment& assignment, const std::string& node) {
  return assignment.node.empty() || assignment.node == node || assignment.node == own_name(node);
}

}  // namespace

std::map<std::string, std::map<std::string, std::string>> start_parameters(
    const std::vector<std::string>& command, const std::string& folder,
    const std::vector<std::string>& nodes) {
  std::map<std::string, std::map<std::string, std::string>> all;
  bool is_ros = false;
  for (std::size_t i = 0; i + 1 < command.size(); ++i) {
    const std::string& word = command[i];
    if (word == "--ros-args") is_ros = true;
    if (word == "--") is_ros = false;
    if (!is_ros) continue;
    const std::string& next = command[i + 1];
    for (const std::string& node : nodes) {
      if (word == "--params-file") {
        const auto found =
            owners::read_parameter_file((std::filesystem::path(folder) / next).native(), node);
        if (!found) continue;
        for (const auto& [name, value] : *found) all[node][name] = owners::to_yaml(value);
      } else if (word == "-p" || word == "--param") {
        const Assignment assignment = parse(next);
        const auto value = owners::parse_parameter_value(assignment.value);
        if (!assignment.name.empty() && value && is_of(assignment, node))
          all[node][assignment.name] = owners::to_yaml(*value);
      }
    }
  }
  return all;
}

}  // namespace culprit::doctor
