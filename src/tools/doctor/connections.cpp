#include <algorithm>
#include <chrono>
#include <map>
#include <optional>

#include <fmt/core.h>

#include "base/ros_names.h"
#include "doctor/examine.h"

namespace culprit::doctor {
namespace {

struct End {
  std::string node;
  ros2::GraphEndpoint endpoint;
};

struct Topic {
  std::vector<End> publishers;
  std::vector<End> subscribers;
};

using Topics = std::map<std::string, Topic>;

Topics topics_of(const Picture& picture) {
  Topics topics;
  for (const auto& [node, endpoints] : picture.nodes) {
    for (const ros2::GraphEndpoint& each : endpoints) {
      if (each.kind == EndpointKind::kPublisher)
        topics[each.name].publishers.push_back({node.name, each});
      if (each.kind == EndpointKind::kSubscriber)
        topics[each.name].subscribers.push_back({node.name, each});
    }
  }
  return topics;
}

std::string seconds(Duration time) {
  if (time == ros2::kInfinite) return "none";
  return fmt::format("{:g} s", std::chrono::duration<double>(time).count());
}

// What a subscription requests and the publisher does not offer (DDS 1.4, 2.2.3: "requested versus
// offered"). Nothing if they match.
struct Mismatch {
  std::string policy, offered, requested;
};
std::optional<Mismatch> mismatch(const ros2::Qos& offered, const ros2::Qos& requested) {
  using ros2::Durability;
  using ros2::Reliability;
  if (requested.reliability == Reliability::kReliable &&
      offered.reliability == Reliability::kBestEffort)
    return Mismatch{"reliability", "best effort", "reliable"};
  if (requested.durability == Durability::kTransientLocal &&
      offered.durability == Durability::kVolatile)
    return Mismatch{"durability", "volatile", "transient local"};
  if (offered.keys != requested.keys) {
    const auto words = [](ros2::Keys keys) { return keys == ros2::Keys::kSome ? "some" : "none"; };
    return Mismatch{"keys", words(offered.keys), words(requested.keys)};
  }
  if (offered.deadline > requested.deadline)
    return Mismatch{"deadline", seconds(offered.deadline), seconds(requested.deadline)};
  return std::nullopt;
}

std::string between(const std::string& topic, const End& from, const End& to) {
  return topic + ": " + from.node + " → " + to.node;
}

void compare(const std::string& topic, const End& from, const End& to, std::vector<Finding>& all) {
  if (from.endpoint.type != to.endpoint.type) {
    all.push_back({"D002", Gravity::kError, between(topic, from, to),
                   "published as " + from.endpoint.type + ", subscribed to as " + to.endpoint.type,
                   to.node + " hears nothing of " + from.node,
                   "give both the same type, or one of the topics another name"});
    return;
  }
  if (const auto wrong = mismatch(from.endpoint.qos, to.endpoint.qos))
    all.push_back(
        {"D001", Gravity::kError, between(topic, from, to),
         wrong->policy + ": offered is " + wrong->offered + ", requested is " + wrong->requested,
         to.node + " hears nothing of " + from.node,
         "let " + from.node + " offer " + wrong->requested + ", or " + to.node + " request " +
             wrong->offered});
}

// A topic that somebody publishes and nobody reads, of that type, with nearly that name.
std::string meant_by(const std::string& name, const std::string& type, const Topics& topics) {
  std::vector<std::string_view> unread;
  for (const auto& [other, topic] : topics) {
    const bool is_of_type = std::ranges::any_of(
        topic.publishers, [&](const End& end) { return end.endpoint.type == type; });
    if (topic.subscribers.empty() && is_of_type) unread.push_back(other);
  }
  return closest_full_name(name, unread);
}

void look_for_publisher(const std::string& name, const Topic& topic, const Topics& topics,
                        std::vector<Finding>& all) {
  const End& reader = topic.subscribers.front();
  const std::string meant = meant_by(name, reader.endpoint.type, topics);
  if (meant.empty()) return;  // an input that nobody feeds yet is no fault
  const std::string& writer = topics.at(meant).publishers.front().node;
  all.push_back({"D003", Gravity::kWarning, name + ": nobody → " + reader.node,
                 "nobody publishes " + name + ", and nobody reads " + meant + " of " + writer,
                 reader.node + " hears nothing, if that is what it means",
                 "remap one of them, or start both in the same namespace"});
}

}  // namespace

std::vector<Finding> examine_connections(const Picture& picture) {
  const Topics topics = topics_of(picture);
  std::vector<Finding> all;
  for (const auto& [name, topic] : topics) {
    for (const End& from : topic.publishers) {
      for (const End& to : topic.subscribers) compare(name, from, to, all);
    }
    if (topic.publishers.empty()) look_for_publisher(name, topic, topics, all);
  }
  return all;
}

}  // namespace culprit::doctor
