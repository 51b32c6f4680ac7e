// The subcommands of culprit. Each adds itself to the command line, and gives its exit code when it
// was chosen (terminal/command.h).
#pragma once

#include <string>
#include <string_view>

#include <CLI/CLI.hpp>

#include "terminal/command.h"

namespace culprit::cli {

// All of them, in the order of --help, and the manual.
void add_all(CLI::App& app, const std::string& version, int& exit_code);
// Whether culprit-lab does it in culprit's name.
bool is_of_laboratory(std::string_view command);

void add_run(CLI::App& app, const std::string& version, int& exit_code);
void add_status(CLI::App& app, int& exit_code);
void add_top(CLI::App& app, int& exit_code);
// pause, resume, mute, approve, refuse, propose, run-strategy
void add_orders(CLI::App& app, int& exit_code);
void add_names(CLI::App& app, int& exit_code);
void add_record(CLI::App& app, int& exit_code);
void add_alerts(CLI::App& app, int& exit_code);
void add_check(CLI::App& app, int& exit_code);
void add_doctor(CLI::App& app, int& exit_code);
void add_init(CLI::App& app, int& exit_code);
void add_drill(CLI::App& app, int& exit_code);
void add_explain(CLI::App& app, int& exit_code);
void add_fmt(CLI::App& app, int& exit_code);
void add_test(CLI::App& app, int& exit_code);
void add_plan(CLI::App& app, int& exit_code);
void add_graph(CLI::App& app, int& exit_code);
void add_lsp(CLI::App& app, const std::string& version, int& exit_code);
void add_mcp(CLI::App& app, const std::string& version, int& exit_code);
void add_web(CLI::App& app, int& exit_code);
void add_import(CLI::App& app, int& exit_code);
void add_log(CLI::App& app, int& exit_code);
void add_incident(CLI::App& app, int& exit_code);
void add_audit(CLI::App& app, int& exit_code);
void add_beliefs(CLI::App& app, int& exit_code);
void add_replay(CLI::App& app, int& exit_code);
void add_info(CLI::App& app, int& exit_code);
void add_modes(CLI::App& app, int& exit_code);
void add_export(CLI::App& app, int& exit_code);
void add_policy(CLI::App& app, int& exit_code);
void add_fleet(CLI::App& app, int& exit_code);  // only where it was built with fleets

}  // namespace culprit::cli
