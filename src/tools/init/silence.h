// From when on a topic is silent, by how its messages came while the robot was well.
#pragma once

#include <string>

#include "base/expected.h"
#include "init/robot_profile.h"

namespace culprit::init {

// Silence is what is longer; with a node: of what that node publishes there. Errors: why no rhythm can be found.
Expected<Duration> silence_of(const RobotProfile& seen, const std::string& topic,
                              const std::string& node = "");

// Messages in a second, in those that came. @pre silence_of() it is known
double rate_of(const RobotProfile& seen, const std::string& topic, const std::string& node = "");

// The measurements behind it, as comments. @pre likewise
std::string evidence_of_silence(const RobotProfile& seen, const std::string& topic,
                                const std::string& node = "");

}  // namespace culprit::init
