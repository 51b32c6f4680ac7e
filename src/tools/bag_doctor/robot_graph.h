// Which node publishes, reads and depends on what, as far as a recording, a rule file or `culprit graph --json` say it.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>

#include "base/expected.h"
#include "language/rule_set.h"

namespace culprit::bag_doctor {

struct RobotGraph {
  // Consumer and producer are nodes; the channel is a topic or a service, empty where it is declared.
  struct Edge {
    std::string consumer, producer, channel;
    auto operator<=>(const Edge&) const = default;
  };
  std::set<std::string> nodes{};
  std::map<std::string, std::set<std::string>> publishers{};   // by topic
  std::map<std::string, std::set<std::string>> subscribers{};  // by topic
  std::set<Edge> edges{};  // beside those that publishers and subscribers make

  bool has_edges() const;
  void add(const RobotGraph& other);
};

// As `culprit graph --json` and the topic /culprit/graph of culprit's recordings have it. Errors: it is neither.
Expected<RobotGraph> parse_graph(std::string_view json);

// What declarations say: DEPENDENCY, age(/scan FROM lidar), and topics that only rules about one component read.
RobotGraph graph_of(const RuleSet& rules);

// The node that publishes the topic: by the graph; else the one below whose name it is ("/camera/image"), of `nodes`
// too. Empty: not known, or several do.
std::string publisher_of(const std::string& topic, const RobotGraph& graph);

}  // namespace culprit::bag_doctor
