#include "doctor/doctor_report.h"

#include <algorithm>

#include <fmt/core.h>

#include "doctor/examine.h"
#include "doctor/finding_explanations.h"
#include "doctor/held_up.h"
#include "doctor/wording.h"
#include "json/json.h"

namespace culprit::doctor {
namespace {

Json logical_location(const std::string& name, const char* kind) {
  return {{"fullyQualifiedName", name}, {"kind", kind}};
}

Json sarif_result(const Finding& finding) {
  Json logical = Json::array();
  for (const std::string& node : finding.nodes) logical.push_back(logical_location(node, "node"));
  if (!finding.topic.empty()) logical.push_back(logical_location(finding.topic, "topic"));
  if (logical.empty()) logical.push_back(logical_location(finding.subject, "robot"));
  return {{"ruleId", finding.code},
          {"level", label(finding.gravity)},
          {"message",
           {{"text", finding.subject + ": " + finding.seen + "\n" + finding.matters + "\n" +
                         finding.remedy}}},
          {"locations", Json::array({{{"logicalLocations", std::move(logical)}}})}};
}

void leave_out_doubtful(const Picture& picture, Report& report) {
  const auto doubtful =
      std::stable_partition(report.findings.begin(), report.findings.end(),
                            [](const Finding& each) { return !is_of_absence(each.code); });
  report.doubtful.assign(doubtful, report.findings.end());
  report.findings.erase(doubtful, report.findings.end());
  if (report.doubtful.empty()) return;
  report.left_out.push_back(fmt::format(
      "this look was not good: the machine is so busy that the doctor waited {} of {} for a "
      "processor. {} about missing or late messages {} left out; look again when the machine has "
      "less to do",
      duration(picture.waited), duration(picture.looked),
      count_of(report.doubtful.size(), "finding"), report.doubtful.size() == 1 ? "is" : "are"));
}

}  // namespace

Json to_json(const Finding& finding) {
  Json json{{"code", finding.code},       {"severity", label(finding.gravity)},
            {"who", finding.subject},     {"nodes", finding.nodes},
            {"topic", finding.topic},     {"seen", finding.seen},
            {"matters", finding.matters}, {"remedy", finding.remedy}};
  if (!finding.when) return json;
  json["from_s"] = finding.when->from;
  json["until_s"] = finding.when->until;
  json["clock"] = static_cast<double>(finding.when->clock) / 1e9;
  return json;
}

Report report_of(const Picture& picture, const Baseline* healthy) {
  Report report{picture.domain,   picture.nodes.size(), picture.looked,
                examine(picture), picture.left_out,     {}};
  if (healthy != nullptr && !picture.nodes.empty()) {
    const Findings differences = compare(*healthy, baseline_of(picture));
    report.findings.insert(report.findings.end(), differences.begin(), differences.end());
    put_worst_first(report.findings);
  }
  if (was_held_up(picture)) leave_out_doubtful(picture, report);
  return report;
}

Json to_json(const Report& report) {
  Json findings = Json::array();
  for (const Finding& finding : report.findings) findings.push_back(to_json(finding));
  return {{"domain", report.domain},
          {"nodes", report.nodes},
          {"looked_s", seconds(report.looked)},
          {"findings", std::move(findings)},
          {"left_out", report.left_out}};
}

Json to_sarif(const Report& report) {
  Json rules = Json::array();
  for (const Explanation& each : explanations())
    rules.push_back({{"id", each.code},
                     {"shortDescription", {{"text", each.title}}},
                     {"fullDescription", {{"text", each.why}}},
                     {"help", {{"text", page(each)}}}});
  Json results = Json::array();
  for (const Finding& finding : report.findings) results.push_back(sarif_result(finding));
  Json driver{{"name", "culprit doctor"}, {"rules", std::move(rules)}};
  Json run{{"tool", {{"driver", std::move(driver)}}}, {"results", std::move(results)}};
  return {{"$schema", "https://json.schemastore.org/sarif-2.1.0.json"},
          {"version", "2.1.0"},
          {"runs", Json::array({std::move(run)})}};
}

std::string summary(const Report& report) {
  const auto count = [&](Gravity gravity) {
    return static_cast<std::size_t>(
        std::ranges::count(report.findings, gravity, &Finding::gravity));
  };
  return fmt::format("{} on domain {}: {}", count_of(report.nodes, "node"), report.domain,
                     report.findings.empty() && !report.doubtful.empty()
                         ? "nothing can be said for sure"
                     : report.findings.empty() ? "nothing is wrong that can be seen from outside"
                                               : count_of(count(Gravity::kError), "error") + ", " +
                                                     count_of(count(Gravity::kWarning), "warning"));
}

}  // namespace culprit::doctor
