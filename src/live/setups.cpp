#include "live/setups.h"

#include <map>
#include <optional>
#include <poll.h>
#include <system_error>
#include <tuple>

#include "base/environment.h"
#include "live/rule_trust.h"
#include "owners/launch_file.h"
#include "owners/setup.h"
#include "owners/spawn.h"
#include "owners/start_needs.h"

namespace culprit::live {
namespace {

using Environment = Expected<std::vector<std::string>>;

Environment environment_of(const Component& component) {
  if (component.setup.empty()) return component.environment;
  if (const auto trusted = trust_setup(component.setup); !trusted) return Error{trusted.error()};
  return owners::environment_after(component.setup, component.environment);
}

// All of a start but its last step.
Expected<void> could_run(const owners::Program& program) {
  constexpr int kPatienceMs = 5000;
  auto launch = owners::Launch::begin(program, owners::Until::kItCouldRun);
  if (!launch) return Error{launch.error()};
  pollfd outcome{launch->descriptor(), POLLIN, 0};
  if (poll(&outcome, 1, kPatienceMs) > 0) return launch->outcome();
  return Error{"its start was tried and hung; does the file system of its program answer?"};
}

using Trouble = LiveInventory::LaunchTrouble;

std::optional<Trouble> trouble_of(const Component& component) {
  if (!component.setup.empty()) {
    const auto trusted = trust_setup(component.setup);
    if (!trusted)
      return Trouble{component.name, Trouble::Clause::kSetup, component.setup, trusted.error()};
  }
  std::error_code error;
  if (!component.folder.empty() && !std::filesystem::is_directory(component.folder, error))
    return Trouble{component.name, Trouble::Clause::kFolder, component.folder,
                   "there is no folder " + component.folder};
  if (!component.setup.empty()) return std::nullopt;
  // Looked for where culprit run looks for it.
  const std::string prefixes =
      owners::value_in_environment("AMENT_PREFIX_PATH", component.environment);
  owners::Program program{owners::program_of_launch(component.launch, prefixes),
                          {own_folder()},
                          "/dev/null",
                          component.environment};
  program.folder = component.folder;
  program.needs = owners::start_needs(component.launch, prefixes);
  if (const auto could = could_run(program); !could)
    return Trouble{component.name, Trouble::Clause::kLaunch, component.launch.front(),
                   could.error()};
  return std::nullopt;
}

}  // namespace

std::vector<Environment> environments_of(const RuleSet& rules) {
  std::map<std::pair<std::string, std::vector<std::string>>, Environment> known;
  std::vector<Environment> all;
  for (const Component& component : rules.components) {
    const std::pair key(component.setup, component.environment);
    auto found = known.find(key);
    if (found == known.end()) found = known.emplace(key, environment_of(component)).first;
    all.push_back(found->second);
  }
  return all;
}

std::vector<Trouble> launch_troubles(const RuleSet& rules, const std::stop_token& stop) {
  // All that a trouble depends on: of many components of one program there is one answer.
  using Asked = std::tuple<const std::vector<std::string>&, const std::string&, const std::string&,
                           const std::vector<std::string>&>;
  std::map<Asked, std::optional<Trouble>> answers;
  std::vector<Trouble> all;
  for (const Component& component : rules.components) {
    if (stop.stop_requested()) break;
    if (component.launch.empty()) continue;
    const auto [answer, is_new] = answers.try_emplace(
        Asked(component.launch, component.setup, component.folder, component.environment));
    if (is_new) answer->second = trouble_of(component);
    if (!answer->second) continue;
    all.push_back(*answer->second);
    all.back().component = component.name;
  }
  return all;
}

}  // namespace culprit::live
