#include <map>
#include <set>
#include <unistd.h>

#include <fmt/core.h>

#include "base/name_grammar.h"
#include "base/ros_names.h"
#include "cli/commands.h"
#include "cli/diagnostic_report.h"
#include "json/json.h"
#include "knowledge/dependency_graph.h"
#include "knowledge/dependency_path.h"
#include "live/live_robot.h"
#include "live/preflight.h"
#include "live/rule_file.h"
#include "ros2/options.h"
#include "rule_graph/rule_graph.h"
#include "terminal/console.h"
#include "terminal/seconds_option.h"

namespace culprit::cli {
namespace {

struct GraphOptions {
  std::string rules;  // of this file; empty: of the live robot
  double wait_seconds = 3;
  bool json = false;
  bool dot = false;
  std::vector<std::string> why;  // two nodes; empty: all is shown
};

using Edges = std::vector<DependencyGraph::Edge>;

struct Place {
  int pid = 0;       // of a process of this computer; 0: not known
  std::string host;  // another computer; empty: this one, or not known
};

// Topics of nodes, also those without another end, which make no dependency.
struct TopicEnds {
  std::map<std::string, std::set<std::string>> published, subscribed;  // by node

  std::set<std::string>* of(const std::string& node, EndpointKind kind) {
    if (kind == EndpointKind::kPublisher) return &published[node];
    return kind == EndpointKind::kSubscriber ? &subscribed[node] : nullptr;
  }
};

struct Picture {
  std::map<std::string, Place> nodes;  // by name
  Edges edges;
  TopicEnds ends;
};

Expected<Picture> look(Duration wait) {
  auto participant = ros2::options_from_environment();
  if (!participant) return Error{participant.error()};
  const RuleSet no_rules;
  live::LiveRobot::Options options;
  options.link.participant = *participant;
  options.link.name = {"/", "_culprit_graph"};  // hidden, as tools are
  auto robot = live::LiveRobot::open(no_rules, std::move(options));
  if (!robot) return Error{robot.error()};

  DependencyGraph graph(no_rules);
  std::map<std::string, int> processes;
  TopicEnds ends;
  const Time end = live_now() + wait;
  while (live_now() < end) {
    std::vector<Observation> observations;
    (*robot)->observe(end, observations);
    for (const Observation& o : observations) {
      if (const auto* node = std::get_if<NodeAppeared>(&o.what)) {
        graph.node_appeared(node->node);
        processes[node->node] = node->pid;
      } else if (const auto* gone = std::get_if<NodeVanished>(&o.what)) {
        graph.node_vanished(gone->node);
      } else if (const auto* endpoint = std::get_if<EndpointAppeared>(&o.what)) {
        graph.endpoint_appeared(endpoint->node, endpoint->kind, endpoint->name);
        if (auto* topics = ends.of(endpoint->node, endpoint->kind)) topics->insert(endpoint->name);
      } else if (const auto* lost = std::get_if<EndpointVanished>(&o.what)) {
        graph.endpoint_vanished(lost->node, lost->kind, lost->name);
        if (auto* topics = ends.of(lost->node, lost->kind)) topics->erase(lost->name);
      } else if (const auto* trouble = std::get_if<LinkTrouble>(&o.what)) {
        fmt::print(stderr, "culprit: {}\n", trouble->text);
      }
    }
  }
  Picture picture;
  const auto elsewhere = (*robot)->link().nodes_elsewhere();
  for (const std::string& node : graph.nodes()) {
    const auto host = elsewhere.find(node);
    picture.nodes[node] = {processes[node], host == elsewhere.end() ? "" : host->second};
  }
  picture.edges = graph.edges();
  picture.ends = std::move(ends);
  return picture;
}

// "  (process 4711)", "  (on rover2)", or nothing.
std::string in_words(const Place& place) {
  if (place.pid != 0) return fmt::format("  (process {})", place.pid);
  return place.host.empty() ? "" : fmt::format("  (on {})", escape_controls(place.host));
}

void print_text(const Picture& picture) {
  if (picture.nodes.empty()) {
    fmt::print("{}\n", live::no_nodes_on(ros2::options_from_environment()->domain));
    return;
  }
  for (const auto& [node, place] : picture.nodes) {
    fmt::print("{}{}\n", node, in_words(place));
    std::map<std::string, std::string> needs;
    for (const auto& edge : picture.edges) {
      if (edge.consumer != node) continue;
      std::string& channels = needs[edge.producer];
      channels += (channels.empty() ? "" : ", ") + edge.channel;
    }
    for (const auto& [producer, channels] : needs)
      fmt::print("  needs {}  through {}\n", producer, channels);
  }
}

void print_json(const Picture& picture) {
  Json document{{"nodes", Json::array()}, {"dependencies", Json::array()}};
  for (const auto& [node, place] : picture.nodes) {
    Json entry{{"name", node}};
    if (place.pid != 0) entry["pid"] = place.pid;
    if (!place.host.empty()) entry["host"] = place.host;
    for (const auto& [member, ends] : {std::pair("publishes", &picture.ends.published),
                                       {"subscribes", &picture.ends.subscribed}}) {
      if (const auto topics = ends->find(node); topics != ends->end() && !topics->second.empty())
        entry[member] = topics->second;
    }
    document["nodes"].push_back(std::move(entry));
  }
  for (const auto& edge : picture.edges) {
    document["dependencies"].push_back(
        {{"consumer", edge.consumer}, {"producer", edge.producer}, {"channel", edge.channel}});
  }
  fmt::print("{}\n", to_indented(document));
}

// Names of nodes were checked against the ROS grammar when they came in, those of computers were not.
void print_dot(const Picture& picture) {
  fmt::print("digraph robot {{\n  rankdir=LR;\n  node [shape=box];\n");
  for (const auto& [node, place] : picture.nodes)
    fmt::print("  \"{}\" [label={}];\n", node, rule_graph::in_dot(node + in_words(place)));
  for (const auto& edge : picture.edges) {
    fmt::print("  \"{}\" -> \"{}\" [label=\"{}\"];\n", edge.producer, edge.consumer, edge.channel);
  }
  fmt::print("}}\n");
}

// The node that `name` means: its full name, or its own one where only one is called so.
Expected<std::string> node_called(const std::string& name, const Picture& picture) {
  if (picture.nodes.contains(name)) return name;
  std::vector<std::string> fitting;
  std::vector<std::string_view> all;
  for (const auto& [node, place] : picture.nodes) {
    all.push_back(node);
    if (own_name(node) == name) fitting.push_back(node);
  }
  if (fitting.size() == 1) return fitting.front();
  if (fitting.size() > 1)
    return Error{
        fmt::format("'{}' could be {} or {}: write the full name", name, fitting[0], fitting[1])};
  const std::string near = closest_full_name(name.starts_with('/') ? name : "/" + name, all);
  return Error{fmt::format("the robot has no node '{}'{}", name,
                           near.empty() ? "" : "; did you mean " + near + "?")};
}

void print_path(const std::vector<DependencyGraph::Edge>& path) {
  fmt::print("{} depends on {}:\n", path.front().consumer, path.back().producer);
  for (const auto& edge : path)
    fmt::print("  {} needs {}  through {}\n", edge.consumer, edge.producer, edge.channel);
}

// In both directions: two nodes may depend on one another.
int explain_tie(const std::vector<std::string>& names, const Picture& picture) {
  const auto first = node_called(names[0], picture);
  if (!first) return fail(first.error());
  const auto second = node_called(names[1], picture);
  if (!second) return fail(second.error());
  const auto there = dependency_path(picture.edges, *first, *second);
  const auto back = dependency_path(picture.edges, *second, *first);
  if (!there.empty()) print_path(there);
  if (!back.empty()) print_path(back);
  if (there.empty() && back.empty())
    fmt::print("nothing ties {} and {}: neither depends on the other\n", *first, *second);
  return kOk;
}

int show_rule_graph(const GraphOptions& options) {
  const auto loaded =
      live::read_rules(options.rules, Strictness::kLenient, colour_of(STDERR_FILENO));
  if (!loaded) return fail(loaded.error());
  fmt::print(stderr, "{}", loaded->remarks);
  const rule_graph::RuleGraph graph = rule_graph::graph_of(loaded->rules, loaded->source);
  fmt::print("{}", options.json  ? to_text(as_json(graph)) + "\n"
                   : options.dot ? as_dot(graph)
                                 : as_text(graph));
  return kOk;
}

int show_graph(const GraphOptions& options) {
  if (!options.rules.empty()) return show_rule_graph(options);
  if (const auto robot = ros2::options_from_environment(); !robot)
    return fail(robot.error(), kUsage);
  const auto picture = look(from_seconds(options.wait_seconds));
  if (!picture) {
    fmt::print(stderr, "culprit: {}\n", picture.error());
    return kFailed;
  }
  if (!options.why.empty()) return explain_tie(options.why, *picture);
  if (options.json) {
    print_json(*picture);
  } else if (options.dot) {
    print_dot(*picture);
  } else {
    print_text(*picture);
  }
  return kOk;
}

}  // namespace

void add_graph(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<GraphOptions>();
  CLI::App* command = app.add_subcommand(
      "graph", "Show the nodes and dependencies of the live robot, or of a rule file");
  auto* rules =
      command
          ->add_option(
              "RULES", options->rules,
              "Show this rule file's components, declared dependencies and rules, without a robot")
          ->type_name("FILE");
  auto* json = command->add_flag("--json", options->json, "As one JSON object");
  command
      ->add_flag("--dot", options->dot, "For Graphviz: culprit graph --dot | dot -Tsvg > robot.svg")
      ->excludes(json);
  command
      ->add_option("--why", options->why,
                   "Show the path by which one of two nodes depends on the other")
      ->type_name("NODE")
      ->expected(2)
      ->excludes(json)
      ->excludes(rules);
  add_seconds(*command, "--wait", options->wait_seconds, "How long to look", 0.1, 600)
      ->excludes(rules);
  command->callback([options, &exit_code] { exit_code = show_graph(*options); });
}

}  // namespace culprit::cli
