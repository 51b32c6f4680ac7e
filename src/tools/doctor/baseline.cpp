#include "doctor/baseline.h"

#include <algorithm>

#include <fmt/core.h>

#include "base/name_grammar.h"
#include "base/tool_names.h"
#include "doctor/wording.h"

namespace culprit::doctor {
namespace {

constexpr std::size_t kFewestMessages = 10;

std::string in_words(const rtps::Qos& qos) {
  std::string words = qos.reliability == rtps::Reliability::kReliable ? "reliable" : "best effort";
  words += qos.durability == rtps::Durability::kTransientLocal ? ", transient local" : ", volatile";
  if (qos.deadline != rtps::kInfinite) words += ", deadline " + duration(qos.deadline);
  if (qos.lifespan != rtps::kInfinite) words += ", lifespan " + duration(qos.lifespan);
  if (qos.liveliness == rtps::Liveliness::kManualByTopic) words += ", liveliness manual by topic";
  if (qos.liveliness_lease != rtps::kInfinite)
    words += ", liveliness lease " + duration(qos.liveliness_lease);
  if (qos.ownership == rtps::Ownership::kExclusive) words += ", exclusive";
  if (qos.keys == rtps::Keys::kSome) words += ", with keys";
  return words;
}

Baseline::Node node_of(const Picture& picture, const Node& node) {
  Baseline::Node out;
  for (const ros2::GraphEndpoint& each : node.endpoints) {
    const Baseline::Wire wire{each.type, in_words(each.qos)};
    if (each.kind == EndpointKind::kPublisher) out.publishes[each.name] = wire;
    if (each.kind == EndpointKind::kSubscriber) out.subscribes[each.name] = wire;
    if (each.kind == EndpointKind::kServer) out.serves[each.name] = wire;
  }
  if (const auto found = picture.parameters.find(node.node.name); found != picture.parameters.end())
    out.parameters = found->second;
  if (const auto found = picture.lifecycles.find(node.node.name); found != picture.lifecycles.end())
    out.lifecycle = found->second.last;
  const auto process = picture.processes.find(node.node.pid);
  if (process != picture.processes.end() && !process->second.samples.empty())
    out.memory = process->second.samples.back().bytes;
  return out;
}

// ---- comparing

Finding finding(const char* code, Gravity gravity, const std::string& subject, std::string seen,
                std::string matters, std::string remedy) {
  return {code, gravity, subject, std::move(seen), std::move(matters), std::move(remedy)};
}

void compare_wires(const std::string& node, const char* what,
                   const std::map<std::string, Baseline::Wire>& healthy,
                   const std::map<std::string, Baseline::Wire>& now, Findings& all) {
  std::vector<std::string> missing;
  for (const auto& [name, before] : healthy) {
    const auto found = now.find(name);
    if (found == now.end()) {
      missing.push_back(name);
    } else if (found->second != before) {
      const bool is_type = found->second.type != before.type;
      Finding& changed =
          all.emplace_back(finding("D103", Gravity::kWarning, name + ": " + node,
                                   fmt::format("it {} it as {}, and did as {}", what,
                                               is_type ? found->second.type : found->second.qos,
                                               is_type ? before.type : before.qos),
                                   "nodes that were connected to it may be disconnected now",
                                   "change it back, or if it is intended, save a new baseline"));
      changed.nodes = {node};
      changed.topic = name;
    }
  }
  if (missing.empty()) return;
  Finding& gone = all.emplace_back(finding(
      "D102", Gravity::kError, node, fmt::format("it no longer {}: {}", what, listed(missing)),
      "it is not configured as it was, or has not come up whole", "see its log"));
  gone.nodes = {node};
  gone.topic = missing.front();
}

void compare_parameters_of(const std::string& node, const Baseline::Node& healthy,
                           const Baseline::Node& now, Findings& all) {
  if (healthy.parameters.empty() || now.parameters.empty()) return;  // it did not answer
  std::vector<std::string> differences;
  for (const auto& [name, before] : healthy.parameters) {
    const auto found = now.parameters.find(name);
    if (found == now.parameters.end())
      differences.push_back(printable(name) + " is not there");
    else if (found->second != before)
      differences.push_back(fmt::format("{} is {}, was {}", printable(name),
                                        printable(found->second), printable(before)));
  }
  for (const auto& [name, value] : now.parameters) {
    if (!healthy.parameters.contains(name))
      differences.push_back(
          fmt::format("{} is {}, was not there", printable(name), printable(value)));
  }
  if (differences.empty()) return;
  all.push_back(finding("D105", Gravity::kWarning, node, listed(differences),
                        "it does not behave as it did",
                        "set them back, or if it is intended, save a new baseline"));
  all.back().nodes = {node};
}

void compare_node(const std::string& name, const Baseline::Node& healthy, const Baseline::Node& now,
                  Findings& all) {
  compare_wires(name, "publishes", healthy.publishes, now.publishes, all);
  compare_wires(name, "subscribes to", healthy.subscribes, now.subscribes, all);
  compare_wires(name, "serves", healthy.serves, now.serves, all);
  compare_parameters_of(name, healthy, now, all);
  if (!healthy.lifecycle.empty() && !now.lifecycle.empty() && healthy.lifecycle != now.lifecycle) {
    all.push_back(finding(
        "D106", Gravity::kError, name, "it is " + now.lifecycle + ", and was " + healthy.lifecycle,
        "what it does depends on its state", "ros2 lifecycle set " + name + " …"));
    all.back().nodes = {name};
  }
  constexpr std::int64_t kMore = 100'000'000;  // bytes
  if (healthy.memory > 0 && now.memory > 2 * healthy.memory &&
      now.memory > healthy.memory + kMore) {
    all.push_back(finding("D107", Gravity::kWarning, name,
                          fmt::format("its process has {} of memory, and had {}", bytes(now.memory),
                                      bytes(healthy.memory)),
                          "if that goes on, the OOM killer of Linux ends a process",
                          "see what it keeps (heaptrack, tracemalloc)"));
    all.back().nodes = {name};
  }
}

double hertz(const Baseline::Rate& rate) {
  return rate.seconds > 0 ? static_cast<double>(rate.messages - 1) / rate.seconds : 0;
}

void compare_rates(const Baseline& healthy, const Baseline& now, Findings& all) {
  constexpr double kSlower = 2.0 / 3;
  constexpr double kPauses = 10;   // of silence
  constexpr double kShortest = 3;  // seconds
  for (const auto& [topic, before] : healthy.topics) {
    const auto found = now.topics.find(topic);
    if (found == now.topics.end() || before.messages < kFewestMessages || before.seconds <= 0)
      continue;
    const Baseline::Rate& rate = found->second;
    const double pause = 1 / hertz(before);
    const bool is_silent =
        rate.messages == 0 && rate.listened > std::max(kShortest, kPauses * pause);
    const bool is_slower = rate.messages >= 2 && rate.listened > kPauses * pause &&
                           hertz(rate) < kSlower * hertz(before);
    if (!is_silent && !is_slower) continue;
    all.push_back(finding(
        "D104", is_silent ? Gravity::kError : Gravity::kWarning, topic,
        is_silent ? fmt::format("nothing came in {}, and {:.3g} messages a second did",
                                duration(from_seconds(rate.listened)), hertz(before))
                  : fmt::format("{:.3g} messages a second come, and {:.3g} did", hertz(rate),
                                hertz(before)),
        "its subscribers are late, or get less data than they need",
        "is the machine busy (culprit doctor names what eats a core), or the device slower?"));
    all.back().topic = topic;
  }
}

}  // namespace

Baseline baseline_of(const Picture& picture) {
  Baseline out;
  for (const Node& node : picture.nodes) {
    if (!is_tool_node(node.node.name)) out.nodes[node.node.name] = node_of(picture, node);
  }
  for (const auto& [topic, flow] : picture.flows)
    out.topics[topic] = {flow.messages, seconds(flow.first_to_last), seconds(flow.listened)};
  for (const Transform& edge : picture.transforms) out.transforms.insert({edge.parent, edge.child});
  for (const auto& [name, status] : picture.statuses) out.statuses.insert(name);
  return out;
}

Findings compare(const Baseline& healthy, const Baseline& now) {
  Findings all;
  for (const auto& [name, node] : healthy.nodes) {
    const auto found = now.nodes.find(name);
    if (found != now.nodes.end()) {
      compare_node(name, node, found->second, all);
      continue;
    }
    all.push_back(finding("D100", Gravity::kError, name, "it was there, and is not",
                          "its function is missing", "start it; its log says why it ended"));
    all.back().nodes = {name};
  }
  for (const auto& [name, node] : now.nodes) {
    if (healthy.nodes.contains(name)) continue;
    all.push_back(finding("D101", Gravity::kWarning, name, "it is there, and was not",
                          "it may duplicate another node, and uses memory and network",
                          "end it, or if it is intended, save a new baseline"));
    all.back().nodes = {name};
  }
  compare_rates(healthy, now, all);
  for (const auto& [parent, child] : healthy.transforms) {
    if (now.transforms.contains({parent, child})) continue;
    all.push_back(
        finding("D108", Gravity::kError, "tf: " + printable(parent) + " → " + printable(child),
                "it was published, and is not", "nodes that ask for it wait or get an error",
                "see the log of the node that published it"));
    all.back().topic = "/tf";
  }
  for (const std::string& name : healthy.statuses) {
    if (now.statuses.contains(name)) continue;
    all.push_back(finding("D109", Gravity::kWarning, printable(name),
                          "its diagnostic status came, and does not any more",
                          "the node that reports it has exited, or checks no more",
                          "find the node that publishes it: ros2 topic info -v /diagnostics"));
  }
  put_worst_first(all);
  return all;
}

}  // namespace culprit::doctor
