// The subcommands of culprit. Each adds itself to the command line, and gives its exit code when it
// was chosen: 0 = all is well, 1 = what was asked for did not succeed, 2 = it was asked for
// wrongly.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace culprit::cli {

constexpr int kOk = 0;
constexpr int kFailed = 1;
constexpr int kUsage = 2;

// Says on stderr why it cannot be done. Gives `exit_code`.
int fail(const std::string& why, int exit_code = kFailed);

void add_run(CLI::App& app, const std::string& version, int& exit_code);
void add_check(CLI::App& app, int& exit_code);
void add_explain(CLI::App& app, int& exit_code);
void add_fmt(CLI::App& app, int& exit_code);
void add_test(CLI::App& app, int& exit_code);
void add_plan(CLI::App& app, int& exit_code);
void add_graph(CLI::App& app, int& exit_code);
void add_demo(CLI::App& app, int& exit_code);
void add_lsp(CLI::App& app, const std::string& version, int& exit_code);
void add_web(CLI::App& app, int& exit_code);
void add_import(CLI::App& app, int& exit_code);
void add_study(CLI::App& app, const std::string& version, int& exit_code);
void add_log(CLI::App& app, int& exit_code);
void add_audit(CLI::App& app, int& exit_code);
void add_beliefs(CLI::App& app, int& exit_code);
void add_replay(CLI::App& app, int& exit_code);
void add_modes(CLI::App& app, int& exit_code);
void add_export(CLI::App& app, int& exit_code);
void add_torture(CLI::App& app, int& exit_code);
void add_policy(CLI::App& app, int& exit_code);

}  // namespace culprit::cli
