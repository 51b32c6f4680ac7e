#include "live/setups.h"

#include <map>
#include <poll.h>
#include <system_error>

#include "base/environment.h"
#include "live/rule_trust.h"
#include "owners/setup.h"
#include "owners/spawn.h"

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

std::optional<LiveInventory::LaunchTrouble> launch_trouble(const Component& component) {
  using Found = LiveInventory::LaunchTrouble;
  if (component.launch.empty()) return std::nullopt;
  if (!component.setup.empty()) {
    const auto trusted = trust_setup(component.setup);
    if (!trusted)
      return Found{component.name, Found::Clause::kSetup, component.setup, trusted.error()};
  }
  std::error_code error;
  if (!component.folder.empty() && !std::filesystem::is_directory(component.folder, error))
    return Found{component.name, Found::Clause::kFolder, component.folder,
                 "there is no folder " + component.folder};
  if (!component.setup.empty()) return std::nullopt;
  // Looked for where culprit run looks for it.
  owners::Program program{component.launch, {own_folder()}, "/dev/null", component.environment};
  program.folder = component.folder;
  if (const auto could = could_run(program); !could)
    return Found{component.name, Found::Clause::kLaunch, component.launch.front(), could.error()};
  return std::nullopt;
}

}  // namespace culprit::live
