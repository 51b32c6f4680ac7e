// Finds endpoints that do not connect, and the reason.
#include <algorithm>
#include <cctype>
#include <fnmatch.h>
#include <map>
#include <set>

#include <fmt/core.h>

#include "base/ros_names.h"
#include "base/tool_names.h"
#include "doctor/examine.h"
#include "doctor/wiring.h"
#include "doctor/wording.h"

namespace culprit::doctor {
namespace {

using namespace std::chrono_literals;

enum class Medium : std::uint8_t { kTopic, kService };

// A QoS policy that a receiver requests and a sender does not offer (DDS 1.4, 2.2.3: "requested versus offered").
struct Mismatch {
  std::string policy, offered, requested;
};

std::string word(rtps::Reliability reliability) {
  return reliability == rtps::Reliability::kReliable ? "reliable" : "best effort";
}
std::string word(rtps::Durability durability) {
  return durability == rtps::Durability::kTransientLocal ? "transient local" : "volatile";
}
std::string word(rtps::Liveliness liveliness) {
  return liveliness == rtps::Liveliness::kManualByTopic ? "manual by topic" : "automatic";
}
std::string word(rtps::Ownership ownership) {
  return ownership == rtps::Ownership::kExclusive ? "exclusive" : "shared";
}
std::string word(rtps::Keys keys) { return keys == rtps::Keys::kSome ? "some" : "none"; }
std::string word(Duration time) { return duration(time); }

std::vector<Mismatch> mismatches(const rtps::Qos& offered, const rtps::Qos& requested) {
  std::vector<Mismatch> all;
  const auto compare = [&](const char* policy, auto member, auto is_enough) {
    if (!is_enough(offered.*member, requested.*member))
      all.push_back({policy, word(offered.*member), word(requested.*member)});
  };
  const auto no_less = [](auto a, auto b) { return a >= b; };
  const auto no_longer = [](auto a, auto b) { return a <= b; };
  const auto same = [](auto a, auto b) { return a == b; };
  compare("reliability", &rtps::Qos::reliability, no_less);
  compare("durability", &rtps::Qos::durability, no_less);
  compare("deadline", &rtps::Qos::deadline, no_longer);
  compare("liveliness", &rtps::Qos::liveliness, no_less);
  compare("liveliness lease", &rtps::Qos::liveliness_lease, no_longer);
  compare("ownership", &rtps::Qos::ownership, same);
  compare("keys", &rtps::Qos::keys, same);
  return all;
}

std::string in_words(const std::vector<Mismatch>& all) {
  std::string text;
  for (const Mismatch& each : all)
    text += fmt::format("{}{}: offered is {}, requested is {}", text.empty() ? "" : "; ",
                        each.policy, each.offered, each.requested);
  return text;
}

// The reason why two endpoints do not connect: what was observed, and for quality of service the
// first policy that does not fit.
struct Break {
  std::string code, seen;
  std::string offered{}, requested{};
  auto operator<=>(const Break&) const = default;
};
// The sender, the reason, and all receivers that do not receive its messages.
using Breaks = std::map<std::pair<std::string, Break>, std::set<std::string>>;

bool have_one_in_common(std::vector<std::string> a, std::vector<std::string> b) {
  if (a.empty()) a.emplace_back();
  if (b.empty()) b.emplace_back();
  return std::ranges::any_of(a, [&](const std::string& x) {
    return std::ranges::any_of(b, [&](const std::string& y) {
      return fnmatch(x.c_str(), y.c_str(), 0) == 0 || fnmatch(y.c_str(), x.c_str(), 0) == 0;
    });
  });
}

std::string partitions_of(const End& end) {
  return end.endpoint.partitions.empty() ? "none" : listed(end.endpoint.partitions);
}

// rmw_fastrtps and rmw_cyclonedds pair replies with requests in ways of their own.
bool have_one_mapping(const End& client, const End& server) {
  if (client.vendor == server.vendor) return true;
  for (const End* end : {&client, &server}) {
    if (end->vendor == ros2::Vendor::kOther) return true;
    if (end->vendor == ros2::Vendor::kFastDds && end->endpoint.names_its_pair) return true;
  }
  return false;
}

std::string middleware(ros2::Vendor vendor) {
  return vendor == ros2::Vendor::kCyclone ? "Cyclone DDS" : "Fast DDS";
}

// Why the one does not hear the other, although both have the name; nothing if it may.
std::vector<Break> breaks_between(Medium medium, const End& from, const End& to) {
  const ros2::GraphEndpoint& a = from.endpoint;
  const ros2::GraphEndpoint& b = to.endpoint;
  const bool is_topic = medium == Medium::kTopic;
  if (a.type != b.type)
    return {{"D002", fmt::format("{} as {}, {} as {}", is_topic ? "published" : "called", a.type,
                                 is_topic ? "subscribed to" : "served", b.type)}};
  std::vector<Break> all;
  if (!a.type_hash.empty() && !b.type_hash.empty() && a.type_hash != b.type_hash)
    all.push_back(
        {"D005", fmt::format("both call their type {}, and it is not the same: {} and {}", a.type,
                             a.type_hash.substr(0, 15), b.type_hash.substr(0, 15))});
  if (const auto wrong = mismatches(a.qos, b.qos); !wrong.empty())
    all.push_back({"D001", in_words(wrong), wrong.front().offered, wrong.front().requested});
  if (!have_one_in_common(a.partitions, b.partitions))
    all.push_back({"D008", fmt::format("partitions that it sends to: {}; that are listened to: {}",
                                       partitions_of(from), partitions_of(to))});
  if (!is_topic && !have_one_mapping(from, to))
    all.push_back({"D007", fmt::format("the client is on {}, the server on {}",
                                       middleware(from.vendor), middleware(to.vendor))});
  return all;
}

std::string remedy(const Break& why, const std::string& from, const std::string& to) {
  if (why.code == "D001")
    return fmt::format("let {} offer {}, or {} request {}", from, why.requested, to, why.offered);
  if (why.code == "D002") return "give both the same type, or one of them another name";
  if (why.code == "D005") return "build both with the same version of its package";
  if (why.code == "D008") return "give both one partition: the middleware's XML profiles set them";
  return "set RMW_IMPLEMENTATION to the same for both";
}

Gravity gravity_of(const std::string& code) {
  return code == "D005" ? Gravity::kWarning : Gravity::kError;
}

std::string consequence(const std::string& code, Medium medium, const std::string& from,
                        const std::string& to) {
  if (code == "D005") return "messages are misread, or refused as broken";
  if (medium == Medium::kTopic) return to + " receives nothing from " + from;
  return code == "D007" ? from + " waits for answers for ever, without an error"
                        : "calls of " + from + " do not reach " + to;
}

void compare_all(Medium medium, const std::string& name, const Channel& channel, Findings& all) {
  Breaks breaks;
  for (const End& from : channel.senders) {
    for (const End& to : channel.receivers) {
      if (from.node == to.node) continue;  // both are somebody's intention
      for (Break& each : breaks_between(medium, from, to))
        breaks[{from.node, std::move(each)}].insert(to.node);
    }
  }
  for (const auto& [key, nodes] : breaks) {
    const auto& [from, why] = key;
    const std::vector<std::string> receivers(nodes.begin(), nodes.end());
    const std::string to = listed(receivers);
    Finding& finding = all.emplace_back(Finding{why.code,
                                                gravity_of(why.code),
                                                name + ": " + from + " → " + to,
                                                why.seen,
                                                consequence(why.code, medium, from, to),
                                                remedy(why, from, to),
                                                {from},
                                                name});
    finding.nodes.insert(finding.nodes.end(), receivers.begin(), receivers.end());
  }
}

// ---- names

using Channels = std::map<std::string, Channel>;

// Names that each node has, or that belong to a larger protocol: no person mistypes these.
bool is_internal(const std::string& name) {
  return is_name_of_each_node(name) || name.find("/_action/") != std::string::npos;
}

bool has_type(const std::vector<End>& ends, const std::string& type) {
  return std::ranges::any_of(ends, [&](const End& end) { return end.endpoint.type == type; });
}

// An offered and unused name of that type that is nearly the same.
std::string meant_by(const std::string& name, const std::string& type, Medium medium,
                     const Channels& channels) {
  std::vector<std::string_view> unused;
  for (const auto& [other, channel] : channels) {
    const bool is_topic = medium == Medium::kTopic;
    const auto& offering = is_topic ? channel.senders : channel.receivers;
    const auto& using_it = is_topic ? channel.receivers : channel.senders;
    if (using_it.empty() && has_robots_end(offering) && has_type(offering, type) &&
        !is_internal(other))
      unused.push_back(other);
  }
  return closest_full_name(name, unused);
}

void look_for_near_name(Medium medium, const std::string& name, const Channel& channel,
                        const Channels& channels, Findings& all) {
  const bool is_topic = medium == Medium::kTopic;
  const auto& waiting = is_topic ? channel.receivers : channel.senders;
  const auto& offering = is_topic ? channel.senders : channel.receivers;
  if (!offering.empty() || !has_robots_end(waiting) || is_internal(name)) return;
  const End& reader =
      *std::ranges::find_if(waiting, [](const End& end) { return !is_tool_node(end.node); });
  const std::string meant = meant_by(name, reader.endpoint.type, medium, channels);
  if (meant.empty()) return;  // an input that nobody feeds yet is no fault
  const Channel& other = channels.at(meant);
  const std::string& writer = (is_topic ? other.senders : other.receivers).front().node;
  if (is_topic) {
    all.push_back({"D003",
                   Gravity::kWarning,
                   name + ": no publisher → " + reader.node,
                   "no node publishes " + name + ", and no node reads " + meant + " of " + writer,
                   reader.node + " receives nothing, if that is the intended name",
                   "remap one of them, or start both in the same namespace",
                   {reader.node, writer},
                   name});
  } else {
    all.push_back({"D003",
                   Gravity::kWarning,
                   name + ": " + reader.node + " → no server",
                   "no node serves " + name + ", and no node calls " + meant + " of " + writer,
                   reader.node + " waits for a service for ever, if that is the intended name",
                   "remap one of them, or start both in the same namespace",
                   {reader.node, writer},
                   name});
  }
}

// "/camera_2/image" -> "/camera_#/image".
std::string without_numbers(const std::string& name) {
  std::string out;
  for (const char c : name) {
    const bool is_digit = std::isdigit(static_cast<unsigned char>(c)) != 0;
    if (!is_digit)
      out += c;
    else if (!out.ends_with('#'))
      out += '#';
  }
  return out;
}

// "/left/scan" -> "/*/scan". Empty: it is in no namespace.
std::string in_any_namespace(const std::string& name) {
  const std::string space = namespace_of(name);
  return space.empty() ? "" : namespace_of(space) + "/*/" + own_name(name);
}

// Among several topics of one kind, one lacks an endpoint that all others have.
void look_for_odd_ones(const Channels& topics, Findings& all) {
  constexpr std::size_t kFewest = 3;
  std::map<std::pair<std::string, std::string>, std::vector<const Channels::value_type*>> kinds;
  for (const auto& topic : topics) {
    const auto& [name, channel] = topic;
    const auto& ends = channel.senders.empty() ? channel.receivers : channel.senders;
    if (is_internal(name) || !has_robots_end(ends)) continue;
    const std::string numbered = without_numbers(name);
    if (numbered != name) kinds[{ends.front().endpoint.type, numbered}].push_back(&topic);
    if (const std::string spaced = in_any_namespace(name); !spaced.empty())
      kinds[{ends.front().endpoint.type, spaced}].push_back(&topic);
  }
  std::set<std::string> told;  // by two kinds it is odd once
  for (const auto& [kind, members] : kinds) {
    if (members.size() < kFewest) continue;
    const auto is_whole = [](const Channels::value_type* each) {
      return !each->second.senders.empty() && !each->second.receivers.empty();
    };
    if (static_cast<std::size_t>(std::ranges::count_if(members, is_whole)) + 1 != members.size())
      continue;
    const auto& [name, channel] = **std::ranges::find_if_not(members, is_whole);
    if (!told.insert(name).second) continue;
    const bool is_unread = channel.receivers.empty();
    const std::string& node = (is_unread ? channel.senders : channel.receivers).front().node;
    const std::string others =
        fmt::format("the {} others of its kind ({})", members.size() - 1, kind.second);
    all.push_back({"D004",
                   Gravity::kWarning,
                   name + ": " + (is_unread ? node + " → no subscriber" : "no publisher → " + node),
                   is_unread ? "it has no subscription, unlike each of " + others
                             : "it has no publisher, unlike each of " + others,
                   is_unread ? "messages of " + node + " on it are lost"
                             : node + " waits for messages that never come",
                   is_unread ? "start the node that should read it, or check its remappings"
                             : "start the node that should publish it, or check its remappings",
                   {node},
                   name});
  }
}

// ---- latched, and read too late

void look_for_missed(const Picture& picture, const std::string& name, const Channel& topic,
                     Findings& all) {
  constexpr Duration kMargin = 1s;  // by which clocks and the kernel's hundredths may differ
  const auto flow = picture.flows.find(name);
  if (flow == picture.flows.end() || !flow->second.last_sent || is_internal(name)) return;
  const auto latches = [](const End& end) {
    return end.endpoint.qos.durability == rtps::Durability::kTransientLocal;
  };
  if (topic.senders.empty() || !std::ranges::all_of(topic.senders, latches)) return;
  const auto process_of = [&](const std::string& node) -> const Process* {
    for (const Node& each : picture.nodes) {
      if (each.node.name != node) continue;
      const auto found = picture.processes.find(each.node.pid);
      return found == picture.processes.end() ? nullptr : &found->second;
    }
    return nullptr;
  };
  // Its clock says when it was sent.
  if (!std::ranges::all_of(topic.senders, [&](const End& end) { return process_of(end.node); }))
    return;
  for (const End& to : topic.receivers) {
    const Process* process = process_of(to.node);
    if (latches(to) || process == nullptr || is_tool_node(to.node)) continue;
    const Duration late = process->started - *flow->second.last_sent;
    if (late < kMargin) continue;
    all.push_back(
        {"D006",
         Gravity::kError,
         name + ": " + topic.senders.front().node + " → " + to.node,
         fmt::format("its last transient local message was published {} before {} was started, "
                     "which requests only later ones (volatile)",
                     duration(late), to.node),
         to.node + " never got it, and will not until it is published again",
         "let " + to.node + " request transient local",
         {topic.senders.front().node, to.node},
         name});
  }
}

// ---- announced endpoints that did not come

void look_for_undiscovered(const Picture& picture, Findings& all) {
  constexpr Duration kSettled = 3s;  // its discovery takes less
  for (const Participant& each : picture.participants) {
    if (each.undiscovered == 0 || each.nodes.empty()) continue;
    const bool is_settled = std::ranges::all_of(each.nodes, [&](const std::string& node) {
      const auto comings = picture.comings.find(node);
      return comings == picture.comings.end() ||
             comings->second.back().at + kSettled <= picture.looked;
    });
    if (!is_settled || std::ranges::all_of(each.nodes, is_tool_node)) continue;
    all.push_back(
        {"D009", Gravity::kWarning, listed(each.nodes),
         fmt::format("{} of its endpoints were announced and did not come in {}", each.undiscovered,
                     duration(picture.looked)),
         "a node that does not discover an endpoint gets nothing from it: at least the doctor does "
         "not, and perhaps others",
         "start it again; if it stays, see whether large or fragmented datagrams get "
         "through (MTU, Wi-Fi, firewall)",
         each.nodes});
  }
}

}  // namespace

void examine_connections(const Picture& picture, Findings& all) {
  const Wiring wiring = wiring_of(picture);
  for (const auto& [name, topic] : wiring.topics) {
    compare_all(Medium::kTopic, name, topic, all);
    look_for_near_name(Medium::kTopic, name, topic, wiring.topics, all);
    look_for_missed(picture, name, topic, all);
  }
  for (const auto& [name, service] : wiring.services) {
    compare_all(Medium::kService, name, service, all);
    look_for_near_name(Medium::kService, name, service, wiring.services, all);
  }
  look_for_odd_ones(wiring.topics, all);
  look_for_undiscovered(picture, all);
}

}  // namespace culprit::doctor
