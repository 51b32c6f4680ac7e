#include "doctor/wanted_topics.h"

#include <algorithm>
#include <array>

#include "base/tool_names.h"
#include "doctor/stamped_types.h"
#include "doctor/wiring.h"

namespace culprit::doctor {
namespace {

bool latches(const End& end) {
  return end.endpoint.qos.durability == rtps::Durability::kTransientLocal &&
         end.endpoint.qos.reliability == rtps::Reliability::kReliable;
}

bool has_deadline(const End& end) { return end.endpoint.qos.deadline != rtps::kInfinite; }

}  // namespace

std::vector<WantedTopic> wanted_topics(const Picture& picture, Extent extent) {
  std::array<std::vector<WantedTopic>, 4> wanted;  // the first most
  for (const auto& [name, topic] : wiring_of(picture).topics) {
    const bool has_ear = name == "/tf" || name == "/tf_static" || is_topic_of_ros(name);
    if (has_ear || topic.senders.empty() || !has_robots_end(topic.receivers)) continue;
    const ros2::GraphEndpoint& offered = topic.senders.front().endpoint;
    const WantedTopic each{name,
                           offered.type,
                           offered.qos.keys,
                           std::ranges::all_of(topic.senders, latches),
                           is_stamped_type(offered.type),
                           std::ranges::any_of(topic.receivers, has_deadline)};
    const bool may_be_missed = each.is_latched && !std::ranges::all_of(topic.receivers, latches);
    if (extent == Extent::kEverything || each.is_stamped || may_be_missed || each.has_deadline)
      wanted[each.has_deadline           ? 0
             : may_be_missed             ? 1
             : is_sensor_type(each.type) ? 2
                                         : 3]
          .push_back(each);
  }
  std::vector<WantedTopic> all;
  for (auto& some : wanted) all.insert(all.end(), some.begin(), some.end());
  return all;
}

}  // namespace culprit::doctor
