#include "ros_api/culprit_types.h"

#include <charconv>
#include <cstdlib>
#include <iostream>

#include "ros2/message_library.h"
#include "ros2/type_description.h"
#include "ros_api/culprit_msgs.h"

namespace culprit::ros_api {
namespace {

bool is_service(std::string_view type) { return type.find("/srv/") != std::string_view::npos; }

[[noreturn]] void end_with(const std::string& what) {
  std::cerr << "culprit: culprit_msgs: " << what << std::endl;
  std::abort();
}

// What stands before the line of three hyphens, and what stands behind it.
std::pair<std::string_view, std::string_view> parts_of(std::string_view service) {
  constexpr std::string_view kBetween = "\n---\n";
  const std::size_t at = service.find(kBetween);
  if (at == std::string_view::npos) end_with("a service without an answer");
  return {service.substr(0, at + 1), service.substr(at + kBetween.size())};
}

MessageType type_named(const std::string& name, ros2::MessageLibrary& library) {
  auto definitions = library.with_parts(name);
  if (!definitions) end_with(definitions.error());
  const auto hash = library.hash_of(name);
  return {name, std::move(*definitions), *hash};
}

// Of the lines "uint8 NAME=3".
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
    if (!is_service(type)) {
      library.learn(type, file.text);
      for (const auto& [name, value] : constants_in(file.text))
        constants_.emplace(type + "." + name, value);
      continue;
    }
    const auto [request, response] = parts_of(file.text);
    library.learn(type + "_Request", request);
    library.learn(type + "_Response", response);
  }
  for (const InterfaceFile& file : kInterfaceFiles) {
    const std::string type(file.type);
    const MessageType& whole = messages_.emplace(type, type_named(type, library)).first->second;
    if (!is_service(type)) continue;
    for (const char* part : {"_Request", "_Response"})
      messages_.emplace(type + part, type_named(type + part, library));
    services_.emplace(type, ServiceType{type, messages_.at(type + "_Request"),
                                        messages_.at(type + "_Response"), whole.hash});
  }
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
          {std::string(file.type), is_service(file.type) ? "srv" : "msg", std::string(file.text)});
  }
  return response;
}

}  // namespace culprit::ros_api
