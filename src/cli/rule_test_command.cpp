// Not called test_command.cpp: test_*.cpp are what only tests of a folder use.
#include <chrono>
#include <fstream>
#include <memory>
#include <unistd.h>

#include <fmt/core.h>

#include "cli/commands.h"
#include "cli/diagnostic_report.h"
#include "json/json.h"
#include "rule_files/rule_files.h"
#include "rule_test/file_run.h"
#include "terminal/console.h"
#include "terminal/planner_options.h"

namespace culprit::cli {
namespace {

struct TestOptions {
  std::vector<std::string> files;
  std::string filter;
  std::string junit;
  bool json = false;
  PlannerOptions planner;
};

struct Totals {
  int tests = 0;
  int failed = 0;
  int unusable_files = 0;
  Duration robot_time{};

  void add(const rule_test::FileRun& run) {
    if (!run.is_usable) ++unusable_files;
    for (const auto& suite : run.suites) {
      for (const auto& test : suite.cases) {
        ++tests;
        if (!test.failure.empty()) ++failed;
        robot_time += test.length;
      }
    }
  }
};

bool write_junit(const std::string& path, const std::vector<rule_test::SuiteReport>& suites) {
  std::ofstream file(path, std::ios::binary);
  file << rule_test::junit(suites);
  file.close();
  if (file) return true;
  fmt::print(stderr, "culprit: cannot write {}\n", path);
  return false;
}

// Lengths are those of the robot's clock.
Json results_as_json(const Totals& totals, const std::vector<rule_test::SuiteReport>& suites) {
  Json all{{"tests", totals.tests}, {"failed", totals.failed}, {"suites", Json::array()}};
  for (const rule_test::SuiteReport& suite : suites) {
    Json cases = Json::array();
    for (const auto& each : suite.cases)
      cases.push_back({{"name", each.name},
                       {"ok", each.failure.empty()},
                       {"length_s", seconds(each.length)},
                       {"failure", each.failure}});
    all["suites"].push_back({{"name", suite.name}, {"cases", std::move(cases)}});
  }
  return all;
}

// Replaces folders by the files in them. A missing path is reported and counted.
std::vector<std::string> files_of(const std::vector<std::string>& paths, Totals& totals) {
  std::vector<std::string> all;
  for (const std::string& path : paths) {
    const auto files = rule_files::files_in(path, ".test");
    if (files) {
      all.insert(all.end(), files->begin(), files->end());
    } else {
      ++totals.unusable_files;
      fail(files.error());
    }
  }
  return all;
}

int run_tests(const TestOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  Totals totals;
  std::vector<rule_test::SuiteReport> suites;
  for (const std::string& file : files_of(options.files, totals)) {
    rule_test::FileRun run = rule_test::run_file(file, options.filter, options.planner.factory(),
                                                 colour_of(STDERR_FILENO));
    fmt::print(stderr, "{}", run.complaints);
    if (!options.json) fmt::print("{}", run.output);
    totals.add(run);
    const bool is_read = !run.complaints.starts_with("culprit: ");
    if (!run.is_usable && is_read) fmt::print(stderr, "culprit: {} cannot be run\n", file);
    std::move(run.suites.begin(), run.suites.end(), std::back_inserter(suites));
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  if (options.json) fmt::print("{}\n", to_text(results_as_json(totals, suites)));
  const bool has_run = totals.tests > 0 || totals.unusable_files == 0;
  if (!options.json && has_run)
    fmt::print("{} tests, {} failed; {:g} s of the robot's time in {:.3f} s\n", totals.tests,
               totals.failed, seconds(totals.robot_time), took.count());
  if (!options.junit.empty() && !write_junit(options.junit, suites)) return kFailed;
  if (totals.unusable_files > 0) return kFailed;
  if (totals.tests == 0) {
    fmt::print(stderr, "culprit: no test is called like '{}'\n", options.filter);
    return kUsage;
  }
  return totals.failed > 0 ? kFailed : kOk;
}

}  // namespace

void add_test(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<TestOptions>();
  CLI::App* command = app.add_subcommand(
      "test", "Run unit tests of rule files: the manager's behaviour on a simulated robot");
  command->add_option("FILES", options->files, "Test files, and folders of *.test")
      ->type_name("FILE")
      ->required();
  command->add_option("--filter", options->filter, "Only tests whose name contains this");
  command->add_option("--junit", options->junit, "Write the results as JUnit XML to this file")
      ->type_name("FILE");
  command->add_flag("--json", options->json, "Print the results as a JSON document");
  options->planner.add_to(*command);
  command->callback([options, &exit_code] { exit_code = run_tests(*options); });
}

}  // namespace culprit::cli
