#include "owners/start_needs.h"

#include <filesystem>
#include <optional>
#include <sstream>

#include "owners/launch_file.h"

namespace culprit::owners {
namespace {

std::string name_of_program(const std::string& path) {
  return std::filesystem::path(path).filename().native();
}

std::optional<StartNeed> program_of_package(const std::vector<std::string>& arguments,
                                            const std::string& prefixes) {
  if (arguments.size() < 4 || name_of_program(arguments[0]) != "ros2" || arguments[1] != "run" ||
      prefixes.empty())
    return std::nullopt;
  std::size_t at = 2;
  while (at + 1 < arguments.size() && arguments[at] == "--prefix") at += 2;
  const bool is_known_form = at + 1 < arguments.size() && !arguments[at].starts_with('-') &&
                             !arguments[at + 1].starts_with('-');
  if (!is_known_form) return std::nullopt;
  const std::string& package = arguments[at];
  const std::string& program = arguments[at + 1];
  StartNeed need{{},
                 "package " + package + " has no program '" + program + "' in AMENT_PREFIX_PATH"};
  std::istringstream list(prefixes);
  for (std::string prefix; std::getline(list, prefix, ':');)
    need.places.push_back(prefix + "/lib/" + package + "/" + program);
  return need;
}

std::optional<StartNeed> script_of(const std::vector<std::string>& arguments) {
  const bool is_python =
      arguments.size() > 1 && name_of_program(arguments[0]).starts_with("python3");
  if (!is_python || arguments[1].find('/') == std::string::npos || arguments[1].starts_with('-'))
    return std::nullopt;
  return StartNeed{{arguments[1]}, "there is no program '" + arguments[1] + "'"};
}

}  // namespace

std::vector<StartNeed> start_needs(const std::vector<std::string>& arguments,
                                   const std::string& prefixes) {
  std::vector<StartNeed> needs;
  if (const auto what = launch_file_node(arguments)) {
    if (auto need = need_of(*what, prefixes)) needs.push_back(std::move(*need));
    return needs;
  }
  if (auto need = program_of_package(arguments, prefixes)) needs.push_back(std::move(*need));
  if (auto need = script_of(arguments)) needs.push_back(std::move(*need));
  for (std::size_t i = 0; i + 1 < arguments.size(); ++i) {
    if (arguments[i] == "--params-file")
      needs.push_back(
          {{arguments[i + 1]}, "there is no parameter file '" + arguments[i + 1] + "'"});
  }
  return needs;
}

}  // namespace culprit::owners
