#include "base/ros_names.h"

#include <algorithm>
#include <cctype>

#include "base/closest.h"

namespace culprit {
namespace {

std::vector<std::string> segments(std::string_view name) {
  std::vector<std::string> out;
  for (std::size_t begin = 1; begin <= name.size();) {
    const std::size_t end = std::min(name.find('/', begin), name.size());
    out.emplace_back(name.substr(begin, end - begin));
    begin = end + 1;
  }
  return out;
}

// Segment by segment, for long namespaces make any two names near as a whole.
bool are_near(std::string_view a, std::string_view b) {
  const auto left = segments(a);
  const auto right = segments(b);
  return std::equal(left.begin(), left.end(), right.begin(), right.end(),
                    [](const std::string& x, const std::string& y) {
                      return x == y || !closest(x, {y}).empty();
                    });
}

}  // namespace

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

std::string closest_full_name(const std::string& name, const std::vector<std::string_view>& known) {
  std::vector<std::string_view> namesakes;
  std::vector<std::string_view> near;
  for (const std::string_view candidate : known) {
    if (own_name(std::string(candidate)) == own_name(name)) namesakes.push_back(candidate);
    if (are_near(name, candidate)) near.push_back(candidate);
  }
  return namesakes.size() == 1 ? std::string(namesakes[0]) : closest(name, near);
}

}  // namespace culprit
