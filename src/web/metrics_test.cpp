// The metrics that monitoring systems read while culprit heals a robot.
#include "web/metrics.h"

#include <fstream>
#include <regex>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "manager/test_robot.h"
#include "web/calls.h"

namespace culprit::web {
namespace {

using culprit::test::TestRobot;
using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr const char* kMetricsRules = R"(
ROBOT test
COMPONENT camera NODE /camera LAUNCH "camera"
RULE CameraSilent
  POLICIES ERROR
  TRIGGER age(/rgb) > 300ms
    STRATEGY redeploy 90 10
      ADAPTATION camera redeploy 10
)";

// A robot whose manager is counted.
struct Counted : testing::Test {
  Counted() {
    robot.add("camera", {}, "/rgb");
    metrics.watch(robot.manager());
    robot.before_commands = [this](auto& observations, auto) {
      metrics.stepped(3ms, observations.size(), robot.manager());
      return true;
    };
  }
  http::Answer ask(http::Hub& hub, std::size_t route) const {
    return status_routes(hub, metrics, 20ms)[route].answer(nullptr);
  }

  TestRobot robot{kMetricsRules};
  Metrics metrics;
};

TEST_F(Counted, TellsOfFailuresStrategiesAndHealth) {
  EXPECT_THAT(metrics.text(), HasSubstr("culprit_failures_detected_total{rule=\"CameraSilent\","
                                        "criticality=\"ERROR\"} 0\n"))
      << "a rate needs a beginning";
  robot.discover(6s);
  EXPECT_THAT(metrics.text(), HasSubstr("culprit_components{health=\"OK\"} 1\n"));
  robot.kill("camera");
  for (int i = 0; i < 100 && robot.manager().knowledge().states.active().empty(); ++i)
    robot.run_for(10ms);
  EXPECT_THAT(metrics.text(), HasSubstr("culprit_components{health=\"ERROR\"} 1\n"));
  EXPECT_THAT(metrics.text(), HasSubstr("culprit_failures_open{criticality=\"ERROR\"} 1\n"));
  robot.run_for(20s);
  const std::string text = metrics.text();
  for (const char* line :
       {"culprit_failures_detected_total{rule=\"CameraSilent\",criticality=\"ERROR\"} 1\n",
        "culprit_failures_resolved_total{rule=\"CameraSilent\",criticality=\"ERROR\"} 1\n",
        "culprit_strategies_total{rule=\"CameraSilent\",strategy=\"redeploy\","
        "outcome=\"resolved\"} 1\n",
        "culprit_plans_total{result=\"chosen\"} 1\n",
        "culprit_failures_open{criticality=\"ERROR\"} 0\n",
        "culprit_governor_holds_total{restraint=\"paused\"} 0\n"})
    EXPECT_THAT(text, HasSubstr(line));
}

TEST_F(Counted, TellsWhichRulesAreBlind) {
  constexpr const char* kLine = "culprit_rule_blind{rule=\"CameraSilent\",criticality=\"ERROR\"} ";
  EXPECT_THAT(metrics.text(), HasSubstr(kLine + std::string("0\n")));
  robot["camera"].process = ProcessState::kGone;
  robot.run_for(60s);
  EXPECT_THAT(metrics.text(), HasSubstr(kLine + std::string("1\n"))) << "nobody publishes /rgb";
}

// The rules of the format that promtool checks.
TEST_F(Counted, IsInPrometheusTextFormat) {
  robot.discover();
  std::istringstream text(metrics.text());
  std::string family;
  std::set<std::string> families;
  for (std::string line; std::getline(text, line);) {
    if (line.rfind("# HELP ", 0) == 0) {
      family = line.substr(7, line.find(' ', 7) - 7);
      EXPECT_TRUE(families.insert(family).second) << family << " is told twice";
    } else if (line.rfind("# ", 0) == 0) {
      EXPECT_EQ(line.rfind("# TYPE " + family + " ", 0), 0u) << line;
    } else {
      EXPECT_EQ(line.rfind(family, 0), 0u) << line << " stands under " << family;
      EXPECT_THAT(line, testing::MatchesRegex("[a-z_]+(\\{[a-z_]+=\".*\"\\})? [-+.e0-9]+"));
    }
  }
  EXPECT_TRUE(families.contains("process_resident_memory_bytes"));
  EXPECT_TRUE(families.contains("process_start_time_seconds"));
}

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

// The metrics that packaging/monitoring queries exist, under these names and with these labels.
TEST_F(Counted, AreWhatTheDashboardAndTheAlertsAskFor) {
  const std::string told = metrics.text();
  for (const char* file : {"culprit-alerts.yaml", "grafana.json"}) {
    const std::string asked = text_of(std::string("packaging/monitoring/") + file);
    const std::regex name("\\b(culprit|process)_[a-z_]+\\b");
    std::size_t count = 0;
    for (std::sregex_iterator i(asked.begin(), asked.end(), name), end; i != end; ++i, ++count) {
      const bool is_told = told.find("\n" + i->str() + "{") != std::string::npos ||
                           told.find("\n" + i->str() + " ") != std::string::npos;
      EXPECT_TRUE(is_told) << file << " asks for " << i->str();
    }
    EXPECT_GT(count, 10u) << file;
    const std::regex labels("\\bby \\(([a-z, ]+)\\)");
    for (std::sregex_iterator i(asked.begin(), asked.end(), labels), end; i != end; ++i) {
      std::istringstream list((*i)[1]);
      for (std::string each; list >> each;) {
        if (each.back() == ',') each.pop_back();
        const bool is_of_prometheus = each == "job" || each == "instance";
        EXPECT_TRUE(is_of_prometheus || told.find(each + "=\"") != std::string::npos) << each;
      }
    }
  }
}

TEST_F(Counted, TellsWhetherTheRobotIsHeard) {
  robot.discover();
  EXPECT_THAT(metrics.text(), HasSubstr("culprit_hears 1\n"));
  robot.tell(HearingLost{"nothing comes back"}, 1s);
  EXPECT_THAT(metrics.text(), HasSubstr("culprit_hears 0\n"));
}

TEST_F(Counted, TellsOfDatagramsThatWereDroppedInAllSessions) {
  EXPECT_THAT(metrics.text(), HasSubstr("culprit_foreign_datagrams_total 0\n"));
  std::uint64_t dropped = 3;
  metrics.count_dropped([&] { return dropped; });
  EXPECT_THAT(metrics.text(), HasSubstr("culprit_foreign_datagrams_total 3\n"));
  metrics.count_dropped({});
  dropped = 2;
  metrics.count_dropped([&] { return dropped; });
  EXPECT_THAT(metrics.text(), HasSubstr("culprit_foreign_datagrams_total 5\n"));
}

TEST_F(Counted, HasEachStepInOneBucketAndInAllAbove) {
  robot.discover();
  const std::string steps = std::to_string(metrics.steps());
  EXPECT_THAT(metrics.text(), HasSubstr("culprit_step_seconds_bucket{le=\"0.0025\"} 0\n"));
  EXPECT_THAT(metrics.text(), HasSubstr("{le=\"0.005\"} " + steps + "\n"));
  EXPECT_THAT(metrics.text(), HasSubstr("{le=\"+Inf\"} " + steps + "\n"));
  EXPECT_THAT(metrics.text(), HasSubstr("culprit_step_seconds_count " + steps + "\n"));
}

TEST_F(Counted, IsAliveAsLongAsTheLoopComesRoundWhenAskedTo) {
  http::Hub hanging([] {});
  EXPECT_EQ(ask(hanging, 0).status, 503);
  EXPECT_EQ(ask(hanging, 1).status, 503);
  http::Hub hub([this] { metrics.stepped(1ms, 0, robot.manager()); });
  EXPECT_EQ(ask(hub, 0).status, 200);
  EXPECT_EQ(ask(hub, 1).status, 503) << "the robot did not have its time yet";
  robot.discover(10s);
  EXPECT_EQ(ask(hub, 1).status, 200);
  robot.tell(HearingLost{"nothing comes back"});
  EXPECT_EQ(ask(hub, 0).status, 503);
  EXPECT_EQ(ask(hub, 1).status, 503);
  robot.tell(HearingRegained{});
  EXPECT_EQ(ask(hub, 0).status, 200);
}

}  // namespace
}  // namespace culprit::web
