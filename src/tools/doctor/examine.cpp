#include "doctor/examine.h"

#include <algorithm>
#include <tuple>

#include <fmt/core.h>

namespace culprit::doctor {
namespace {

std::string processes_of(std::vector<ros2::GraphNode> nodes) {
  std::ranges::sort(nodes, {}, [](const ros2::GraphNode& n) { return std::tie(n.host, n.pid); });
  std::string text;
  for (const ros2::GraphNode& node : nodes) {
    if (!text.empty()) text += ", ";
    if (node.pid != 0) {
      text += "process " + std::to_string(node.pid);
    } else {
      text += node.host.empty() ? "a process that is not known" : "a process on " + node.host;
    }
  }
  return text;
}

void examine_names(const Picture& picture, std::vector<Finding>& all) {
  for (const auto& [name, nodes] : picture.namesakes)
    all.push_back(
        {"D010", Gravity::kError, name,
         std::to_string(nodes.size()) + " nodes have this name: " + processes_of(nodes),
         "both publish and answer; parameters and lifecycle of one of them are out of "
         "reach",
         "end one of them (an earlier launch may be left over), or give it another name"});
}

// A killed node is in the graph until its lease ends; one that hangs is there for good.
void examine_answers(const Picture& picture, std::vector<Finding>& all) {
  for (const auto& [name, asked] : picture.unanswered) {
    if (asked.has_ended) {
      all.push_back({"D011", Gravity::kError, name, "its process has ended, without a good-bye",
                     "others take it for alive until its lease ends (20 s)",
                     "start it again; its log says why it ended"});
    } else {
      all.push_back({"D012", Gravity::kError, name,
                     fmt::format("it has not answered a question about its parameters for {:.1f} s",
                                 asked.seconds),
                     "a node that answers nothing hangs: in a callback, or in its driver",
                     "see where its threads are (gdb -p, py-spy dump), and start it again"});
    }
  }
}

// What nodes say of themselves. STALE is what an aggregator says of who said nothing.
void examine_statuses(const Picture& picture, std::vector<Finding>& all) {
  for (const auto& [name, status] : picture.statuses) {
    if (status.level < 2) continue;
    const bool is_stale = status.level == 3;
    all.push_back({"D020", is_stale ? Gravity::kWarning : Gravity::kError, name,
                   std::string("its diagnostic status is ") + (is_stale ? "STALE" : "ERROR") +
                       (status.message.empty() ? "" : ": " + status.message),
                   is_stale ? "who reports it has stopped reporting" : "who reports it is ill",
                   "look at its values: ros2 topic echo /diagnostics"});
  }
}

void examine_presence(const Picture& picture, std::vector<Finding>& all) {
  if (!picture.nodes.empty()) return;
  all.push_back({"D030", Gravity::kError, "domain " + std::to_string(picture.domain),
                 "no nodes were seen", "there is nothing to examine",
                 "is ROS_DOMAIN_ID the robot's? ROS_LOCALHOST_ONLY=1 or another discovery server "
                 "on one side hides it, too"});
}

}  // namespace

std::vector<Finding> examine(const Picture& picture) {
  std::vector<Finding> all = examine_connections(picture);
  examine_names(picture, all);
  examine_answers(picture, all);
  examine_statuses(picture, all);
  examine_presence(picture, all);
  std::ranges::sort(all, [](const Finding& a, const Finding& b) {
    return std::tie(b.gravity, a.code, a.who, a.seen) < std::tie(a.gravity, b.code, b.who, b.seen);
  });
  return all;
}

}  // namespace culprit::doctor
