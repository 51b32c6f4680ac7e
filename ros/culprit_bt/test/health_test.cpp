// The reports of culprit that count as healthy, without middleware.
#include "culprit_bt/health.h"

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "behaviortree_cpp/exceptions.h"

namespace culprit_bt {
namespace {

using culprit_msgs::msg::Component;
using culprit_msgs::msg::Incident;
using culprit_msgs::msg::Status;

Component component(const std::string& name) {
  Component component;
  component.name = name;
  component.is_present = true;
  component.process = Component::PROCESS_RUNNING;
  return component;
}

culprit_msgs::msg::Incident incident(const std::string& headline,
                                     std::vector<std::string> components,
                                     std::uint8_t health = Component::HEALTH_ERROR) {
  culprit_msgs::msg::Incident incident;
  incident.headline = headline;
  incident.doing = "restart it";
  incident.components = std::move(components);
  incident.health = health;
  return incident;
}

Status robot() {
  Status status;
  status.hears = true;
  status.summary = "all is well";
  status.components = {component("camera"), component("base")};
  return status;
}

Knowledge known(const Status& status) { return {std::make_shared<Status>(status), "", 1}; }

constexpr std::uint8_t kNothing = Component::HEALTH_OK;

TEST(Health, IsWellWhereNothingIsWrong) {
  EXPECT_EQ(health_of(known(robot()), "camera", kNothing).outlook, Outlook::kWell);
  EXPECT_EQ(health_of(known(robot()), "", kNothing).outlook, Outlook::kWell);
  EXPECT_EQ(health_of(known(robot()), "camera", kNothing).reason, "");
}

TEST(Health, IsUnknownWhileNothingWasHeardOfCulprit) {
  const Health health = health_of({nullptr, "culprit is not reachable", 0}, "camera", kNothing);
  EXPECT_EQ(health.outlook, Outlook::kUnknown);
  EXPECT_EQ(health.reason, "culprit is not reachable");
}

TEST(Health, IsUnknownWhileCulpritCannotHearTheRobot) {
  Status status = robot();
  status.hears = false;
  EXPECT_EQ(health_of(known(status), "camera", kNothing).outlook, Outlook::kUnknown);
  EXPECT_EQ(health_of(known(status), "", kNothing).outlook, Outlook::kUnknown);
}

TEST(Health, OfANameThatIsMistypedSaysTheOneThatWasMeant) {
  const Health health = health_of(known(robot()), "camra", kNothing);
  EXPECT_EQ(health.outlook, Outlook::kNoSuchComponent);
  EXPECT_EQ(health.reason, "culprit's rules have no component 'camra'; did you mean 'camera'?");
  EXPECT_EQ(health_of(known(robot()), "elevator", kNothing).reason,
            "culprit's rules have no component 'elevator'");
}

TEST(Health, IsIllForEachThingThatTheActionWaitsFor) {
  const auto ill = [](auto change) {
    Status status = robot();
    change(status.components[0]);
    return health_of(known(status), "camera", kNothing);
  };
  EXPECT_EQ(ill([](Component& c) { c.health = Component::HEALTH_NON_CRITICAL; }).reason,
            "a rule that fails touches camera");
  EXPECT_EQ(ill([](Component& c) { c.is_present = false; }).reason,
            "the node of camera is not there");
  EXPECT_EQ(ill([](Component& c) { c.process = Component::PROCESS_STOPPED; }).reason,
            "the process of camera is stopped");
  EXPECT_EQ(ill([](Component& c) { c.process = Component::PROCESS_HUNG; }).reason, "camera hangs");
  EXPECT_EQ(ill([](Component& c) { c.process = Component::PROCESS_GONE; }).reason,
            "the process of camera has ended");
  EXPECT_EQ(ill([](Component& c) { c.adapting = "redeploy"; }).reason,
            "camera is changed by strategy redeploy");
  EXPECT_EQ(ill([](Component& c) { c.process = Component::PROCESS_UNKNOWN; }).outlook,
            Outlook::kWell);
}

TEST(Health, OfOneComponentIsNotThatOfAnother) {
  Status status = robot();
  status.health = Component::HEALTH_ERROR;
  status.components[0].health = Component::HEALTH_ERROR;
  EXPECT_EQ(health_of(known(status), "base", kNothing).outlook, Outlook::kWell);
  EXPECT_EQ(health_of(known(status), "", kNothing).outlook, Outlook::kIll);
}

TEST(Health, OfTheRobotIsIllForAnIncidentThatIsAtNoComponent) {
  Status status = robot();
  status.health = Component::HEALTH_WARNING;
  status.incidents = {incident("it is too dark", {}, Component::HEALTH_WARNING)};
  EXPECT_EQ(health_of(known(status), "", kNothing).reason, "it is too dark: restart it");
}

TEST(Health, ToleratesHowIllSomethingIsAndNothingElse) {
  const std::uint8_t warning = tolerated("WARNING");
  Status status = robot();
  status.health = Component::HEALTH_WARNING;
  status.components[0].health = Component::HEALTH_WARNING;
  EXPECT_EQ(health_of(known(status), "camera", warning).outlook, Outlook::kWell);
  EXPECT_EQ(health_of(known(status), "", warning).outlook, Outlook::kWell);
  status.components[0].adapting = "redeploy";
  EXPECT_EQ(health_of(known(status), "camera", warning).outlook, Outlook::kIll);
  status.components[0].adapting.clear();
  status.components[0].health = Component::HEALTH_ERROR;
  EXPECT_EQ(health_of(known(status), "camera", warning).outlook, Outlook::kIll);
}

TEST(Health, RefusesAWordThatItDoesNotKnow) {
  EXPECT_THROW(tolerated("ERROR"), BT::RuntimeError);
  EXPECT_THROW(tolerated("warning"), BT::RuntimeError);
}

TEST(Incidents, AreAtAComponentThatIsSuspected) {
  Status status = robot();
  status.incidents = {incident("pictures are silent", {"camera"})};
  EXPECT_EQ(health_of(known(status), "camera", kNothing).outlook, Outlook::kWell);
  EXPECT_EQ(incident_at(known(status), "camera", kNothing).reason,
            "pictures are silent: restart it");
  EXPECT_EQ(incident_at(known(status), "base", kNothing).outlook, Outlook::kWell);
}

TEST(Incidents, ThatAreOverOrToleratedAreNone) {
  Status status = robot();
  status.incidents = {incident("pictures are silent", {"camera"})};
  status.incidents[0].state = Incident::STATE_RESOLVED;
  EXPECT_EQ(incident_at(known(status), "camera", kNothing).outlook, Outlook::kWell);
  status.incidents[0].state = Incident::STATE_OPEN;
  status.incidents[0].health = Component::HEALTH_WARNING;
  EXPECT_EQ(incident_at(known(status), "camera", tolerated("WARNING")).outlook, Outlook::kWell);
}

}  // namespace
}  // namespace culprit_bt
