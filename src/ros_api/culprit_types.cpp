#include "ros_api/culprit_types.h"

#include <charconv>
#include <cstdlib>
#include <iostream>

#include "ros2/message_library.h"
#include "ros2/type_description.h"
#include "ros_api/culprit_msgs.h"

namespace culprit::ros_api {
namespace {

// "msg", "srv" or "action".
std::string_view kind_of(std::string_view type) {
  const std::size_t first = type.find('/') + 1;
  return type.substr(first, type.find('/', first) - first);
}

[[noreturn]] void end_with(const std::string& what) {
  std::cerr << "culprit: culprit_msgs: " << what << std::endl;
  std::abort();
}

// Between lines of three hyphens, the parts with these suffixes.
void learn_parts(ros2::MessageLibrary& library, const InterfaceFile& file,
                 std::initializer_list<const char*> suffixes) {
  constexpr std::string_view kBetween = "\n---\n";
  std::string_view rest = file.text;
  for (const char* suffix : suffixes) {
    const bool is_last = suffix == *(suffixes.end() - 1);
    const std::size_t at = is_last ? rest.size() : rest.find(kBetween);
    if (at == std::string_view::npos) end_with(std::string(file.type) + " without a " + suffix);
    library.learn(std::string(file.type) + suffix, rest.substr(0, at));
    rest.remove_prefix(is_last ? at : at + kBetween.size());
  }
}

MessageType type_named(const std::string& name, ros2::MessageLibrary& library) {
  auto definitions = library.with_parts(name);
  if (!definitions) end_with(definitions.error());
  const auto hash = library.hash_of(name);
  return {name, std::move(*definitions), *hash};
}

// Reads the lines "uint8 NAME=3".
std::map<std::string, int> constants_in(std::string_view text) {
  std::map<std::string, int> constants;
  while (!text.empty()) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    line = line.substr(0, line.find('#'));
    const std::size_t space = line.find(' ');
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos || space > equals) continue;
    int value = 0;
    std::from_chars(line.data() + equals + 1, line.data() + line.size(), value);
    constants.emplace(line.substr(space + 1, equals - space - 1), value);
  }
  return constants;
}

}  // namespace

CulpritTypes::CulpritTypes() {
  ros2::MessageLibrary library;
  for (const InterfaceFile& file : kInterfaceFiles) {
    const std::string type(file.type);
    if (kind_of(type) == "srv") {
      learn_parts(library, file, {"_Request", "_Response"});
    } else if (kind_of(type) == "action") {
      learn_parts(library, file, {"_Goal", "_Result", "_Feedback"});
    } else {
      library.learn(type, file.text);
      for (const auto& [name, value] : constants_in(file.text))
        constants_.emplace(type + "." + name, value);
    }
  }
  const auto add = [&](const std::string& type) -> const MessageType& {
    return messages_.emplace(type, type_named(type, library)).first->second;
  };
  const auto add_service = [&](const std::string& type) {
    services_.emplace(
        type, ServiceType{type, add(type + "_Request"), add(type + "_Response"), add(type).hash});
  };
  for (const InterfaceFile& file : kInterfaceFiles) {
    const std::string type(file.type);
    if (kind_of(type) == "srv") {
      add_service(type);
    } else if (kind_of(type) == "action") {
      add_service(type + "_SendGoal");
      add_service(type + "_GetResult");
      add(type + "_FeedbackMessage");
    } else {
      add(type);
    }
  }
  add_service("action_msgs/srv/CancelGoal");
  add("action_msgs/msg/GoalStatusArray");
}

const MessageType& CulpritTypes::message(std::string_view name) const {
  const auto found = messages_.find(name);
  if (found == messages_.end()) end_with("there is no " + std::string(name));
  return found->second;
}

const ServiceType& CulpritTypes::service(std::string_view name) const {
  const auto found = services_.find(name);
  if (found == services_.end()) end_with("there is no " + std::string(name));
  return found->second;
}

int CulpritTypes::constant(std::string_view message, std::string_view name) const {
  const auto found = constants_.find(std::string(message).append(".").append(name));
  if (found == constants_.end()) end_with(std::string(message).append(" has no ").append(name));
  return found->second;
}

ros2::srv::GetTypeDescription::Response CulpritTypes::described(
    const ros2::srv::GetTypeDescription::Request& request) const {
  ros2::srv::GetTypeDescription::Response response;
  const auto found = messages_.find(request.type_name);
  if (found == messages_.end()) {
    response.failure_reason = "culprit has no such type";
    return response;
  }
  if (found->second.hash != request.type_hash) {
    response.failure_reason = "culprit's type of that name is another one: " + found->second.hash;
    return response;
  }
  const MessageType& type = found->second;
  response.successful = true;
  response.type_description = ros2::describe(type.name, type.definitions);
  if (!request.include_type_sources) return response;
  for (const InterfaceFile& file : kInterfaceFiles) {
    const bool is_part = type.definitions.contains(file.type);
    if (is_part)
      response.type_sources.push_back(
          {std::string(file.type), std::string(kind_of(file.type)), std::string(file.text)});
  }
  return response;
}

}  // namespace culprit::ros_api
