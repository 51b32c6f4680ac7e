#include "graph_reading.h"

#include <rcl/error_handling.h>
#include <rcl/graph.h>
#include <rmw/qos_profiles.h>
#if __has_include(<rosidl_runtime_c/type_hash.h>)
#include <rosidl_runtime_c/type_hash.h>
#define CULPRIT_LINK_HAS_HASHES
#endif

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <rmw/rmw.h>

#include "ignore.h"

namespace culprit_link {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

// Middlewares give infinite times as very large ones.
std::int64_t to_nanoseconds(const rmw_time_t& time) {
  constexpr std::uint64_t kLongest = 1'000'000'000;  // seconds
  if (time.sec >= kLongest) return 0;
  return static_cast<std::int64_t>(time.sec) * kSecond + static_cast<std::int64_t>(time.nsec);
}

rmw_time_t to_time(std::int64_t nanoseconds) {
  return {static_cast<std::uint64_t>(nanoseconds / kSecond),
          static_cast<std::uint64_t>(nanoseconds % kSecond)};
}

// rmw_dds_common says "_NODE_NAME_UNKNOWN_" of an endpoint that no node claims yet.
GraphSeen::Node node_of(const char* name_space, const char* name) {
  if (name == nullptr || name_space == nullptr || std::strncmp(name, "_NODE_NAME_", 11) == 0)
    return {};
  return {name_space, name};
}

std::string hash_of([[maybe_unused]] const rmw_topic_endpoint_info_t& info) {
  std::string text;
#ifdef CULPRIT_LINK_HAS_HASHES
  if (info.topic_type_hash.version == 0) return text;
  char* hash = nullptr;
  const rcutils_allocator_t allocator = rcutils_get_default_allocator();
  if (rosidl_stringify_type_hash(&info.topic_type_hash, allocator, &hash) == RCUTILS_RET_OK) {
    text = hash;
    allocator.deallocate(hash, allocator.state);
  }
#endif
  return text;
}

using Infos = rcl_topic_endpoint_info_array_t;
using ReadInfos = rcl_ret_t (*)(const rcl_node_t*, rcutils_allocator_t*, const char*, bool, Infos*);

void read_endpoints(const rcl_node_t& node, const char* topic, ReadInfos read, GraphSeen& seen) {
  rcutils_allocator_t allocator = rcutils_get_default_allocator();
  Infos all = rcl_get_zero_initialized_topic_endpoint_info_array();
  if (read(&node, &allocator, topic, false, &all) != RCL_RET_OK) return rcl_reset_error();
  for (std::size_t i = 0; i < all.size; ++i) {
    const rmw_topic_endpoint_info_t& info = all.info_array[i];
    GraphSeen::Endpoint& endpoint = seen.endpoints.emplace_back();
    endpoint.is_publisher = info.endpoint_type == RMW_ENDPOINT_PUBLISHER;
    endpoint.topic = topic;
    endpoint.type = info.topic_type == nullptr ? "" : info.topic_type;
    endpoint.type_hash = hash_of(info);
    std::memcpy(endpoint.gid.data(), info.endpoint_gid, endpoint.gid.size());
    endpoint.node = node_of(info.node_namespace, info.node_name);
    endpoint.quality = to_quality(info.qos_profile);
  }
  ignore(rmw_topic_endpoint_info_array_fini(&all, &allocator));
}

using ReadServices = rcl_ret_t (*)(const rcl_node_t*, rcl_allocator_t*, const char*, const char*,
                                   rcl_names_and_types_t*);

void read_services(const rcl_node_t& node, const GraphSeen::Node& of, ReadServices read,
                   bool is_server, GraphSeen& seen) {
  rcl_allocator_t allocator = rcl_get_default_allocator();
  rcl_names_and_types_t all = rcl_get_zero_initialized_names_and_types();
  // It may have left meanwhile.
  if (read(&node, &allocator, of.name.c_str(), of.name_space.c_str(), &all) != RCL_RET_OK)
    return rcl_reset_error();
  for (std::size_t i = 0; i < all.names.size; ++i) {
    if (all.types[i].size == 0) continue;
    seen.services.push_back({is_server, all.names.data[i], all.types[i].data[0], of});
  }
  ignore(rcl_names_and_types_fini(&all));
}

void read_nodes(const rcl_node_t& node, GraphSeen& seen) {
  rcutils_string_array_t names = rcutils_get_zero_initialized_string_array();
  rcutils_string_array_t spaces = rcutils_get_zero_initialized_string_array();
  if (rcl_get_node_names(&node, rcl_get_default_allocator(), &names, &spaces) == RCL_RET_OK) {
    for (std::size_t i = 0; i < names.size; ++i) {
      GraphSeen::Node found = node_of(spaces.data[i], names.data[i]);
      if (!found.name.empty()) seen.nodes.push_back(std::move(found));
    }
  }
  rcl_reset_error();
  ignore(rcutils_string_array_fini(&names));
  ignore(rcutils_string_array_fini(&spaces));
}

// ---- nodes that are not announced yet

// The first bytes of a GUID: the participant.
using Participant = std::array<std::uint8_t, 12>;

template <class Id>
Participant participant_of(const Id& gid) {
  Participant participant;
  std::memcpy(participant.data(), &gid[0], participant.size());
  return participant;
}

bool has_guids() {
  const std::string middleware = rmw_get_implementation_identifier();
  return middleware.find("fastrtps") != std::string::npos ||
         middleware.find("cyclonedds") != std::string::npos;
}

// "a::srv::dds_::B_Response_" -> "a/srv/B"
std::string service_type_of(const std::string& response) {
  constexpr std::string_view kMiddle = "::srv::dds_::";
  constexpr std::string_view kEnd = "_Response_";
  const std::size_t middle = response.find(kMiddle);
  if (middle == std::string::npos || !std::string_view(response).ends_with(kEnd)) return "";
  const std::size_t begin = middle + kMiddle.size();
  return response.substr(0, middle) + "/srv/" +
         response.substr(begin, response.size() - kEnd.size() - begin);
}

// The services of these participants, by the names that DDS has.
std::map<Participant, std::vector<GraphSeen::Service>> servers_of(
    const rcl_node_t& node, const std::set<Participant>& participants) {
  std::map<Participant, std::vector<GraphSeen::Service>> servers;
  rcl_allocator_t allocator = rcl_get_default_allocator();
  rcl_names_and_types_t topics = rcl_get_zero_initialized_names_and_types();
  if (rcl_get_topic_names_and_types(&node, &allocator, true, &topics) == RCL_RET_OK) {
    for (std::size_t i = 0; i < topics.names.size; ++i) {
      constexpr std::string_view kReply = "Reply";
      const std::string_view topic = topics.names.data[i];
      if (!topic.starts_with("rr/") || !topic.ends_with(kReply)) continue;
      const std::string service(topic.substr(2, topic.size() - 2 - kReply.size()));
      Infos all = rcl_get_zero_initialized_topic_endpoint_info_array();
      if (rcl_get_publishers_info_by_topic(&node, &allocator, topics.names.data[i], true, &all) ==
          RCL_RET_OK) {
        for (std::size_t e = 0; e < all.size; ++e) {
          const Participant its = participant_of(all.info_array[e].endpoint_gid);
          const std::string type = service_type_of(all.info_array[e].topic_type);
          if (participants.contains(its) && !type.empty())
            servers[its].push_back({true, service, type, {}});
        }
      }
      rcl_reset_error();
      ignore(rmw_topic_endpoint_info_array_fini(&all, &allocator));
    }
  }
  rcl_reset_error();
  ignore(rcl_names_and_types_fini(&topics));
  return servers;
}

// A participant announces its nodes apart from its endpoints, and on Fast DDS that may come seconds later while a killed
// predecessor's lease runs. A node's parameter services have its name: a participant with those of one node holds that.
void name_unannounced(const rcl_node_t& node, GraphSeen& seen) {
  if (!has_guids()) return;
  std::set<Participant> nameless;
  for (const GraphSeen::Endpoint& each : seen.endpoints) {
    if (each.node.name.empty()) nameless.insert(participant_of(each.gid));
  }
  if (nameless.empty()) return;
  for (auto& [participant, services] : servers_of(node, nameless)) {
    constexpr std::string_view kParameters = "/get_parameters";
    std::set<std::string> names;
    for (const GraphSeen::Service& each : services) {
      if (std::string_view(each.name).ends_with(kParameters))
        names.insert(each.name.substr(0, each.name.size() - kParameters.size()));
    }
    if (names.size() != 1) continue;
    const std::size_t slash = names.begin()->rfind('/');
    if (slash == std::string::npos) continue;
    const GraphSeen::Node its{slash == 0 ? "/" : names.begin()->substr(0, slash),
                              names.begin()->substr(slash + 1)};
    for (GraphSeen::Endpoint& each : seen.endpoints) {
      if (each.node.name.empty() && participant_of(each.gid) == participant) each.node = its;
    }
    seen.nodes.push_back(its);
    for (GraphSeen::Service& each : services) {
      each.node = its;
      if (std::find(seen.services.begin(), seen.services.end(), each) == seen.services.end())
        seen.services.push_back(each);
    }
  }
}

}  // namespace

