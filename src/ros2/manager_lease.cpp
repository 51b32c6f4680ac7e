#include "ros2/manager_lease.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "ros2/service_mapping.h"

namespace culprit::ros2 {
namespace {

std::optional<std::int64_t> number_in(std::string_view text) {
  std::int64_t number = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_whole = failed == std::errc() && end == text.data() + text.size();
  return is_whole ? std::optional(number) : std::nullopt;
}

}  // namespace

std::string ManagerLease::user_data() const {
  return "robot=" + own_.robot + ";since=" + std::to_string(own_.since) +
         ";id=" + std::to_string(own_.id) + ";";
}

void ManagerLease::apply(const DiscoveryEvent& event) {
  if (const auto* endpoint = std::get_if<EndpointInfo>(&event)) {
    if (endpoint->topic != kTopic || endpoint->guid.is_reader()) return;
    const auto since = number_in(user_data_value(endpoint->user_data, "since"));
    const auto id = number_in(user_data_value(endpoint->user_data, "id"));
    if (!since || !id || user_data_value(endpoint->user_data, "robot") != own_.robot) return;
    if (others_.size() < kMost) others_[endpoint->guid] = {*since, *id};
  } else if (const auto* gone = std::get_if<EndpointGone>(&event)) {
    others_.erase(gone->guid);
  } else if (const auto* left = std::get_if<ParticipantGone>(&event)) {
    std::erase_if(others_,
                  [&](const auto& other) { return other.first.prefix() == left->guid.prefix(); });
  }
}

// A claim of the same rank is of this process, which joins the domain anew at times.
std::optional<GuidPrefix> ManagerLease::elder() const {
  const auto first =
      std::min_element(others_.begin(), others_.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  if (first == others_.end() || first->second >= Rank(own_.since, own_.id)) return std::nullopt;
  return first->first.prefix();
}

}  // namespace culprit::ros2
