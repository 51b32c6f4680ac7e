#include "cli/run_options.h"

#include <algorithm>
#include <cctype>

#include <fmt/core.h>

#include "base/environment.h"
#include "base/name_grammar.h"
#include "base/units.h"
#include "live/link_program.h"
#include "live/robot_survey.h"
#include "live/run_journal.h"
#include "terminal/command.h"
#include "terminal/seconds_option.h"

namespace culprit::cli {

std::filesystem::path RunOptions::state_path() const {
  return state_folder.empty() ? default_state_folder() : std::filesystem::path(state_folder);
}

std::filesystem::path RunOptions::journal_path(const RuleSet& rule_set) const {
  return journal.empty() ? live::default_journal(state_path(), rule_set.robot)
                         : std::filesystem::path(journal);
}

Expected<live::LiveSession::Options> RunOptions::session(const RuleSet& rule_set) const {
  const auto participant = ros2::options_from_environment();
  if (!participant) return Error{participant.error()};
  const auto limits = governor.options();
  if (!limits) return Error{limits.error()};
  live::LiveSession::Options out;
  out.version = version;
  out.rules_file = rules;
  out.robot.link.participant = *participant;
  if (link == "ros") {
    auto helper = live::link_program(rule_set, link_program);
    if (!helper) return Error{helper.error()};
    out.robot.link.participant.helper = std::move(*helper);
    out.has_preflight = false;  // it looks at the robot over DDS
  }
  out.robot.link.types = live::sources_of_types(message_path);
  out.robot.link.use_sim_time = use_sim_time;
  if (!node_name.empty()) out.robot.link.name.name = node_name;
  out.robot.link.parameters = {
      {"rules", Value(rules)}, {"planner", Value(planner.name)}, {"dry_run", Value(dry_run)}};
  out.robot.supervisor = {state_path() / "log", {own_folder()}};
  out.planner = planner.factory();
  out.governor = *limits;
  out.planner_record = planner.to_json();
  out.governor_record = governor.to_json();
  out.forgetting = forgetting;
  out.discovery = from_seconds(settle_seconds);
  out.launches = launch;
  out.message_path = message_path;
  out.journal = journal_path(rule_set);
  if (no_journal) out.no_journal = "of --no-journal";
  return out;
}

std::string RunOptions::remarks() const {
  std::string lines;
  if (fleet.address.empty() && (!fleet.name.empty() || !fleet.context.empty()))
    lines += "culprit: --fleet-name and --fleet-context have no effect without --fleet\n";
  if (governor.backoff_seconds > governor.backoff_most_seconds)
    lines += fmt::format("culprit: --backoff-most limits the back-off to {}; --backoff is longer\n",
                         to_string(from_seconds(governor.backoff_most_seconds)));
  return lines;
}

namespace {

// "dry-run": "CULPRIT_DRY_RUN"
std::string variable_of(const std::string& option) {
  std::string name = "CULPRIT_" + option;
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) {
    return c == '-' ? '_' : static_cast<char>(std::toupper(c));
  });
  return name;
}

}  // namespace

void RunOptions::add_to(CLI::App& command) {
  add_ways(command);
  add_files(command);
  add_node(command);
  add_reports(command);
  planner.add_to(command);
  command.add_flag("--web", is_on_web, "Show the robot, decisions and repairs in a browser");
  command.add_flag("--edit-rules", may_edit_commands,
                   "Let the page also change executed commands: LAUNCH, UNIT, call and the like");
  web.add_to(command);
  recording.add_to(command);
  governor.add_to(command);
  add_configuration(command);
}

void RunOptions::add_ways(CLI::App& command) {
  command.add_option("RULES", rules, "The rule file")->type_name("FILE")->required();
  command.add_flag("--dry-run", dry_run, "Report decisions without carrying them out");
  command.add_flag("--launch", launch,
                   "Start components that are missing, by their LAUNCH commands, and bring their "
                   "lifecycle nodes up");
  command.add_flag("--improvise", improvise,
                   "Also repair components without a rule, by restart or redeploy where possible");
  add_seconds(command, "--settle", settle_seconds,
              "Grace period for discovery; nothing is reported missing before it ends", 0, 3600);
}

void RunOptions::add_files(CLI::App& command) {
  command
      .add_option("--state-dir", state_folder,
                  "Folder for the journal and for logs of started components")
      ->type_name("FOLDER")
      ->check(trouble_of_folder)
      ->default_str("~/.local/state/culprit");
  auto* kept = command
                   .add_option("--journal", journal,
                               "Journal file (default: <robot>.journal in the state folder)")
                   ->type_name("FILE");
  auto* unkept =
      command.add_flag("--no-journal", no_journal, "Run without a journal")->excludes(kept);
  fleet.add_to(command);
  command.get_option("--fleet")->excludes(unkept);
  command
      .add_option("--lease-key", lease_key,
                  "Private file with the key that culprits on other machines share, to agree on "
                  "one manager (docs/security.md)")
      ->type_name("FILE");
  command
      .add_option("--message-path", message_path,
                  "Folders with .msg files: <folder>/<package>/msg/<Type>.msg")
      ->type_name("FOLDER");
}

void RunOptions::add_node(CLI::App& command) {
  command.add_flag("--use-sim-time", use_sim_time,
                   "The robot is simulated; judge nothing while its /clock stands still");
  command
      .add_option(
          "--link", link,
          "How culprit reaches the robot: dds, or ros, through the robot's own middleware by the "
          "program of ros/culprit_link (docs/link-protocol.md)")
      ->check(CLI::IsMember({"dds", "ros"}))
      ->capture_default_str();
  command
      .add_option("--link-program", link_program,
                  "The program of --link ros (default: that of the robot's workspace, or in PATH)")
      ->type_name("FILE");
  command
      .add_option("--node-name", node_name,
                  "Name of culprit's own node (default: culprit; culprit_2 and so on beside others "
                  "of this machine)")
      ->check([](const std::string& name) {
        return is_valid_node_name(name) ? std::string() : "'" + name + "' is no name of a node";
      });
  command.add_flag(
      "--orders-from-anyone", takes_orders_from_anyone,
      "Take orders over DDS (~/pause, ~/run_strategy ...) also on a domain without keys, where any "
      "participant can then pause culprit or have it restart nodes (docs/ros2-packages.md)");
}

void RunOptions::add_reports(CLI::App& command) {
  command.add_option("--forgetting", forgetting, "Discount factor per outcome (1 = never forget)")
      ->check(CLI::Range(0.5, 1.0))
      ->capture_default_str();
  command.add_flag(
      "--json", json,
      "Print events as JSON, one document a line (docs/web.md); other output goes to stderr");
  command
      .add_option(
          "--alerts", alerts,
          "Private file with the receivers of alerts: webhooks or programs (docs/alerts.md)")
      ->type_name("FILE");
}

void RunOptions::add_configuration(CLI::App& command) {
  // Before the variables are named: CULPRIT_CONFIG names the file.
  command.add_option("--config", config, "Options in a file, as --print-config prints them")
      ->type_name("FILE")
      ->envname("CULPRIT_CONFIG")
      ->configurable(false);
  command
      .add_flag("--print-config", prints_config,
                "Print all options and their values as culprit.toml, and end")
      ->configurable(false);
  for (CLI::Option* option : command.get_options([](const CLI::Option* each) {
         return each->get_configurable() && !each->get_lnames().empty();
       })) {
    if (option != command.get_help_ptr())
      option->envname(variable_of(option->get_lnames().front()));
  }
}

}  // namespace culprit::cli
