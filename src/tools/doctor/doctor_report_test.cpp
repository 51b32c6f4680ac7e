#include "doctor/doctor_report.h"

#include <filesystem>
#include <fstream>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "doctor/finding_explanations.h"
#include "doctor/held_up.h"
#include "json/json.h"

namespace culprit::doctor {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kReportedType = "sensor_msgs/msg/LaserScan";

// A lidar and who reads it, with all that a baseline keeps.
Picture healthy_robot() {
  Picture picture;
  picture.looked = 8s;
  picture.domain = 7;
  picture.nodes = {{{"/lidar", ros2::Vendor::kFastDds, "", 11},
                    {{EndpointKind::kPublisher, "/scan", kReportedType, {}},
                     {EndpointKind::kServer, "/lidar/reset", "std_srvs/srv/Trigger", {}}}},
                   {{"/slam", ros2::Vendor::kFastDds, "", 12},
                    {{EndpointKind::kSubscriber, "/scan", kReportedType, {}}}},
                   {{"/rviz2", ros2::Vendor::kFastDds, "", 13}, {}}};
  picture.parameters["/lidar"] = {{"rate", "10"}, {"frame", "laser"}};
  picture.lifecycles["/lidar"] = {"active", "active", 4s};
  picture.processes[11].samples = {{0s, {}, 50'000'000}, {8s, {}, 60'000'000}};
  picture.flows["/scan"] = {.listened = 6s, .messages = 61, .first_to_last = 6s};
  picture.transforms = {{"base", "laser", "/state", "0", true, 1, 0s, 0s, 0s}};
  picture.statuses["motor"] = {{0, "motor", "", "", {}}, 8, 0s, 8s};
  return picture;
}

std::vector<std::string> differences(const Picture& now) {
  std::vector<std::string> all;
  for (const Finding& each : compare(baseline_of(healthy_robot()), baseline_of(now)))
    all.push_back(each.code + " " + each.subject + ": " + each.seen);
  return all;
}

TEST(Baseline, FindsNothingInTheSameRobot) {
  EXPECT_THAT(differences(healthy_robot()), IsEmpty());
  Picture tools = healthy_robot();
  tools.nodes.pop_back();
  EXPECT_THAT(differences(tools), IsEmpty()) << "tools come and go";
}

TEST(Baseline, D100AMissingNodeD101ANewOneAndD102WhatANodeLacks) {
  Picture picture = healthy_robot();
  picture.nodes[1].node.name = "/slam_2";
  picture.nodes[0].endpoints.pop_back();
  EXPECT_THAT(differences(picture), ElementsAre("D100 /slam: it was there, and is not",
                                                "D102 /lidar: it no longer serves: /lidar/reset",
                                                "D101 /slam_2: it is there, and was not"));
}

TEST(Baseline, D103ATypeOrAQualityOfServiceThatHasChanged) {
  Picture picture = healthy_robot();
  picture.nodes[0].endpoints[0].qos.reliability = rtps::Reliability::kBestEffort;
  EXPECT_THAT(
      differences(picture),
      ElementsAre("D103 /scan: /lidar: it publishes it as best effort, volatile, and did as "
                  "reliable, volatile"));
}

TEST(Baseline, D104ATopicThatIsSlowerOrSilent) {
  Picture picture = healthy_robot();
  picture.flows["/scan"].messages = 31;
  EXPECT_THAT(differences(picture),
              ElementsAre("D104 /scan: 5 messages a second come, and 10 did"));
  picture.flows["/scan"].messages = 51;
  EXPECT_THAT(differences(picture), IsEmpty()) << "a little";
  picture.flows["/scan"] = {.listened = 6s};
  EXPECT_THAT(differences(picture),
              ElementsAre("D104 /scan: nothing came in 6 s, and 10 messages a second did"));
}

TEST(Baseline, D105ParametersThatDifferAndD106AnotherState) {
  Picture picture = healthy_robot();
  picture.parameters["/lidar"] = {{"rate", "5"}, {"new", "1"}};
  picture.lifecycles["/lidar"].last = "inactive";
  EXPECT_THAT(
      differences(picture),
      ElementsAre("D106 /lidar: it is inactive, and was active",
                  "D105 /lidar: frame is not there, rate is 5, was 10 and new is 1, was not "
                  "there"));
  picture = healthy_robot();
  picture.parameters.clear();
  picture.lifecycles.clear();
  EXPECT_THAT(differences(picture), IsEmpty()) << "it did not answer";
}

TEST(Baseline, D107MoreMemoryD108AMissingTransformAndD109AMissingStatus) {
  Picture picture = healthy_robot();
  picture.processes[11].samples.back().bytes = 500'000'000;
  picture.transforms.clear();
  picture.statuses.clear();
  EXPECT_THAT(differences(picture),
              ElementsAre("D108 tf: base → laser: it was published, and is not",
                          "D107 /lidar: its process has 500 MB of memory, and had 60 MB",
                          "D109 motor: its diagnostic status came, and does not any more"));
}

TEST(Baseline, IsKeptInAFile) {
  const Baseline baseline = baseline_of(healthy_robot());
  const auto again = parse_baseline(to_text(baseline));
  ASSERT_TRUE(again) << again.error();
  EXPECT_EQ(*again, baseline);
}

TEST(Baseline, AFileThatIsNoneIsAnErrorAndNothingElse) {
  for (
      const char* text :
      {"", "{", "[]", "{}", "3", R"({"culprit_healthy": 1})", R"({"culprit_healthy": 2})",
       R"({"culprit_healthy": 1, "nodes": [], "topics": {}, "transforms": {}, "diagnostics": []})",
       R"({"culprit_healthy": 1, "nodes": {"/a": 3}, "topics": {}, "transforms": [], "diagnostics": []})",
       R"({"culprit_healthy": 1, "nodes": {}, "topics": {"/t": {"messages": "many"}}, "transforms": [], "diagnostics": []})"}) {
    const auto baseline = parse_baseline(text);
    ASSERT_FALSE(baseline) << text;
    EXPECT_THAT(baseline.error(), HasSubstr("baseline")) << text;
  }
}

TEST(Report, IsDataForPrograms) {
  Picture picture = healthy_robot();
  picture.nodes[0].endpoints[0].qos.reliability = rtps::Reliability::kBestEffort;
  picture.left_out = {"3 topics were not listened to"};
  const Report report = report_of(picture);
  EXPECT_EQ(summary(report), "3 nodes on domain 7: 1 error, 0 warnings");
  EXPECT_EQ(
      to_line(to_json(report)),
      R"({"domain":7,"nodes":3,"looked_s":8.0,"findings":[{"code":"D001",)"
      R"("severity":"error","who":"/scan: /lidar → /slam","nodes":["/lidar","/slam"],"topic":"/scan",)"
      R"("seen":"reliability: offered is best effort, requested is reliable",)"
      R"("matters":"/slam receives nothing from /lidar",)"
      R"("remedy":"let /lidar offer reliable, or /slam request best effort"}],)"
      R"("left_out":["3 topics were not listened to"]})");
  const auto sarif = to_sarif(report);
  const auto& run = sarif["runs"][0];
  EXPECT_EQ(run["tool"]["driver"]["rules"].size(), explanations().size());
  EXPECT_EQ(run["results"][0]["ruleId"], "D001");
  EXPECT_EQ(run["results"][0]["level"], "error");
  EXPECT_EQ(run["results"][0]["locations"][0]["logicalLocations"][0]["fullyQualifiedName"],
            "/lidar");

  const Baseline healthy = baseline_of(healthy_robot());
  std::vector<std::string> codes;
  for (const Finding& each : report_of(picture, &healthy).findings) codes.push_back(each.code);
  EXPECT_THAT(codes, ElementsAre("D001", "D103")) << "the worst first";
}

TEST(FindingExplanations, ThereIsOneForEachCodeInOrder) {
  std::string last;
  for (const Explanation& each : explanations()) {
    EXPECT_LT(last, each.code);
    EXPECT_TRUE(std::regex_match(each.code, std::regex("D\\d\\d\\d"))) << each.code;
    EXPECT_FALSE(each.title.empty() || each.why.empty() || each.found.empty() ||
                 each.remedy.empty())
        << each.code;
    EXPECT_FALSE(each.title.ends_with('.')) << each.code;
    last = each.code;
  }
  // Each code that the sources name.
  std::set<std::string> named;
  std::vector<std::filesystem::path> files;
  for (const char* file :
       {"connections", "nodes", "processes", "reach", "flows", "transforms", "disks", "baseline"})
    files.push_back(std::string("src/tools/doctor/") + file + ".cpp");
  for (const auto& each : std::filesystem::directory_iterator("src/tools/bag_doctor")) {
    const std::string name = each.path().filename();
    if (name.ends_with(".cpp") && !name.ends_with("_test.cpp")) files.push_back(each.path());
  }
  for (const auto& file : files) {
    std::ifstream in(file);
    const std::string text(std::istreambuf_iterator<char>(in), {});
    const std::regex code("\"(D\\d\\d\\d)\"");
    for (std::sregex_iterator i(text.begin(), text.end(), code), end; i != end; ++i)
      named.insert((*i)[1]);
  }
  std::set<std::string> explained;
  for (const Explanation& each : explanations()) explained.insert(each.code);
  EXPECT_EQ(named, explained);
}

TEST(FindingExplanations, AreFoundByTheirCode) {
  ASSERT_NE(find_explanation("D012"), nullptr);
  EXPECT_EQ(find_explanation("d012"), find_explanation("D012"));
  for (const char* none : {"", "D", "D999", "R012", "12", "D0123"})
    EXPECT_EQ(find_explanation(none), nullptr) << none;
  EXPECT_THAT(page(*find_explanation("D012")), HasSubstr("D012: a node does not answer\n\n"));
}

TEST(FindingExplanations, TheTableOfTheirPageNamesThem) {
  std::string table = "| code | meaning |\n| --- | --- |\n";
  for (const Explanation& e : explanations())
    table += "| [" + e.code + "](#d" + e.code.substr(1) + ") | " + e.title + " |\n";
  EXPECT_NE(findings_page().find(table), std::string_view::npos) << table;
}

// ---- a doctor that was held up

TEST(HeldUp, IsTheThreadThatWaitedLongest) {
  EXPECT_EQ(wait_in("527039317 2715090050 1885\n"), 2715090050ns);
  for (const char* text : {"", "x", "12", "12 -1 3", "99999999999999999999 1 1"})
    EXPECT_FALSE(wait_in(text)) << text;
  EXPECT_EQ(longest_wait({{1, 5s}, {2, 1s}}, {{1, 6s}, {2, 4s}, {3, 2s}}), 3s);
  EXPECT_EQ(longest_wait({{1, 5s}}, {}), 0s);
  EXPECT_FALSE(waits_of_own_threads().empty());
}

TEST(HeldUp, ADoctorDoesNotTellWhatItMayOnlyHaveMissed) {
  Picture picture;  // nobody is there: D030
  picture.looked = 8s;
  picture.disks = {{"/", "the logs of /a", 100'000'000'000, 10'000'000, 0}};  // D060
  picture.waited = 2s;
  const Report good = report_of(picture);
  ASSERT_EQ(good.findings.size(), 2u);
  EXPECT_TRUE(good.left_out.empty());
  picture.waited = 2001ms;
  const Report busy = report_of(picture);
  ASSERT_EQ(busy.findings.size(), 1u);
  EXPECT_EQ(busy.findings[0].code, "D060") << "that it has seen";
  ASSERT_EQ(busy.doubtful.size(), 1u);
  EXPECT_EQ(busy.doubtful[0].code, "D030");
  ASSERT_EQ(busy.left_out.size(), 1u);
  EXPECT_THAT(busy.left_out[0],
              testing::StartsWith("this look was not good: the machine is so busy"));
  picture.disks.clear();
  EXPECT_THAT(summary(report_of(picture)), testing::HasSubstr("nothing can be said for sure"));
}

TEST(HeldUp, AnHealthyRobotThatWasHeardAllTheSameIsHealthy) {
  Picture picture;
  picture.looked = 8s;
  picture.waited = 7s;
  picture.nodes.push_back({{"/a", ros2::Vendor::kFastDds, "", 1}, {}});
  const Report report = report_of(picture);
  EXPECT_TRUE(report.findings.empty());
  EXPECT_TRUE(report.left_out.empty());
  EXPECT_THAT(summary(report),
              testing::HasSubstr("nothing is wrong that can be seen from outside"));
}

}  // namespace
}  // namespace culprit::doctor
