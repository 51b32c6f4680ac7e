// Names that a stranger gave: whether ROS 2 takes them, and how to show one that may not be a name.
// Source: design.ros2.org/articles/topic_and_service_names.html.
#pragma once

#include <string>
#include <string_view>

namespace culprit {

// "/a/b_1": absolute, tokens of letters, digits and underscores that do not start with a digit.
bool is_valid_topic_name(std::string_view name);
bool is_valid_node_name(std::string_view name);  // one token
bool is_valid_namespace(std::string_view name);  // "/" or like a topic
bool is_valid_type_name(std::string_view type);  // "package/msg/Type", also srv and action

// Makes text from an untrusted peer safe for a message to people: printable ASCII only, cut at 80
// characters.
std::string printable(std::string_view text);

// A text of a person or of a robot for one line of a message: each character that would steer a terminal or hide what is
// written (C0 and C1 controls, directions of writing) as "\x1b" or "\u202e". All else stays.
std::string escape_controls(std::string_view text);
// The same for a message of several lines: the ends of lines, and tabs, stay.
std::string escape_lines(std::string_view text);

}  // namespace culprit
