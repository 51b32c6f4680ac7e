#include "language/improvise.h"

#include <algorithm>

namespace culprit {
namespace {

std::string strategy(const std::string& component, const std::string& what, Cycles impact,
                     const std::string& when) {
  return "    STRATEGY " + std::string(kImprovised) + what + " 50 2" + when +
         "\n      ADAPTATION " + component + " " + what + " " + std::to_string(impact.count) + "\n";
}

std::string rule(const Component& component, Cycles heaviest) {
  const std::string& name = component.name;
  const std::string lifecycle = "lifecycle(" + name + ")";
  const bool can_launch = component.can_start_again();
  std::string text = "\nRULE " + std::string(kImprovised) + name +
                     "\n  POLICIES NON_CRITICAL FOR 2s ATTEMPTS 3\n  TRIGGER ";
  if (can_launch) text += "!alive(" + name + ") || " + lifecycle + " == \"finalized\" || ";
  text += lifecycle + " == \"unconfigured\"\n";
  text += strategy(name, "restart", Cycles{std::max<std::int64_t>(1, heaviest.count / 2)},
                   " WHEN " + lifecycle + " == \"unconfigured\"");
  if (can_launch) text += strategy(name, "redeploy", heaviest, "");
  return text;
}

}  // namespace

std::string improvised_rules(const RuleSet& rules) {
  std::string text;
  const Cycles heaviest{std::max<std::int64_t>(1, rules.heaviest.count)};
  for (std::size_t c = 0; c < rules.components.size(); ++c) {
    const bool is_adapted =
        std::any_of(rules.rules.begin(), rules.rules.end(), [&](const Rule& rule) {
          return std::binary_search(rule.components.begin(), rule.components.end(), ComponentId(c));
        });
    if (is_adapted || !rules.components[c].declared) continue;
    if (text.empty()) text = "\n# Improvised: nobody wrote rules for these components.\n";
    text += rule(rules.components[c], heaviest);
  }
  return text;
}

}  // namespace culprit
