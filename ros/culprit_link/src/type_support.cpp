#include "type_support.h"

#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <sstream>
#include <vector>

#include <rcutils/allocator.h>
#include <rmw/error_handling.h>
#include <rmw/rmw.h>
#include <rmw/serialized_message.h>
#include <rosidl_typesupport_introspection_c/message_introspection.h>

#include "ignore.h"

namespace culprit_link {
namespace {

using Members = rosidl_typesupport_introspection_c__MessageMembers;

// "std_msgs/msg/String" -> {"std_msgs", "msg", "String"}
std::vector<std::string> parts_of(const std::string& type) {
  std::vector<std::string> parts;
  std::stringstream text(type);
  for (std::string part; std::getline(text, part, '/');) parts.push_back(part);
  const auto is_word = [](const std::string& part) {
    return !part.empty() && part.find_first_not_of(
                                "abcdefghijklmnopqrstuvwxyz"
                                "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") == std::string::npos;
  };
  const bool is_type =
      parts.size() == 3 && is_word(parts[0]) && is_word(parts[1]) && is_word(parts[2]);
  return is_type ? parts : std::vector<std::string>();
}

// Stays loaded: the middleware keeps pointers into it.
void* load(const std::string& library) {
  if (void* found = dlopen(library.c_str(), RTLD_LAZY | RTLD_LOCAL)) return found;
  const char* prefixes = std::getenv("AMENT_PREFIX_PATH");
  std::stringstream all(prefixes == nullptr ? "" : prefixes);
  for (std::string prefix; std::getline(all, prefix, ':');) {
    if (void* found = dlopen((prefix + "/lib/" + library).c_str(), RTLD_LAZY | RTLD_LOCAL))
      return found;
  }
  return nullptr;
}

template <class TypeSupport>
const TypeSupport* find(const std::string& support, const std::string& kind,
                        const std::string& type, std::string& why) {
  const std::vector<std::string> parts = parts_of(type);
  if (parts.empty()) {
    why = "'" + type + "' is no type";
    return nullptr;
  }
  const std::string library = "lib" + parts[0] + "__" + support + ".so";
  void* loaded = load(library);
  if (loaded == nullptr) {
    why = "the helper's environment has no package " + parts[0];
    return nullptr;
  }
  const std::string symbol = support + "__get_" + kind + "_type_support_handle__" + parts[0] +
                             "__" + parts[1] + "__" + parts[2];
  void* function = dlsym(loaded, symbol.c_str());
  if (function == nullptr) {
    why = "the package " + parts[0] + " has no type " + type;
    return nullptr;
  }
  const TypeSupport* (*get)() = nullptr;
  std::memcpy(&get, &function, sizeof get);
  return get();
}

void free_message(void*) {}

}  // namespace

const rosidl_message_type_support_t* message_type(const std::string& type, std::string& why) {
  return find<rosidl_message_type_support_t>("rosidl_typesupport_c", "message", type, why);
}

const rosidl_service_type_support_t* service_type(const std::string& type, std::string& why) {
  return find<rosidl_service_type_support_t>("rosidl_typesupport_c", "service", type, why);
}

std::unique_ptr<MessageForm> MessageForm::of(const std::string& type, std::string& why) {
  std::unique_ptr<MessageForm> form(new MessageForm);
  form->type_ = message_type(type, why);
  const auto* shape = find<rosidl_message_type_support_t>("rosidl_typesupport_introspection_c",
                                                          "message", type, why);
  if (form->type_ == nullptr || shape == nullptr) return nullptr;
  form->members_ = shape->data;
  return form;
}

MessageForm::Message MessageForm::make() const {
  const auto* members = static_cast<const Members*>(members_);
  // The members before the message, for its end.
  constexpr std::size_t kBefore = alignof(std::max_align_t);
  static_assert(kBefore >= sizeof(const Members*));
  auto* memory = static_cast<std::uint8_t*>(std::calloc(1, kBefore + members->size_of_));
  if (memory == nullptr) return {nullptr, free_message};
  std::memcpy(memory, &members, sizeof members);
  members->init_function(memory + kBefore, ROSIDL_RUNTIME_C_MSG_INIT_ALL);
  return {memory + kBefore, [](void* message) {
            auto* begin = static_cast<std::uint8_t*>(message) - kBefore;
            const Members* its = nullptr;
            std::memcpy(&its, begin, sizeof its);
            its->fini_function(message);
            std::free(begin);
          }};
}

MessageForm::Message MessageForm::deserialize(const Bytes& payload) const {
  Message message = make();
  if (!message) return message;
  rmw_serialized_message_t serialized = rmw_get_zero_initialized_serialized_message();
  const rcutils_allocator_t allocator = rcutils_get_default_allocator();
  // It may not be read in place: middlewares take it as their own buffer.
  if (rmw_serialized_message_init(&serialized, payload.size() + 1, &allocator) != RMW_RET_OK) {
    rmw_reset_error();
    return {nullptr, free_message};
  }
  std::memcpy(serialized.buffer, payload.data(), payload.size());
  serialized.buffer_length = payload.size();
  const rmw_ret_t read = rmw_deserialize(&serialized, type_, message.get());
  ignore(rmw_serialized_message_fini(&serialized));
  if (read == RMW_RET_OK) return message;
  rmw_reset_error();
  return {nullptr, free_message};
}

Bytes MessageForm::serialize(const void* message) const {
  rmw_serialized_message_t serialized = rmw_get_zero_initialized_serialized_message();
  const rcutils_allocator_t allocator = rcutils_get_default_allocator();
  Bytes bytes;
  if (rmw_serialized_message_init(&serialized, 0, &allocator) == RMW_RET_OK &&
      rmw_serialize(message, type_, &serialized) == RMW_RET_OK)
    bytes.assign(serialized.buffer, serialized.buffer + serialized.buffer_length);
  rmw_reset_error();
  ignore(rmw_serialized_message_fini(&serialized));
  return bytes;
}

}  // namespace culprit_link
