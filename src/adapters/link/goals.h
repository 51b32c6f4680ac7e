// The goals of an action, as its server reports them, as an observation.
#pragma once

#include <optional>

#include "robot/observation.h"
#include "rtps/cdr.h"

namespace culprit::link {

// Decodes action_msgs/msg/GoalStatusArray: at most the newest 1,000 goals. A status that is not known
// counts as unknown. Empty if the payload is no such message.
std::optional<GoalsSeen> goals_in(TopicId topic, rtps::ByteView payload);

}  // namespace culprit::link
