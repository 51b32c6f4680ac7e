// The rights of whole rule files are golden files; that culprit gets along with them on a secured
// domain, and with nothing less, is shown by cli/secured_live_test.cpp.
#include "link/rights.h"

#include <cstdlib>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit::link {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsSupersetOf;
using testing::Not;

const ros2::NodeName kSelf{"/", "culprit"};

RuleSet rules_of(const std::string& text) {
  Checked checked = check(Source("test.rules", text));
  if (!checked.rules) throw std::runtime_error("bad rules: " + text);
  return std::move(*checked.rules);
}

Rights rights_with(const std::string& trigger, const std::string& adaptation) {
  return rights_of(
      rules_of("COMPONENT c NODE /robot/c LAUNCH \"c\"\nRULE r\n  POLICIES ERROR\n"
               "  TRIGGER " +
               trigger + "\n    STRATEGY s 50 10\n      ADAPTATION c " + adaptation + "\n"),
      kSelf);
}

std::string content_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(file), {});
}

// CULPRIT_WRITE_GOLDEN=1 writes what it is now, for a person to read and commit.
void expect_golden(const std::string& path, const std::string& text) {
  if (std::getenv("CULPRIT_WRITE_GOLDEN") != nullptr) std::ofstream(path, std::ios::binary) << text;
  EXPECT_EQ(text, content_of(path)) << path;
}

TEST(Policy, IsGoldenForTheRobotsOfTheExamples) {
  for (const std::string robot : {"sunset", "suave"}) {
    const auto source = Source::read("rules/" + robot + ".rules");
    ASSERT_TRUE(source) << source.error();
    const RuleSet rules = *check(*source).rules;
    const Rights rights = rights_of(rules, kSelf);
    const std::string golden = "src/adapters/link/golden/" + robot;
    expect_golden(golden + ".policy.xml", sros2_policy(rights, kSelf, "/culprit"));
    expect_golden(
        golden + ".permissions.xml",
        permissions(rights, "/culprit", 7, {"2026-01-01T00:00:00", "2036-01-01T00:00:00"}));
  }
}

TEST(Policy, AllowsNothingThatTheRulesDoNotNeed) {
  const Rights rights = rights_with("!alive(c)", "stop 1");
  EXPECT_THAT(rights.calls, ElementsAre("/robot/c/get_parameters", "/robot/c/get_state"));
  EXPECT_THAT(rights.subscribes,
              ElementsAre("/_culprit_hearing", "/_culprit_lease", "/robot/c/transition_event"));
}

TEST(Policy, AllowsToHearWhatTriggersRead) {
  EXPECT_THAT(rights_with("age(/image) > 1s", "stop 1").subscribes, Contains("/image"));
  EXPECT_THAT(rights_with("level(battery) > 1", "stop 1").subscribes, Contains("/diagnostics"));
  EXPECT_THAT(rights_with("parameter(c, gain) > 1", "stop 1").subscribes,
              Contains("/parameter_events"));
}

TEST(Policy, AllowsWhatEachAdaptationAsksFor) {
  const auto calls = [](const std::string& adaptation) {
    return rights_with("!alive(c)", adaptation).calls;
  };
  for (const char* adaptation :
       {"activate 1", "deactivate 1", "restart 1", "redeploy 1", "start 1"})
    EXPECT_THAT(calls(adaptation), Contains("/robot/c/change_state")) << adaptation;
  for (const char* adaptation : {"set_parameter gain 0.5 1", "increase_parameter gain 0.5 1",
                                 "decrease_parameter gain 0.5 1", "change_communication in rgb 1"})
    EXPECT_THAT(calls(adaptation), Contains("/robot/c/set_parameters")) << adaptation;
  EXPECT_THAT(calls("change_mode SLOW 1"),
              IsSupersetOf({"/robot/c/change_mode", "/robot/c/get_mode"}));
  EXPECT_THAT(calls("call ~/recalibrate 1"), Contains("/robot/c/recalibrate"));
  EXPECT_THAT(calls("call /global/reset 1"), Contains("/global/reset"));
}

TEST(Policy, ANodeWithoutItsNamespaceMayBeInAny) {
  const Rights rights = rights_of(rules_of("COMPONENT c\n"), kSelf);
  EXPECT_THAT(rights.calls, IsSupersetOf({"/c/get_state", "/*/c/get_state"}));
}

TEST(Policy, NamesOnDdsAreThoseOfRos) {
  const std::string xml = permissions(rights_with("age(/image) > 1s", "restart 1"), "/culprit", 3,
                                      {"2026-01-01T00:00:00", "2036-01-01T00:00:00"});
  const std::size_t subscribe = xml.find("<subscribe>");
  const std::string publishes = xml.substr(0, subscribe);
  const std::string subscribes = xml.substr(subscribe);
  for (const char* name : {"rq/robot/c/change_stateRequest", "rt/rosout", "ros_discovery_info",
                           "rr/culprit/get_parametersReply", "rt/_culprit_lease"})
    EXPECT_THAT(publishes, HasSubstr("<topic>" + std::string(name) + "</topic>"));
  for (const char* name : {"rr/robot/c/change_stateReply", "rt/image", "ros_discovery_info",
                           "rq/culprit/get_parametersRequest"})
    EXPECT_THAT(subscribes, HasSubstr("<topic>" + std::string(name) + "</topic>"));
  EXPECT_THAT(publishes, Not(HasSubstr("rt/image")));
}

}  // namespace
}  // namespace culprit::link