Quality to_quality(const rmw_qos_profile_t& profile) {
  return {profile.reliability != RMW_QOS_POLICY_RELIABILITY_BEST_EFFORT,
          profile.durability == RMW_QOS_POLICY_DURABILITY_TRANSIENT_LOCAL,
          profile.history == RMW_QOS_POLICY_HISTORY_KEEP_ALL,
          profile.liveliness == RMW_QOS_POLICY_LIVELINESS_MANUAL_BY_TOPIC,
          static_cast<std::uint32_t>(profile.depth),
          to_nanoseconds(profile.deadline),
          to_nanoseconds(profile.lifespan),
          to_nanoseconds(profile.liveliness_lease_duration)};
}

rmw_qos_profile_t to_profile(const Quality& quality) {
  rmw_qos_profile_t profile = rmw_qos_profile_default;
  profile.history =
      quality.keeps_all ? RMW_QOS_POLICY_HISTORY_KEEP_ALL : RMW_QOS_POLICY_HISTORY_KEEP_LAST;
  profile.depth = quality.depth;
  profile.reliability = quality.is_reliable ? RMW_QOS_POLICY_RELIABILITY_RELIABLE
                                            : RMW_QOS_POLICY_RELIABILITY_BEST_EFFORT;
  profile.durability = quality.is_transient_local ? RMW_QOS_POLICY_DURABILITY_TRANSIENT_LOCAL
                                                  : RMW_QOS_POLICY_DURABILITY_VOLATILE;
  if (quality.lifespan > 0) profile.lifespan = to_time(quality.lifespan);
  return profile;
}

GraphSeen read_graph(const rcl_node_t& node) {
  GraphSeen seen;
  read_nodes(node, seen);
  rcl_allocator_t allocator = rcl_get_default_allocator();
  rcl_names_and_types_t topics = rcl_get_zero_initialized_names_and_types();
  if (rcl_get_topic_names_and_types(&node, &allocator, false, &topics) == RCL_RET_OK) {
    for (std::size_t i = 0; i < topics.names.size; ++i) {
      read_endpoints(node, topics.names.data[i], rcl_get_publishers_info_by_topic, seen);
      read_endpoints(node, topics.names.data[i], rcl_get_subscriptions_info_by_topic, seen);
    }
  }
  rcl_reset_error();
  ignore(rcl_names_and_types_fini(&topics));
  std::set<std::pair<std::string, std::string>> read;  // two nodes of one name have one answer
  for (const GraphSeen::Node& each : seen.nodes) {
    if (!read.emplace(each.name_space, each.name).second) continue;
    read_services(node, each, rcl_get_service_names_and_types_by_node, true, seen);
    read_services(node, each, rcl_get_client_names_and_types_by_node, false, seen);
  }
  name_unannounced(node, seen);
  return seen;
}

}  // namespace culprit_link
