#include "recorder/topic_choice.h"

#include <algorithm>
#include <array>
#include <fnmatch.h>

namespace culprit::recorder {
namespace {

constexpr std::array<const char*, 3> kAlways = {"/diagnostics", "/rosout", "/parameter_events"};

bool matches_any(const std::vector<std::string>& patterns, const std::string& topic) {
  return std::ranges::any_of(patterns, [&](const std::string& pattern) {
    return fnmatch(pattern.c_str(), topic.c_str(), 0) == 0;
  });
}

}  // namespace

TopicChoice::TopicChoice(std::vector<std::string> patterns) {
  for (std::string& pattern : patterns) {
    if (pattern.starts_with('!')) {
      unwanted_.push_back(pattern.substr(1));
    } else {
      wanted_.push_back(std::move(pattern));
    }
  }
}

bool TopicChoice::names(const std::string& topic) const { return matches_any(wanted_, topic); }

bool TopicChoice::includes(const std::string& topic) const {
  if (matches_any(unwanted_, topic)) return false;
  if (std::ranges::find(kAlways, topic) != kAlways.end() || names(topic)) return true;
  const bool is_hidden = topic.find("/_") != std::string::npos;
  return wanted_.empty() && !is_hidden;
}

}  // namespace culprit::recorder
