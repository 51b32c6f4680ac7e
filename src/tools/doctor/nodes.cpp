// Nodes that exist twice, are gone, are stuck, restart again and again, or wait for a lifecycle manager.
#include <algorithm>
#include <array>
#include <set>
#include <tuple>

#include <fmt/core.h>

#include "base/name_grammar.h"
#include "base/ros_names.h"
#include "base/tool_names.h"
#include "doctor/examine.h"
#include "doctor/wiring.h"
#include "doctor/wording.h"

namespace culprit::doctor {
namespace {

const Process* process_of(const Picture& picture, int pid) {
  const auto found = picture.processes.find(pid);
  return found == picture.processes.end() ? nullptr : &found->second;
}

std::string processes_of(const Picture& picture, std::vector<ros2::GraphNode> nodes) {
  std::ranges::sort(nodes, {}, [](const ros2::GraphNode& n) { return std::tie(n.host, n.pid); });
  std::string text;
  for (const ros2::GraphNode& node : nodes) {
    if (!text.empty()) text += ", ";
    const Process* process = process_of(picture, node.pid);
    if (node.pid != 0) {
      text += "process " + std::to_string(node.pid);
    } else {
      text += node.host.empty() ? "a process that is not known" : "a process on " + node.host;
    }
    if (process != nullptr && process->is_left_over) text += " (left over: its launcher has ended)";
  }
  return text;
}

void examine_names(const Picture& picture, Findings& all) {
  for (const auto& [name, nodes] : picture.namesakes)
    all.push_back(
        {"D010",
         Gravity::kError,
         name,
         fmt::format("{} nodes have this name: {}", nodes.size(), processes_of(picture, nodes)),
         "both publish and answer; parameters and lifecycle of one of them are out of "
         "reach",
         "end one of them (an earlier launch may be left over), or give it another name",
         {name}});
}

// Nodes made for their clients: they offer nothing that is used, and another node of the process answers. The process runs
// callbacks of such a node only while it waits for an answer itself, as Nav2's bt_navigator does while a goal runs.
std::set<std::string> nodes_for_clients(const Picture& picture) {
  std::set<int> answering;
  std::set<std::string> used;
  for (const Node& each : picture.nodes) {
    if (!picture.unanswered.contains(each.node.name)) answering.insert(each.node.pid);
    for (const ros2::GraphEndpoint& end : each.endpoints) {
      if (end.kind == EndpointKind::kSubscriber || end.kind == EndpointKind::kClient)
        used.insert(end.name);
    }
  }
  const auto is_client = [](const ros2::GraphEndpoint& end) {
    return end.kind == EndpointKind::kClient;
  };
  const auto is_needed = [&](const ros2::GraphEndpoint& end) {
    const bool is_offered =
        end.kind == EndpointKind::kPublisher || end.kind == EndpointKind::kServer;
    return is_offered && !is_name_of_each_node(end.name) && used.contains(end.name);
  };
  std::set<std::string> found;
  for (const Node& each : picture.nodes) {
    if (each.node.pid != 0 && answering.contains(each.node.pid) &&
        std::ranges::any_of(each.endpoints, is_client) &&
        std::ranges::none_of(each.endpoints, is_needed))
      found.insert(each.node.name);
  }
  return found;
}

// A killed node is in the graph until its lease ends; one that hangs is there for good. Where most of a
// robot does not answer, its nodes do not all hang.
void examine_answers(const Picture& picture, Findings& all) {
  constexpr std::size_t kMany = 5;
  const std::set<std::string> for_clients = nodes_for_clients(picture);
  std::vector<std::string> silent;
  double waited = 0;
  for (const auto& [name, asked] : picture.unanswered) {
    if (asked.has_ended) {
      all.push_back({"D011",
                     Gravity::kError,
                     name,
                     "its process has ended, without an announcement",
                     "others take it for alive until its lease ends (20 s)",
                     "start it again; its log says why it ended",
                     {name}});
    } else if (!for_clients.contains(name)) {
      silent.push_back(name);
      waited = asked.seconds;
    }
  }
  if (silent.size() >= kMany && 2 * silent.size() > picture.asked) {
    all.push_back(
        {"D012", Gravity::kWarning, listed(silent),
         fmt::format("{} of {} nodes have not answered a question about their parameters for "
                     "{:.1f} s",
                     silent.size(), picture.asked, waited),
         "so many do not hang at once: a computer or the network is overloaded, and all services "
         "are late",
         "see what takes the processor (top) and the network; then look again", silent});
    return;
  }
  for (const std::string& name : silent)
    all.push_back(
        {"D012",
         Gravity::kError,
         name,
         fmt::format("it has not answered a question about its parameters for {:.1f} s", waited),
         "a node that answers nothing hangs: in a callback, or in its driver",
         "see where its threads are (gdb -p, py-spy dump), and start it again",
         {name}});
}

// A node that left with a good-bye was ended on purpose, or had finished.
void examine_comings(const Picture& picture, Findings& all) {
  for (const auto& [name, comings] : picture.comings) {
    if (is_tool_node(name) || picture.namesakes.contains(name)) continue;
    const auto returns = static_cast<std::size_t>(
        std::ranges::count_if(comings, [](const Coming& each) { return each.is_there; }));
    const Coming& last = comings.back();
    if (returns > 0) {
      const bool is_loop = returns > 1;
      all.push_back(
          {"D013",
           is_loop ? Gravity::kError : Gravity::kWarning,
           name,
           fmt::format("it was started again {} while the doctor looked{}",
                       returns == 1 ? "once" : count_of(returns, "time"),
                       last.pid == 0 ? "" : fmt::format(", last as process {}", last.pid)),
           is_loop ? "restarts do not repair it, and after each one all nodes discover it again"
                   : "readers of its state or parameters have lost them",
           "its log says why it ended; stop its launcher, and start it by hand",
           {name}});
    } else if (last.was_lost && !picture.unanswered.contains(name)) {
      all.push_back(
          {"D011",
           Gravity::kError,
           name,
           "it was lost while the doctor looked: its lease has run out, without an announcement",
           "its process was killed, or its computer is out of reach",
           "start it again; its log says why it ended",
           {name}});
    }
  }
}

// ---- lifecycle

bool is_on_its_way(const std::string& state) {
  constexpr std::array kTransitions = {"configuring", "cleaningup",   "shuttingdown",
                                       "activating",  "deactivating", "errorprocessing"};
  return std::ranges::find(kTransitions, state) != kTransitions.end();
}

// Whether its state has a manager: a lifecycle manager, the (hidden) one of system modes, or culprit.
bool is_driven(const Picture& picture, const std::string& node) {
  const std::string service = node + "/change_state";
  return std::ranges::any_of(picture.nodes, [&](const Node& other) {
    return !own_name(other.node.name).starts_with("_culprit_") &&
           std::ranges::any_of(other.endpoints, [&](const ros2::GraphEndpoint& each) {
             return each.kind == EndpointKind::kClient && each.name == service;
           });
  });
}

// A node that waits for a topic that only this one publishes; empty: there is none.
std::string waiting_for(const std::string& node, const Wiring& wiring) {
  for (const auto& [name, topic] : wiring.topics) {
    const bool is_only_one =
        !topic.senders.empty() &&
        std::ranges::all_of(topic.senders, [&](const End& end) { return end.node == node; });
    if (!is_only_one || is_topic_of_ros(name)) continue;
    for (const End& to : topic.receivers) {
      if (to.node != node && !is_tool_node(to.node)) return to.node;
    }
  }
  return "";
}

void examine_states(const Picture& picture, Findings& all) {
  const auto is_active = [](const auto& entry) { return entry.second.last == "active"; };
  const auto active = std::ranges::count_if(picture.lifecycles, is_active);
  const Wiring wiring = wiring_of(picture);
  for (const auto& [node, state] : picture.lifecycles) {
    if (is_on_its_way(state.last) && state.first == state.last) {
      all.push_back(
          {"D016",
           Gravity::kError,
           node,
           fmt::format("it has been {} for {} at least", state.last, duration(state.between)),
           "until that ends it neither works nor takes another order",
           "see where its threads are (gdb -p, py-spy dump), and start it again",
           {node}});
      continue;
    }
    const bool waits =
        state.last == "inactive" || state.last == "unconfigured" || state.last == "finalized";
    if (!waits || state.first != state.last || active == 0 || is_driven(picture, node)) continue;
    const std::string waiting = waiting_for(node, wiring);
    if (waiting.empty()) continue;
    const bool is_final = state.last == "finalized";
    all.push_back(
        {"D015",
         Gravity::kWarning,
         node,
         fmt::format(
             "it is {}, {} of {} lifecycle nodes are active, and no manager would change that",
             state.last, active, picture.lifecycles.size()),
         waiting + " waits for what it publishes",
         is_final ? "start its process again: no transition leaves that state"
                  : "ros2 lifecycle set " + node +
                        (state.last == "inactive" ? " activate" : " configure"),
         {node, waiting}});
  }
}

}  // namespace

void examine_nodes(const Picture& picture, Findings& all) {
  examine_names(picture, all);
  examine_answers(picture, all);
  examine_comings(picture, all);
  examine_states(picture, all);
}

// The nodes' own diagnostics. An aggregator reports STALE for a status that is no longer updated.
void examine_statuses(const Picture& picture, Findings& all) {
  constexpr Duration kPatience = std::chrono::seconds(5);
  constexpr int kPauses = 5;
  // Statuses about an event come in bursts, and have no rhythm to be missed.
  constexpr Duration kBurst = std::chrono::seconds(2);
  for (const auto& [name, status] : picture.statuses) {
    const ros2::msg::DiagnosticStatus& report = status.report;
    const std::string subject = printable(name);
    if (report.level >= 2) {
      const bool is_stale = report.level == 3;
      all.push_back({"D020", is_stale ? Gravity::kWarning : Gravity::kError, subject,
                     std::string("its diagnostic status is ") + (is_stale ? "STALE" : "ERROR") +
                         (report.message.empty() ? "" : ": " + printable(report.message)),
                     is_stale ? "its node has stopped reporting" : "its node reports a failure",
                     "look at its values: ros2 topic echo /diagnostics"});
    }
    if (status.count < 3 || status.last - status.first < kBurst) continue;
    const Duration pause = (status.last - status.first) / static_cast<int>(status.count - 1);
    const Duration silent = picture.looked - status.last;
    if (silent < std::max(kPatience, kPauses * pause)) continue;
    all.push_back({"D021", Gravity::kError, subject,
                   fmt::format("its diagnostic status came every {}, and not any more for {}",
                               duration(pause), duration(silent)),
                   "the node that reports it hangs or has exited",
                   "find the node that publishes it: ros2 topic info -v /diagnostics"});
  }
}

}  // namespace culprit::doctor
