// The same faults are the same incidents, with the same ids in the same order, wherever people and programs look: live
// and from the journal.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_expected.h"
#include "base/test_folder.h"
#include "cli/status_report.h"
#include "incident_reports/incident_report.h"
#include "incident_reports/journal_incidents.h"
#include "journal/event_json.h"
#include "journal/session.h"
#include "journal/writer.h"
#include "live/alerting.h"
#include "manager/test_robot.h"
#include "ros_api/teller.h"
#include "terminal/console.h"
#include "web/calls.h"
#include "web/hub_observer.h"
#if __has_include("fleet/tally.h")
#include "fleet/incident_number.h"
#include "fleet/tally.h"
#endif

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using culprit::test::TestFolder;
using culprit::test::TestRobot;
using culprit::test::value_of;
using testing::ElementsAreArray;
using testing::HasSubstr;
using testing::SizeIs;
using testing::UnorderedElementsAreArray;
using Ids = std::vector<std::string>;

constexpr const char* kTwoFaults = R"(
ROBOT rover
COMPONENT camera       NODE /camera       LAUNCH "camera"
COMPONENT fusion       NODE /fusion       LAUNCH "fusion"
COMPONENT segmentation NODE /segmentation LAUNCH "segmentation"
RULE SegmentationDead
  POLICIES WARNING
  TRIGGER alive(segmentation) == false
    STRATEGY redeploy_segmentation 90 10
      ADAPTATION segmentation redeploy 20
RULE FusionSilent
  POLICIES WARNING
  TRIGGER age(/fused) > 300ms
    STRATEGY restart_fusion 90 10
      ADAPTATION fusion restart 10
RULE CameraDead
  POLICIES ERROR
  TRIGGER alive(camera) == false
    STRATEGY redeploy_camera 90 10
      ADAPTATION camera redeploy 20
)";
constexpr std::int64_t kWallAtZero = 1'800'000'000'000'000'000;  // ns since 1970

// A paused culprit watches while the camera dies, what needs it suffers, and segmentation dies.
class TwoFaults {
 public:
  TwoFaults() {
    Manager::Options options;
    options.incidents = {kWallAtZero, "a robot"};
    robot_.emplace(kTwoFaults, std::make_unique<BayesPlanner>(), options);
    robot_->add("camera", {}, "/rgb");
    robot_->add("fusion", {"camera"}, "/fused");
    robot_->add("segmentation", {}, "/segments");
    journal::Session session;
    session.rules_path = "two.rules";
    session.rules_text = kTwoFaults;
    session.planner = Json::object();
    session.wall = kWallAtZero;
    write(journal::kind::kSession, to_line(journal::to_json(session)));
    for (live::Observer* each : observers()) each->begins(robot_->manager(), {}, Time());
    robot_->before_commands = [this](std::vector<Observation>& observations,
                                     std::span<const Command> commands) {
      const auto events = robot_->manager().events();
      for (live::Observer* each : observers())
        each->stepped({robot_->now, {}, observations, commands, events});
      for (const Event& event : events)
        write(journal::kind::kEvent, journal::line_of(event, robot_->rules()));
      return true;
    };
    robot_->discover(8s);
    robot_->order({1, "ada", "", Pause{}});
    robot_->kill("camera", 5s);
    robot_->kill("segmentation", 40s);
  }

  Ids of_manager() const {
    Ids ids;
    for (const Incident& each : robot_->manager().incidents().open()) ids.push_back(each.id);
    return ids;
  }
  std::vector<std::string> headlines() const {
    std::vector<std::string> all;
    for (const Incident& each : robot_->manager().incidents().open()) all.push_back(each.headline);
    return all;
  }
  // The data of `status`, `top` and the page.
  WhatCulpritSays said() const {
    WhatCulpritSays said;
    said.robot = parse_json(*hub_.latest(http::Kind::kRobot));
    said.state = parse_json(*hub_.latest(http::Kind::kState));
    said.control = parse_json(*hub_.latest(http::Kind::kControl));
    return said;
  }
  Json asked(const std::filesystem::path& journal) {
    for (const http::Route& route : web::incident_routes(hub_, journal, {})) {
      if (route.path == "/api/incidents") return route.answer({{"since", "0"}}).body["incidents"];
    }
    return nullptr;
  }
  journal::Reader reader() const { return value_of(journal::Reader::open(path_)); }
  const std::filesystem::path& journal() {
    auto writer = value_of(journal::Writer::open(path_, {}));
    EXPECT_TRUE(
        writer.append(std::exchange(rows_, {}), kWallAtZero, journal::Durability::kProcessEnd));
    return path_;
  }

