// How `culprit run` was called, and what follows from it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/governor_options.h"
#include "cli/run_fleet.h"
#include "cli/run_recording.h"
#include "live/live_session.h"
#include "terminal/planner_options.h"
#include "terminal/web_service.h"

namespace culprit::cli {

struct RunOptions {
  std::string version;  // of culprit
  std::string rules;
  std::string config;  // a file (cli/run_configuration.h); empty: there is none
  bool prints_config = false;
  bool dry_run = false;
  bool launch = false;
  bool improvise = false;
  PlannerOptions planner;
  GovernorOptions governor;
  double forgetting = 1;
  double settle_seconds = seconds(Manager::kDiscovery);
  std::string state_folder;
  std::string journal;
  std::string lease_key;  // a file; empty: culprits on other machines are not believed
  bool no_journal = false;
  FleetOptions fleet;
  std::vector<std::filesystem::path> message_path;
  bool use_sim_time = false;
  bool json = false;
  std::string link = "dds";  // or "ros": through the helper program
  std::string link_program;  // the helper; empty: the one of the robot's workspace, or of PATH
  std::string node_name;     // empty: the first that no other culprit of this machine has
  bool takes_orders_from_anyone = false;  // over DDS, on a domain without keys
  std::string alerts;                     // a file; empty: nobody is alerted
  RecordingOptions recording;
  bool is_on_web = false;
  bool may_edit_commands = false;  // from the page
  WebOptions web;

  // The options must live as long as `command`.
  void add_to(CLI::App& command);

  std::filesystem::path state_path() const;
  std::filesystem::path journal_path(const RuleSet& rules) const;
  // Errors: the environment names no DDS domain, or the governor's options are wrong.
  Expected<live::LiveSession::Options> session(const RuleSet& rules) const;
  // A line for each option that has no effect beside the others; empty: all have one.
  std::string remarks() const;

 private:
  void add_ways(CLI::App& command);
  void add_files(CLI::App& command);
  void add_node(CLI::App& command);
  void add_reports(CLI::App& command);
  void add_configuration(CLI::App& command);
};

}  // namespace culprit::cli
