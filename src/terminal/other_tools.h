// Commands and options as other tools call them. Each function gives ours; empty: it is no such word.
#pragma once

#include <string_view>
#include <vector>

namespace culprit {

// "lint" -> "check", "unmute" -> "mute NAME --lift". Only a command of `known`.
std::string_view command_of_other_tools(std::string_view word,
                                        const std::vector<std::string_view>& known);

// "--timeout" -> "--wait". Only an option of `known`.
std::string_view option_of_other_tools(std::string_view option,
                                       const std::vector<std::string_view>& known);

// The advice in place of an option that `command` has in no form: "set ROS_DOMAIN_ID".
std::string_view advice_about(std::string_view option, std::string_view command);

}  // namespace culprit
