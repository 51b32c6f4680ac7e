// Which nodes can reach each other at all: domains, addresses, keys, distributions, shared memory.
#include <algorithm>
#include <map>
#include <set>

#include <fmt/core.h>

#include "base/name_grammar.h"
#include "base/tool_names.h"
#include "doctor/examine.h"
#include "doctor/machine.h"
#include "doctor/wording.h"

namespace culprit::doctor {
namespace {

void examine_presence(const Picture& picture, Findings& all) {
  if (!picture.nodes.empty()) return;
  const bool knows_others = !picture.other_domains.empty();
  all.push_back({"D030", Gravity::kError, "domain " + std::to_string(picture.domain),
                 knows_others ? "no nodes were seen; processes of this machine are on " +
                                    domains_with_programs(picture.other_domains)
                              : "no nodes were seen",
                 "there is nothing to examine",
                 "is ROS_DOMAIN_ID the robot's? ROS_LOCALHOST_ONLY=1 or another discovery server "
                 "on one side hides it, too"});
}

void examine_domains(const Picture& picture, Findings& all) {
  for (const OtherDomain& other : picture.other_domains) {
    for (const auto& [program, sibling] : other.siblings)
      all.push_back({"D031",
                     Gravity::kError,
                     program,
                     fmt::format("it is on domain {}, and {}, which the same launch started, on {}",
                                 other.domain, sibling, picture.domain),
                     "they do not discover each other",
                     "give both the same ROS_DOMAIN_ID",
                     {sibling}});
  }
}

// Those that have nodes of the robot.
std::vector<const Participant*> robots(const Picture& picture) {
  std::vector<const Participant*> found;
  for (const Participant& each : picture.participants) {
    if (!each.nodes.empty() && !std::ranges::all_of(each.nodes, is_tool_node))
      found.push_back(&each);
  }
  return found;
}

std::vector<std::string> nodes_of(const std::vector<const Participant*>& some) {
  std::set<std::string> names;
  for (const Participant* each : some) names.insert(each->nodes.begin(), each->nodes.end());
  return {names.begin(), names.end()};
}

// A host of those that are not on `host`; empty: all are.
std::string another_host(const std::vector<const Participant*>& all, const std::string& host) {
  const auto found = std::ranges::find_if(
      all, [&](const Participant* each) { return !each->host.empty() && each->host != host; });
  return found == all.end() ? "" : (*found)->host;
}

void examine_addresses(const std::vector<const Participant*>& robot, Findings& all) {
  std::map<std::string, std::vector<const Participant*>> local;  // by host
  for (const Participant* each : robot) {
    if (each->is_local && !each->host.empty()) local[each->host].push_back(each);
  }
  for (const auto& [host, some] : local) {
    const std::string elsewhere = another_host(robot, host);
    if (elsewhere.empty()) continue;
    const std::vector<std::string> names = nodes_of(some);
    all.push_back({"D032", Gravity::kError, listed(names),
                   fmt::format("they listen on {} only, and others of the robot are on {}",
                               printable(host), printable(elsewhere)),
                   "they and the nodes on other computers do not discover each other",
                   "start them without ROS_LOCALHOST_ONLY=1 "
                   "(ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST), or all on one computer",
                   names});
  }
}

void examine_security(const Picture& picture, Findings& all) {
  std::vector<const Participant*> open;
  std::size_t secured = 0;
  std::vector<std::string> whose;
  for (const Participant& each : picture.participants) {
    if (each.is_secured) {
      ++secured;
      if (each.pid != 0) whose.push_back("process " + std::to_string(each.pid));
    }
  }
  for (const Participant* each : robots(picture)) {
    if (!each->is_secured) open.push_back(each);
  }
  if (secured == 0 || open.empty()) return;
  const std::vector<std::string> names = nodes_of(open);
  all.push_back(
      {"D033", Gravity::kError, listed(names),
       fmt::format("they are not secured, and {} of the domain {}{}",
                   count_of(secured, "participant"), secured == 1 ? "is" : "are",
                   whose.empty() ? "" : " (" + listed(whose) + ")"),
       "the two kinds do not discover each other, unless the governance file of the keys allows it",
       "start all with ROS_SECURITY_ENABLE=true and keys of one keystore, or none", names});
}

// Up to Humble and from Iron on, processes say differently what their nodes are called.
void examine_distributions(const std::vector<const Participant*>& robot, Findings& all) {
  std::vector<const Participant*> old, young;
  for (const Participant* each : robot) {
    if (!each->form) continue;
    (*each->form == ros2::GidSize::kHumbleAndOlder ? old : young).push_back(each);
  }
  if (old.empty() || young.empty()) return;
  all.push_back(
      {"D034", Gravity::kError, listed(nodes_of(old)),
       "they are of ROS 2 Humble or older, and others of Iron or newer: " + listed(nodes_of(young)),
       "neither side knows what the other's nodes are called, and nodes of rclcpp may crash "
       "on what they receive",
       "give one side another ROS_DOMAIN_ID, and bridge what both need", nodes_of(old)});
}

const Process* process_of(const Picture& picture, const Participant& participant) {
  const auto found = picture.processes.find(participant.pid);
  return found == picture.processes.end() ? nullptr : &found->second;
}

// Fast DDS sends through shared memory to participants that it assumes on the same machine.
void examine_shared_memory(const Picture& picture, const std::vector<const Participant*>& robot,
                           Findings& all) {
  for (auto a = robot.begin(); a != robot.end(); ++a) {
    for (auto b = a + 1; b != robot.end(); ++b) {
      if (!(*a)->shares_memory || !(*b)->shares_memory) continue;
      if ((*a)->host_number != (*b)->host_number) continue;
      const Process* one = process_of(picture, **a);
      const Process* other = process_of(picture, **b);
      if (one == nullptr || other == nullptr || one->shared_memory == 0 ||
          other->shared_memory == 0 || one->shared_memory == other->shared_memory)
        continue;
      const std::vector<std::string> names = nodes_of({*a, *b});
      all.push_back(
          {"D035", Gravity::kError, listed((*a)->nodes) + " ↔ " + listed((*b)->nodes),
           "both take each other to be on one machine and send through shared memory, but "
           "each sees a /dev/shm of its own",
           "they discover each other, but receive no messages",
           "start their containers with --ipc=host, or switch shared memory off "
           "(FASTDDS_BUILTIN_TRANSPORTS=UDPv4)",
           names});
      return;  // one pair tells it
    }
  }
}

// A writer of Fast DDS that took a reader for broken, and its reader's successor, which has the number of the port but
// another file.
void examine_lost_ports(const Picture& picture, const std::vector<const Participant*>& robot,
                        Findings& all) {
  for (const Participant* writer : robot) {
    const Process* sends = process_of(picture, *writer);
    if (sends == nullptr || sends->ports_lost.empty()) continue;
    for (const Participant* reader : robot) {
      const Process* reads = process_of(picture, *reader);
      const bool is_lost = reads != nullptr && reads != sends &&
                           std::ranges::any_of(reads->ports_read, [&](const std::string& port) {
                             return sends->ports_lost.contains(port);
                           });
      if (!is_lost) continue;
      all.push_back(
          {"D036", Gravity::kError, listed(writer->nodes) + " → " + listed(reader->nodes),
           "the one sends through a file of shared memory that was replaced, and the other reads "
           "from the new one",
           "messages of the one do not reach the other",
           "restart both; to rule it out, switch shared memory off "
           "(FASTDDS_BUILTIN_TRANSPORTS=UDPv4)",
           nodes_of({writer, reader})});
      return;  // one pair tells it
    }
  }
}

}  // namespace

void examine_reach(const Picture& picture, Findings& all) {
  const auto robot = robots(picture);
  examine_presence(picture, all);
  examine_domains(picture, all);
  examine_addresses(robot, all);
  examine_security(picture, all);
  examine_distributions(robot, all);
  examine_shared_memory(picture, robot, all);
  examine_lost_ports(picture, robot, all);
}

}  // namespace culprit::doctor
