#include "live/link_program.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <sstream>
#include <unistd.h>

#include "live/rule_trust.h"
#include "owners/setup.h"
#include "owners/spawn.h"

namespace culprit::live {
namespace {

namespace fs = std::filesystem;

Expected<std::vector<std::string>> environment_of_robot(const RuleSet& rules) {
  const auto with_setup = std::ranges::find_if(
      rules.components, [](const Component& each) { return !each.setup.empty(); });
  if (with_setup == rules.components.end()) return owners::environment_with({});
  if (const auto trusted = trust_setup(with_setup->setup); !trusted) return Error{trusted.error()};
  const auto after = owners::environment_after(with_setup->setup, {});
  if (!after) return Error{after.error()};
  return owners::environment_with(*after);
}

std::optional<fs::path> first_in(const std::string& folders, const fs::path& below) {
  std::stringstream all(folders);
  for (std::string folder; std::getline(all, folder, ':');) {
    const fs::path path = fs::path(folder) / below;
    if (!folder.empty() && access(path.c_str(), X_OK) == 0) return path;
  }
  return std::nullopt;
}

}  // namespace

Expected<std::shared_ptr<const ros2::HelperOptions>> link_program(const RuleSet& rules,
                                                                  const std::string& program) {
  auto environment = environment_of_robot(rules);
  if (!environment) return Error{environment.error()};
  std::optional<fs::path> path;
  if (!program.empty()) {
    path = fs::absolute(program);
    if (access(path->c_str(), X_OK) != 0)
      return Error{"--link-program " + program + " cannot be run: is it a program?"};
  }
  if (!path) {
    path = first_in(owners::value_in_environment("AMENT_PREFIX_PATH", *environment),
                    "lib/culprit_link/culprit_link");
  }
  if (!path) path = first_in(owners::value_in_environment("PATH", *environment), "culprit_link");
  if (!path)
    return Error{
        "--link ros needs the helper program culprit_link, which is neither in AMENT_PREFIX_PATH "
        "nor in "
        "PATH: build the package ros/culprit_link in the robot's workspace and source that, or "
        "name the "
        "program with --link-program"};
  auto helper = std::make_shared<ros2::HelperOptions>();
  helper->command = {path->string()};
  helper->environment = std::move(*environment);
  return std::shared_ptr<const ros2::HelperOptions>(std::move(helper));
}

}  // namespace culprit::live
