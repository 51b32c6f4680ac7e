#include "doctor/never_met.h"

#include <string>

#include <gtest/gtest.h>

namespace culprit::doctor {
namespace {

constexpr auto kReader = rtps::EndpointRole::kReader;
constexpr auto kWriter = rtps::EndpointRole::kWriter;

TEST(NeverMet, ALookReadsTopicsAndWritesNone) {
  for (const char* topic :
       {"rt/scan", "rt/tf", "rt/tf_static", "rt/clock", "rt/diagnostics", "rt/robot/odom"}) {
    EXPECT_FALSE(never_meets(topic, kWriter)) << topic;
    EXPECT_TRUE(never_meets(topic, kReader)) << topic;
  }
  for (const char* topic :
       {"rt/rosout", "rt/parameter_events", "rt/lidar/transition_event", "rt/_culprit_hearing"})
    EXPECT_TRUE(never_meets(topic, kWriter)) << topic;
}

TEST(NeverMet, ALookCallsAFewServicesAndServesNone) {
  for (const char* service : {"get_parameters", "get_state", "list_parameters"}) {
    const std::string request = "rq/node/" + std::string(service) + "Request";
    const std::string reply = "rr/node/" + std::string(service) + "Reply";
    EXPECT_FALSE(never_meets(request, kReader));
    EXPECT_FALSE(never_meets(reply, kWriter));
    EXPECT_TRUE(never_meets(request, kWriter));
    EXPECT_TRUE(never_meets(reply, kReader));
  }
  EXPECT_TRUE(never_meets("rq/node/set_parametersRequest", kReader));
  EXPECT_TRUE(never_meets("rr/node/set_parametersReply", kWriter));
}

TEST(NeverMet, WhatIsNotOfRosMayBeMet) {
  for (const char* topic : {"ros_discovery_info", "t", ""}) {
    EXPECT_FALSE(never_meets(topic, kWriter));
    EXPECT_FALSE(never_meets(topic, kReader));
  }
}

}  // namespace
}  // namespace culprit::doctor
