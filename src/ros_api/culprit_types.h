// The types of culprit_msgs, from the files of that package, which are part of the program.
//
//     const CulpritTypes types;
//     const MessageType& status = types.message("culprit_msgs/msg/Status");
//     types.constant("culprit_msgs/msg/Component", "HEALTH_OK");  // 0
//
// Reads everything when it is made, and never changes: from any thread. A requested type must be in
// the package; otherwise the program ends, for its own files list all types.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "ros2/message_definition.h"
#include "ros2/services.h"

namespace culprit::ros_api {

struct MessageType {
  std::string name;                      // "culprit_msgs/msg/Status"
  ros2::MessageDefinitions definitions;  // its own, and those of all types in it
  std::string hash;                      // ros2/type_description.h
};

struct ServiceType {
  std::string
      name;  // "culprit_msgs/srv/Pause", or of an action "culprit_msgs/action/WaitForRecovery_SendGoal"
  MessageType request;
  MessageType response;
  std::string hash;  // of the service as a whole
};

class CulpritTypes {
 public:
  CulpritTypes();

  // Also of "culprit_msgs/srv/Pause_Request" and of the service as a type of its own; of an action
  // "culprit_msgs/action/WaitForRecovery_FeedbackMessage", and what all actions share (action_msgs).
  const MessageType& message(std::string_view name) const;
  const ServiceType& service(std::string_view name) const;
  int constant(std::string_view message, std::string_view name) const;

  // What ~/get_type_description answers.
  ros2::srv::GetTypeDescription::Response described(
      const ros2::srv::GetTypeDescription::Request& request) const;

 private:
  std::map<std::string, MessageType, std::less<>> messages_;
  std::map<std::string, ServiceType, std::less<>> services_;
  std::map<std::string, int, std::less<>> constants_;  // by "type.NAME"
};

}  // namespace culprit::ros_api
