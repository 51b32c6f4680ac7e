// Facts about standard message types: which begin with a header, and which sensors publish.
#pragma once

#include <string>

namespace culprit::doctor {

// The first thing in it is a std_msgs/Header.
bool is_stamped_type(const std::string& type);

// Its publishers publish it all the time.
bool is_sensor_type(const std::string& type);

}  // namespace culprit::doctor
