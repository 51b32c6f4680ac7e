#include "language/ros_names.h"

#include <algorithm>

namespace culprit {

std::string own_name(const std::string& full_name) {
  return full_name.substr(full_name.rfind('/') + 1);
}

std::string namespace_of(const std::string& full_name) {
  const std::size_t slash = full_name.rfind('/');
  return slash == std::string::npos ? "" : full_name.substr(0, slash);
}

std::string topic_of(const std::string& topic, const std::string& node) {
  if (topic.starts_with('/')) return topic;
  if (topic.starts_with("~/")) return node + topic.substr(1);
  return namespace_of(node) + "/" + topic;
}

std::string service_of(const std::string& service, const std::string& node) {
  if (service.starts_with('/')) return service;
  return node + "/" + (service.starts_with("~/") ? service.substr(2) : service);
}

std::string as_written(const std::string& name) {
  const auto is_plain = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '.' || c == '-';
  };
  if (std::all_of(name.begin(), name.end(), is_plain)) return name;
  const auto is_unfit = [](unsigned char c) { return c < 0x20 || c == '"' || c == '\\'; };
  return std::any_of(name.begin(), name.end(), is_unfit) ? "" : "\"" + name + "\"";
}

}  // namespace culprit
