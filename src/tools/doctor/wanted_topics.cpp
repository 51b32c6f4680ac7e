#include "doctor/wanted_topics.h"

#include <algorithm>

#include "base/tool_names.h"
#include "doctor/stamped_types.h"
#include "doctor/wiring.h"

namespace culprit::doctor {
namespace {

bool latches(const End& end) {
  return end.endpoint.qos.durability == ros2::Durability::kTransientLocal &&
         end.endpoint.qos.reliability == ros2::Reliability::kReliable;
}

bool has_deadline(const End& end) { return end.endpoint.qos.deadline != ros2::kInfinite; }

}  // namespace

std::vector<WantedTopic> wanted_topics(const Picture& picture, Extent extent) {
  std::vector<WantedTopic> wanted;
  for (const auto& [name, topic] : wiring_of(picture).topics) {
    const bool has_ear = name == "/tf" || name == "/tf_static" || is_topic_of_ros(name);
    if (has_ear || topic.senders.empty() || !has_robots_end(topic.receivers)) continue;
    const ros2::GraphEndpoint& offered = topic.senders.front().endpoint;
    const WantedTopic each{name, offered.type, offered.qos.keys,
                           std::ranges::all_of(topic.senders, latches),
                           is_stamped_type(offered.type)};
    const bool may_be_missed = each.is_latched && !std::ranges::all_of(topic.receivers, latches);
    if (extent == Extent::kEverything || each.is_stamped || may_be_missed ||
        std::ranges::any_of(topic.receivers, has_deadline))
      wanted.push_back(each);
  }
  return wanted;
}

}  // namespace culprit::doctor
