#include "web/rule_commands.h"

#include <algorithm>

#include <fmt/core.h>
#include <fmt/ranges.h>

namespace culprit::web {
namespace {

void add_component(const Component& what, std::vector<std::string>& lines) {
  const auto add = [&](const std::string& line) { lines.push_back(what.name + " " + line); };
  if (!what.launch.empty()) {
    add(fmt::format("LAUNCH {}", fmt::join(what.launch, " ")));
    // One word with a blank is not two.
    for (std::size_t i = 0; i < what.launch.size(); ++i)
      add(fmt::format("LAUNCH word {}: {}", i, what.launch[i]));
  }
  if (!what.setup.empty()) add("SETUP " + what.setup);
  if (!what.folder.empty()) add("CWD " + what.folder);
  for (const std::string& each : what.environment) add("ENV " + each);
  if (what.unit)
    add(fmt::format("UNIT {}{} {}", what.unit->name, what.unit->is_of_user ? " USER" : "",
                    what.unit->host));
  if (what.engine)
    add(fmt::format("CONTAINER {} {} {}",
                    what.engine->engine == EngineContainer::Engine::kDocker ? "docker" : "podman",
                    what.engine->name, what.engine->host));
  if (what.composed)
    add(fmt::format("IN {} PLUGIN {} {} PARAMETERS {} {}", what.composed->container,
                    what.composed->package, what.composed->plugin, what.composed->parameters,
                    fmt::join(what.composed->remaps, " ")));
  // Another process would be ended and started in its place.
  const bool is_executed =
      !what.launch.empty() || what.unit || what.engine || what.composed || what.is_respawned;
  if (is_executed) add(fmt::format("NODE {}{}", what.node, what.is_respawned ? " RESPAWNED" : ""));
}

}  // namespace

std::vector<std::string> commands_of(const RuleSet& rules) {
  std::vector<std::string> lines;
  for (const Component& each : rules.components) add_component(each, lines);
  for (const Strategy& strategy : rules.strategies) {
    for (const Adaptation& adaptation : strategy.adaptations) {
      if (adaptation.type == AdaptationType::kCall)
        lines.push_back(fmt::format("{}.{} call {} {} {}", rules[strategy.rule].name, strategy.name,
                                    rules[adaptation.component].name, adaptation.subject,
                                    adaptation.request));
    }
  }
  std::sort(lines.begin(), lines.end());
  return lines;
}

}  // namespace culprit::web
