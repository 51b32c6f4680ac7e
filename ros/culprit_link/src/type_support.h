// The type supports of a robot's messages and services, loaded when a topic or service first needs them.
#pragma once

#include <memory>
#include <string>

#include <rosidl_runtime_c/message_type_support_struct.h>
#include <rosidl_runtime_c/service_type_support_struct.h>

#include "culprit_link/protocol.h"

namespace culprit_link {

// Null, with the reason in `why`: the robot's workspace does not have the type.
const rosidl_message_type_support_t* message_type(const std::string& type, std::string& why);
const rosidl_service_type_support_t* service_type(const std::string& type, std::string& why);

// Messages of one type as the middleware's C interface takes them, from and to serialized ones.
class MessageForm {
 public:
  // "package/srv/Type_Request". Null, with the reason in `why`: as above.
  static std::unique_ptr<MessageForm> of(const std::string& type, std::string& why);

  using Message = std::unique_ptr<void, void (*)(void*)>;
  // With default values.
  Message make() const;
  // Null: the payload is no such message.
  Message deserialize(const Bytes& payload) const;
  // Empty: the middleware refuses.
  Bytes serialize(const void* message) const;

 private:
  MessageForm() = default;

  const rosidl_message_type_support_t* type_ = nullptr;
  const void* members_ = nullptr;  // how it lies in memory
};

}  // namespace culprit_link
