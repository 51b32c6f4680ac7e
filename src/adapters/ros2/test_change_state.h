// Changes the state of a node of a live test, as a manager does.
#pragma once

#include <cstdint>
#include <memory>

#include <gtest/gtest.h>

#include "ros2/live_test.h"
#include "ros2/service_client.h"
#include "ros2/services.h"

namespace culprit::ros2 {

// Whether the node did what the transition `id` asks for.
inline bool change(ServiceClient& client, std::uint8_t id) {
  const auto answers =
      std::make_shared<rtps::EventLog<bool>>();  // the callback may come after a failed wait
  client.call(rtps::encode(srv::ChangeState::Request{{id, ""}}), Repeat::kNever, rtps::kPatience,
              [answers](const CallResult& result) {
                EXPECT_EQ(result.outcome, CallOutcome::kAnswered);
                const auto response = rtps::decode<srv::ChangeState::Response>(result.reply);
                answers->add(response && response->success);
              });
  return answers->wait_for_count(1) && answers->all().front();
}

}  // namespace culprit::ros2
