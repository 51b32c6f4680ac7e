#include "cli/unit_settings.h"

#include <algorithm>

#include <fmt/core.h>
#include <fmt/ranges.h>

namespace culprit::cli {
namespace {

// The rules' effects on processes: names of components, each once, in file order.
struct Processes {
  std::vector<std::string> started;
  std::vector<std::string> ended;
  std::vector<std::string> of_systemd;  // that is asked to do it
  std::vector<std::string> of_engines;  // likewise
  std::vector<std::string> elsewhere;   // likewise, over ssh
};

// The component whose process it lives in: its container's, if that is one.
ComponentId process_of(ComponentId component, const RuleSet& rules) {
  for (std::size_t c = 0; rules[component].composed && c < rules.components.size(); ++c) {
    if (rules.components[c].node == rules[component].composed->container) return ComponentId(c);
  }
  return component;
}

Processes processes_of(const RuleSet& rules) {
  Processes processes;
  const auto add = [&](std::vector<std::string>& names, ComponentId component) {
    const std::string& name = rules[component].name;
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const Strategy& strategy : rules.strategies) {
    for (const Adaptation& adaptation : strategy.adaptations) {
      const bool redeploys = adaptation.type == AdaptationType::kRedeploy;
      const bool starts_or_ends = redeploys || adaptation.type == AdaptationType::kStart ||
                                  adaptation.type == AdaptationType::kStop;
      if (starts_or_ends && !rules[adaptation.component].host().empty()) {
        add(processes.elsewhere, adaptation.component);
        continue;
      }
      if (starts_or_ends && rules[adaptation.component].unit) {
        add(processes.of_systemd, adaptation.component);
        continue;
      }
      if (starts_or_ends && rules[adaptation.component].engine) {
        add(processes.of_engines, adaptation.component);
        continue;
      }
      // For what a container loads it may be replaced itself.
      const ComponentId component = process_of(adaptation.component, rules);
      if (redeploys || adaptation.type == AdaptationType::kStart) add(processes.started, component);
      if (redeploys || adaptation.type == AdaptationType::kStop) add(processes.ended, component);
    }
  }
  return processes;
}

enum class Variables : std::uint8_t { kAreNone, kAreReplaced };

// One word of a setting in which systemd replaces variables, or not (systemd.service(5)).
std::string quoted(const std::string& text, Variables variables = Variables::kAreNone) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (c == '%' || (c == '$' && variables == Variables::kAreReplaced)) out += c;
    out += c == '\n' ? "\\n" : std::string(1, c);
  }
  return out + "\"";
}

std::string start_settings(const Processes& processes) {
  if (processes.started.empty() && processes.elsewhere.empty()) {
    return "# No program is ever started: nothing but culprit can be executed, and what reloads "
           "it.\n"
           "NoExecPaths=/\n"
           "ExecPaths=/usr/bin/culprit /usr/bin/kill -/usr/lib -/usr/lib32 -/usr/lib64\n"
           "# So these limits are culprit's own.\n"
           "TasksMax=512\n"
           "MemoryMax=1G\n";
  }
  if (processes.started.empty()) return "";
  return fmt::format(
      "# These are started and live in this sandbox: {}.\n"
      "# What one of them needs has to be allowed here. A driver needs its device:\n"
      "#   PrivateDevices=no\n"
      "#   DevicePolicy=closed\n"
      "#   DeviceAllow=/dev/video0 rw\n"
      "# a controller real-time threads (RestrictRealtime=no), a program that compiles while it\n"
      "# runs memory that it may execute (MemoryDenyWriteExecute=no). They count for TasksMax= "
      "and\n"
      "# MemoryMax= of the service, too.\n"
      "Environment=ROS_LOG_DIR=/var/lib/culprit/ros-log\n",
      fmt::join(processes.started, ", "));
}

std::string end_settings(const Processes& processes, NodeOwner nodes) {
  const bool ends = !processes.ended.empty();
  if (nodes == NodeOwner::kSameUser) {
    if (ends)
      return fmt::format("# culprit ends these processes, so User= must be their user: {}.\n",
                         fmt::join(processes.ended, ", "));
    if (!processes.started.empty() || !processes.of_systemd.empty() ||
        !processes.of_engines.empty() || !processes.elsewhere.empty())
      return "";
    return "# No process is ever ended or started, so no user is needed.\n"
           "User=\n"
           "DynamicUser=yes\n";
  }
  const std::string capabilities = ends ? "CAP_KILL CAP_SYS_PTRACE" : "CAP_SYS_PTRACE";
  return fmt::format(
      "# Which process of another user is behind a node is seen with CAP_SYS_PTRACE only{}.\n"
      "CapabilityBoundingSet={}\n"
      "AmbientCapabilities={}\n",
      ends
          ? fmt::format("; it is\n# ended with CAP_KILL only: {}", fmt::join(processes.ended, ", "))
          : "",
      capabilities, capabilities);
}

}  // namespace

std::string unit_settings(const RuleSet& rules, const UnitOptions& options) {
  const Processes processes = processes_of(rules);
  std::string text = fmt::format(
      "# What the rules below need; for /etc/systemd/system/culprit.service.d/rules.conf\n"
      "[Service]\n"
      "ExecStart=\n"
      "ExecStart=/usr/bin/culprit run {} --state-dir /var/lib/culprit\n",
      quoted(options.rules, Variables::kAreReplaced));
  for (const auto& [name, value] : options.environment)
    text += fmt::format("Environment={}\n", quoted(name + "=" + value));
  text += "\n" + start_settings(processes);
  if (!processes.of_systemd.empty())
    text += fmt::format(
        "\n# systemd is asked to start and end these, so User= needs the right to "
        "(docs/security.md): {}.\n",
        fmt::join(processes.of_systemd, ", "));
  if (!processes.of_engines.empty())
    text += fmt::format(
        "\n# Container engines are asked to start and end these, so User= needs their sockets "
        "(docs/security.md): {}.\n",
        fmt::join(processes.of_engines, ", "));
  if (!processes.elsewhere.empty())
    text += fmt::format(
        "\n# These are started and ended on other computers, which are asked over ssh, so User=\n"
        "# needs a home with a key that they take without a password (docs/security.md): {}.\n",
        fmt::join(processes.elsewhere, ", "));
  const std::string more = end_settings(processes, options.nodes);
  return more.empty() ? text : text + "\n" + more;
}

}  // namespace culprit::cli