  std::vector<alerts::Alert> posted;
  std::vector<Json> messages;  // of /culprit/incidents
  Json status;                 // the last of /culprit/status

 private:
  std::vector<live::Observer*> observers() { return {&page_, &alerting_, &teller_}; }
  std::int64_t wall() const { return kWallAtZero + robot_->now.time_since_epoch().count(); }
  void write(std::string_view kind, std::string body) {
    rows_.entries.push_back({0, wall(), std::string(kind), std::move(body)});
  }

  const TestFolder folder_;
  const std::filesystem::path path_ = folder_ / "a.journal";
  journal::Batch rows_;
  mutable std::optional<TestRobot> robot_;
  http::Hub hub_;
  const http::Hub::Reader watching_{hub_};
  web::Metrics metrics_;
  web::HubObserver page_{hub_, metrics_, [this] { return 1e-9 * static_cast<double>(wall()); }};
  live::Alerting alerting_{{},
                           [this](const alerts::Alert& alert) { posted.push_back(alert); },
                           [this] { return 1e-9 * static_cast<double>(wall()); }};
  const ros_api::CulpritTypes types_;
  ros_api::Teller teller_{types_, "1.2.3",
                          [this](ros_api::Topic topic, const Json& message) {
                            if (topic == ros_api::Topic::kStatus) status = message;
                            if (topic == ros_api::Topic::kIncidents) messages.push_back(message);
                          },
                          [this] { return ros_api::WallTime(std::chrono::nanoseconds(wall())); }};
};

Ids ids_in(const Json& list) {
  Ids ids;
  for (const Json& each : list) ids.push_back(each["id"].get<std::string>());
  return ids;
}

TEST(OneIncident, IsTheSameInAllPlaces) {
  TwoFaults two;
  const Ids ids = two.of_manager();
  ASSERT_THAT(two.headlines(), testing::ElementsAre("camera is down", "segmentation is down"));

  EXPECT_THAT(ids_in(two.said().state["incidents"]), ElementsAreArray(ids)) << "the page";
  std::vector<std::string> lines;
  for (const std::string& line : situation_lines(two.said(), Colour::kOff)) {
    if (line.starts_with("  ") && line.find(" is down  (") != std::string::npos)
      lines.push_back(line);
  }
  ASSERT_THAT(lines, SizeIs(2)) << "culprit status and culprit top";
  EXPECT_THAT(lines[0], HasSubstr("camera"));
  EXPECT_THAT(lines[1], HasSubstr("segmentation"));

  Ids alerted;
  for (const alerts::Alert& each : two.posted) {
    if (each.headline.find("is down") != std::string::npos) alerted.push_back(each.id);
  }
  EXPECT_THAT(alerted, ElementsAreArray(ids)) << "alerts, in the order in which they became due";

  EXPECT_THAT(ids_in(two.status["incidents"]), ElementsAreArray(ids)) << "/culprit/status";
  std::set<std::string> told;
  for (const Json& each : two.messages) told.insert(each["id"].get<std::string>());
  EXPECT_THAT(told, UnorderedElementsAreArray(ids)) << "/culprit/incidents";

  EXPECT_THAT(ids_in(two.asked({})), ElementsAreArray(ids)) << "the page without a journal";
  EXPECT_THAT(ids_in(two.asked(two.journal())), ElementsAreArray(ids)) << "the page's history";
  const journal::Reader journal = two.reader();
  const auto found = value_of(incident_reports::incidents_of(journal, 0)).incidents;
  Ids read;
  for (const incident_reports::Incident& each : found) read.push_back(each.id);
  EXPECT_THAT(read, ElementsAreArray(ids)) << "culprit incident";
  EXPECT_THAT(found.at(0).causes, testing::ElementsAre("camera"));
  EXPECT_THAT(found.at(0).consequences, testing::ElementsAre("FusionSilent"));
  EXPECT_THAT(found.at(1).causes, testing::ElementsAre("segmentation"));
  for (const std::string& id : alerted) {
    EXPECT_TRUE(value_of(incident_reports::report_of(journal, id, "/nowhere", 2e9)))
        << "culprit incident " << id << ", as an alert calls it";
  }

#if __has_include("fleet/tally.h")
  fleet::Tally tally;
  auto rows = value_of(journal.entries(journal::Which::kReadable));
  journal::Entry entry;
  while (*rows.next(entry)) tally.take(entry, rows.hash());
  std::set<std::string> counted;
  for (const fleet::Failure& each : tally.take_failures())
    counted.insert(fleet::incident_id(each.incident));
  EXPECT_THAT(counted, UnorderedElementsAreArray(ids)) << "culprit fleet incidents";
#endif
}

}  // namespace
}  // namespace culprit::cli
