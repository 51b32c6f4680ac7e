#include "cli/doctor_bag.h"

#include <algorithm>
#include <unistd.h>

#include "bag_doctor/bag_report.h"
#include "bag_doctor/policy.h"
#include "base/environment.h"
#include "base/name_grammar.h"
#include "base/text_file.h"
#include "cli/finding_text.h"
#include "cli/load_rules.h"
#include "doctor/doctor_report.h"
#include "terminal/command.h"
#include "terminal/console.h"

namespace culprit::cli {
namespace {

using bag_doctor::BagReport;
using doctor::Finding;
using doctor::Gravity;

Expected<bag_doctor::RobotGraph> given_graph(const BagExamination& options) {
  bag_doctor::RobotGraph graph;
  if (!options.graph.empty()) {
    const auto text = read_text(options.graph);
    if (!text) return Error{text.error()};
    auto parsed = bag_doctor::parse_graph(*text);
    if (!parsed) return Error{options.graph + ": " + parsed.error()};
    graph = std::move(*parsed);
  }
  if (!options.rules.empty()) {
    const auto rules = load_rules(options.rules);
    if (rules == nullptr) return Error{options.rules + " has errors"};
    graph.add(bag_doctor::graph_of(*rules));
  }
  return graph;
}

Expected<bag_doctor::Policy> given_policy(const BagExamination& options) {
  if (options.policy.empty()) return bag_doctor::Policy{};
  const auto text = read_text(options.policy);
  if (!text) return Error{text.error()};
  auto policy = bag_doctor::parse_policy(*text);
  if (!policy) return Error{options.policy + ": " + policy.error()};
  return policy;
}

int exit_code_of_bags(const std::vector<BagReport>& reports, const std::string& fail_on) {
  bool has_error = false, has_any = false;
  for (const BagReport& report : reports) {
    has_any = has_any || !report.findings.empty();
    has_error = has_error || std::ranges::any_of(report.findings, [](const Finding& each) {
                  return each.gravity == Gravity::kError;
                });
  }
  if (fail_on == "never") return kOk;
  if (fail_on == "error") return has_error ? kFailed : kOk;
  if (fail_on == "warning") return has_any ? kFailed : kOk;
  return has_error ? kFailed : has_any ? kWarnings : kOk;
}

void print_bags(const std::vector<BagReport>& reports, const BagExamination& options) {
  if (options.sarif) {
    doctor::Report all;
    for (const BagReport& report : reports)
      all.findings.insert(all.findings.end(), report.findings.begin(), report.findings.end());
    say(stdout, "{}\n", to_indented(to_sarif(all)));
  } else if (options.json) {
    Json list = Json::array();
    for (const BagReport& report : reports) list.push_back(to_json(report));
    say(stdout, "{}\n", to_indented(reports.size() == 1 ? list.front() : list));
  } else {
    for (const BagReport& report : reports) {
      for (const Finding& each : report.findings) print_finding(each, colour_of(STDOUT_FILENO));
      for (const std::string& each : report.left_out) say(stdout, "{}\n", escape_controls(each));
      say(stdout, "{}\n", escape_controls(summary(report)));
    }
  }
}

}  // namespace

int examine_bags(const BagExamination& options) {
  const auto graph = given_graph(options);
  if (!graph) return fail(graph.error(), kUsage);
  const auto policy = given_policy(options);
  if (!policy) return fail(policy.error(), kUsage);
  std::vector<BagReport> reports;
  for (const std::string& bag : options.bags) {
    ros2::MessageLibrary library(
        ros2::message_directories(options.message_path, environment("AMENT_PREFIX_PATH")));
    const auto course = bag_doctor::read_course(bag, library);
    if (!course) return fail(course.error());
    BagReport report = report_of(*course, *graph);
    const auto breaches = bag_doctor::breaches(*policy, *course);
    report.findings.insert(report.findings.end(), breaches.begin(), breaches.end());
    reports.push_back(std::move(report));
  }
  print_bags(reports, options);
  return exit_code_of_bags(reports, options.fail_on);
}

}  // namespace culprit::cli
