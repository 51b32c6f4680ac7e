#include "cli/culprit_manual.h"

namespace culprit::cli {
namespace {

constexpr const char* kLaboratory = "The laboratory";

}  // namespace

const Manual& culprit_manual() {
  static const Manual manual{
      .name = "culprit",
      .purpose = "keep ROS 2 robots working",
      .description =
          {"culprit watches a live robot, finds the component that is responsible when many things "
           "fail at once, and applies the fewest, cheapest adaptations that bring the robot back. "
           "A rule file describes the failures, their detection and possible repairs. culprit "
           "keeps its findings, decisions and actions in a journal, and learns from every attempt.",
           "Options that take a time take a unit: 500ms, 8s, 1.5min (or 1.5m), 2h, 1d; a number "
           "alone is of seconds. With --json, "
           "commands print one JSON document (log: one for each row) and nothing else "
           "on the standard output. Colours are "
           "only for terminals; NO_COLOR switches them off."},
      .files = {{"~/.local/state/culprit",
                 "Journals, and the logs of the components that culprit started; "
                 "$XDG_STATE_HOME/culprit if that is set."},
                {"$XDG_RUNTIME_DIR/culprit, /run/culprit, /run/culprit-0, /tmp/culprit-<uid>",
                 "Sockets of running culprits, for status, top, pause and the like."}},
      .environment =
          {{"ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY, ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS",
            "The robot's network, as for any ROS 2 program."},
           {"ROS_SECURITY_ENABLE, ROS_SECURITY_STRATEGY, ROS_SECURITY_KEYSTORE, "
            "ROS_SECURITY_ENCLAVE_OVERRIDE",
            "The domain's security, as for any ROS 2 program."},
           {"CULPRIT_CONFIG", "The configuration file of culprit run, as --config."},
           {"CULPRIT_DRY_RUN, CULPRIT_WEB, ...",
            "Each option of culprit run, if it is not on the command line."},
           {"NO_COLOR", "If it is set, nothing is coloured."}},
      .examples = {{"culprit demo", "A first look: culprit heals a robot that it brings along."},
                   {"culprit doctor", "Find what is wrong with your robot, without a rule."},
                   {"culprit init -o my.rules", "Draft a rule file from the healthy robot."},
                   {"culprit check --robot my.rules", "Check whether it fits the robot."},
                   {"culprit run --dry-run my.rules", "Show what culprit would do."},
                   {"culprit run --web my.rules", "Manage the robot, and show it in a browser."},
                   {"culprit status", "Show failures, their root cause, and the next step."}},
      .see_also = "culprit-lab(1); the documents in /usr/share/doc/culprit/docs",
      .others = {kLaboratory, "culprit-lab"}};
  return manual;
}

void group_commands(CLI::App& app) {
  struct Group {
    const char* title;
    std::vector<const char*> commands;
  };
  const Group groups[] = {
      {"On a robot", {"run", "doctor", "init", "drill", "graph", "plan", "modes"}},
      {"A running culprit",
       {"status", "top", "pause", "resume", "mute", "approve", "refuse", "propose", "run-strategy",
        "revive", "end-started", "record", "alerts"}},
      {"Rules",
       {"check", "explain", "fmt", "test", "import", "export", "policy", "web", "lsp", "mcp"}},
      {"History", {"log", "incident", "audit", "beliefs", "replay", "info"}},
#ifdef CULPRIT_FLEET
      {"A fleet", {"fleet"}},
#endif
      {kLaboratory, {"demo", "study", "torture"}},
      {"Help", {"help"}}};
  for (const Group& group : groups) {
    for (const char* command : group.commands) app.get_subcommand(command)->group(group.title);
  }
}

}  // namespace culprit::cli
