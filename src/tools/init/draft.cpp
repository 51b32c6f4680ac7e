#include "init/draft.h"

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "base/name_grammar.h"
#include "base/ros_names.h"
#include "base/tool_names.h"
#include "base/units.h"
#include "init/diagnostic_rules.h"
#include "init/draft_names.h"
#include "init/launch_text.h"
#include "init/marks.h"
#include "init/movement.h"
#include "init/packs.h"
#include "init/silence.h"
#include "init/values.h"
#include "language/reserved_words.h"

namespace culprit::init {
namespace {

// Node names are unique by their path only: "/left/wheel" and "/right/wheel".
std::map<std::string, std::string> component_names(const std::vector<std::string>& nodes,
                                                   const KnownNames& known) {
  std::map<std::string, int> uses;
  for (const std::string& node : nodes) ++uses[own_name(node)];
  std::map<std::string, std::string> names;
  std::set<std::string> taken = known.taken;
  taken.insert(reserved_words().begin(), reserved_words().end());
  for (const std::string& node : nodes) {
    if (const auto named = known.components.find(node); named != known.components.end()) {
      names[node] = named->second;
      continue;
    }
    std::string name = uses[own_name(node)] > 1 ? node.substr(1) : own_name(node);
    std::replace(name.begin(), name.end(), '/', '_');
    while (!taken.insert(name).second) name += "_node";
    names[node] = name;
  }
  return names;
}

// Recipes of containers for which the dump knows how all of their nodes are loaded: a replaced container must load them all again.
std::map<std::string, Recipe> usable_recipes(const RobotProfile& seen) {
  std::map<std::string, Recipe> usable;
  const auto& nodes = seen.robot.nodes;
  for (const auto& each_known : seen.dump.recipes) {
    const auto& name = each_known.first;
    const Recipe& recipe = each_known.second;
    const auto container = nodes.find(recipe.container);
    if (container == nodes.end() || container->second.pid == 0) continue;
    const bool knows_all = std::ranges::all_of(nodes, [&](const auto& each) {
      const auto known = seen.dump.recipes.find(each.first);
      return each.second.pid != container->second.pid || each.first == recipe.container ||
             is_tool_node(each.first) || seen.dump.is_of_running ||
             (known != seen.dump.recipes.end() && known->second.container == recipe.container);
    });
    const auto node = nodes.find(name);
    if (knows_all && node != nodes.end() && node->second.pid == container->second.pid)
      usable[name] = recipe;
  }
  return usable;
}

// The sections of a parameter file of culprit's, by the line above each: "/node:\n".
std::map<std::string, std::string> sections_in(const std::string& text) {
  std::map<std::string, std::string> sections;
  std::string* section = nullptr;
  for (std::size_t at = 0, end = 0; at < text.size(); at = end) {
    end = std::min(text.find('\n', at), text.size() - 1) + 1;
    const std::string line = text.substr(at, end - at);
    if (line.starts_with('/'))
      section = &sections[line];
    else if (section != nullptr)
      *section += line;
  }
  return sections;
}

// "ros2 bag", "rqt_graph": people look with it, and it is no part of the robot. Nothing: it may be one.
std::optional<std::string> tool_in(const Start& start) {
  constexpr std::array kTools = {"rqt", "rviz", "plotjuggler", "foxglove-studio"};
  constexpr std::array kOfRobots = {"run", "launch",
                                    "component"};  // verbs of ros2 that start nodes
  for (std::size_t i = 0; i < std::min<std::size_t>(2, start.command.size()); ++i) {
    const std::string& word = start.command[i];
    const std::string name = word.substr(word.rfind('/') + 1);
    const bool has_verb = name == "ros2" && i + 1 < start.command.size();
    if (has_verb && std::ranges::find(kOfRobots, start.command[i + 1]) == kOfRobots.end())
      return "ros2 " + start.command[i + 1];
    if (std::ranges::any_of(kTools, [&](const char* tool) { return name.starts_with(tool); }))
      return name;
  }
  return std::nullopt;
}

// Nodes that the tools of ROS 2 make for a command: "/_ros2cli_4711".
bool is_of_command_line(const std::string& node) { return own_name(node).starts_with("_ros2cli"); }

class Draft {
 public:
  Draft(const RobotProfile& seen, Packs packs, const KnownNames& known)
      : seen_(seen), recipes_(usable_recipes(seen)) {
    for (const std::string& name : seen_.left) {
      if (!is_tool_node(name))
        left_out_.push_back(name +
                            ": it left while culprit watched. If it is part of the robot, "
                            "draft again while it is there");
    }
    for (const auto& [name, node] : seen_.robot.nodes) {
      if (is_of_command_line(name))
        left_out_.push_back(name + ": it is a command line tool, as ros2 topic echo");
      if (is_tool_node(name) || !is_valid_topic_name(name)) continue;
      if (const std::string main = main_of(name, node); main != name) {
        if (node.parameters) others_[main].push_back(name);
      } else if (const auto why = why_not(name, node)) {
        if (!known.components.contains(name)) left_out_.push_back(name + ": " + *why);
      } else {
        nodes_.push_back(name);
      }
    }
    names_ = component_names(nodes_, known);
    for (const std::string& node : nodes_) {
      for (const std::string& other : others_[node]) names_.emplace(other, names_.at(node));
    }
    for (const std::string& name : known.taken) declared_.take(name);
    for (const std::string& node : nodes_) {
      declared_.take(names_.at(node));
      declared_.take(names_.at(node), "_failed");
    }
    if (packs == Packs::kChosen) packs_ = packs_for(seen_, names_, left_out_);
  }

  std::vector<Part> parts() {
    head();
    includes();
    notes_on_starts();
    for (const std::string& node : nodes_) component(node);
    for (const PackUse& each : packs_) use(each);
    for (const std::string& node : nodes_) {
      if (pack_of(node) == nullptr) rule(node);
    }
    topics_without_rule();
    for (Part& each : limits(seen_, declared_, left_out_)) parts_.push_back(std::move(each));
    for (Part& each : values(seen_, declared_)) parts_.push_back(std::move(each));
    add(Part::Kind::kInterlock, kAll, interlocks_text(seen_, declared_));
    if (!left_out_.empty()) {
      std::string text = "# Left out, since it could not be found out:\n";
      // A command line and a variable may have lines of their own, which would be rules.
      for (const std::string& each : left_out_) text += "# " + escape_controls(each) + "\n";
      add(Part::Kind::kLeftOut, kAll, text);
    }
    return std::move(parts_);
  }

 private:
  // The node of its process that the component is declared by: the node itself if it is alone, or if
  // its process loads components. One that has told its parameters answers; one with a shorter path is
  // seldom made by another.
  std::string main_of(const std::string& name, const LiveInventory::Node& node) const {
    if (node.pid == 0 || recipes_.contains(name) || !container_of(node.pid).empty()) return name;
    const auto rank = [](const std::string& each, const LiveInventory::Node& its) {
      return std::tuple(!its.parameters.has_value(), std::ranges::count(each, '/'), each.size(),
                        each);
    };
    auto best = rank(name, node);
    for (const auto& [other, its] : seen_.robot.nodes) {
      if (its.pid == node.pid && !is_tool_node(other) && is_valid_topic_name(other))
        best = std::min(best, rank(other, its));
    }
    return std::get<3>(best);
  }

  // The node of the process that loads components; empty: none.
  std::string container_of(int pid) const {
    for (const auto& node : seen_.robot.nodes) {
      const std::string& name = node.first;
      const bool loads = seen_.robot.services.contains(name + "/_container/load_node") ||
                         std::ranges::any_of(seen_.dump.recipes, [&](const auto& each) {
                           return each.second.container == name;
                         });
      if (node.second.pid == pid && loads) return name;
    }
    return "";
  }

  // Why it cannot be started again; nothing if it can.
  std::optional<std::string> why_not(const std::string& name,
                                     const LiveInventory::Node& node) const {
    if (node.pid == 0)
      return "its process is not on this machine, or of another user. Name its owner: "
             "LAUNCH, UNIT or CONTAINER";
    if (recipes_.contains(name)) return std::nullopt;
    const auto start = seen_.starts.find(name);
    const auto tool = start == seen_.starts.end() ? std::nullopt : tool_in(start->second);
    if (tool) return "it is a tool (" + *tool + "), no part of the robot";
    if (seen_.came_late.contains(name))
      return "it came while culprit watched. If it is part of the robot, draft again, or use "
             "--update";
    if (start == seen_.starts.end())
      return fmt::format("it could not be read how process {} was started", node.pid);
    const std::string container = container_of(node.pid);
    for (const auto& [other, its] : seen_.robot.nodes) {
      if (container.empty() || other == name || its.pid != node.pid || is_tool_node(other) ||
          recipes_.contains(other))
        continue;
      if (knows_all_in(container)) {
        if (name == container) continue;
        return "a component in " + container + " made it";
      }
      if (name == container)
        return fmt::format(
            "it loads {}, and how is not known: give a dump of its launch file: "
            "--launch",
            other);
      return fmt::format(
          "it lives in process {} with {}. Write what loads it: IN {} PLUGIN ..., "
          "or give a dump of its launch file: --launch",
          node.pid, container, container);
    }
    if (start->second.declare.starts_with("CONTAINER"))
      return start->second.owner + " runs it. Write CONTAINER with the engine and its name there";
    return std::nullopt;
  }

  // Whether the components of the container are known, of the launch that runs.
  bool knows_all_in(const std::string& container) const {
    return seen_.dump.is_of_running && std::ranges::any_of(recipes_, [&](const auto& each) {
             return each.second.container == container;
           });
  }

  void add(Part::Kind kind, std::string subject, std::string text) {
    if (!text.empty())
      parts_.push_back({.kind = kind, .subject = std::move(subject), .text = std::move(text)});
  }

  void head() {
    add(Part::Kind::kHead, "",
        fmt::format(
            "# Drafted by `culprit init` from what domain {} showed in {}, while it was taken "
            "to be well.\n# What culprit guessed is marked \"guess\". Read it, then try it: "
            "culprit run --dry-run FILE\n",
            seen_.domain, to_string(seen_.looked)));
    add(Part::Kind::kHead, "", "CYCLE 200ms\n");
  }

  void includes() {
    std::set<std::string> files;
    for (const PackUse& each : packs_) files.insert(each.pack);
    std::string text;
    for (const std::string& file : files) text += include_of(file) + "\n";
    add(Part::Kind::kHead, "", text);
  }

  void use(const PackUse& pack) {
    // Not the rates in it: they are never measured twice the same.
    const std::string node = pack.nodes.empty() ? "" : *pack.nodes.begin();
    const std::string about =
        node.empty() ? pack.call : pack.call.substr(0, pack.call.find('(')) + " " + node;
    add(pack.is_proposal ? Part::Kind::kComment : Part::Kind::kUse, about,
        fmt::format("# {}: {}.\n{}{}USE {}\n", pack.is_proposal ? "proposal" : "guess",
                    pack.evidence, pack.group, pack.is_proposal ? "#   " : "", pack.call));
    parts_.back().pack = pack.pack;
    parts_.back().node = node;
  }

  // Which sees its loss and silence; null: none.
  const PackUse* pack_of(const std::string& node) const {
    const auto found = std::ranges::find_if(
        packs_, [&](const PackUse& each) { return each.nodes.contains(node); });
    return found == packs_.end() ? nullptr : &*found;
  }

  // Notes the launchers of the nodes, and the variables of their environment that the draft does
  // not repeat.
  void notes_on_starts() {
    std::map<std::string, std::vector<std::string>> launchers;
    std::set<std::string> withheld;
    for (const std::string& node : nodes_) {
      if (recipes_.contains(node)) continue;
      const Start& start = seen_.starts.at(node);
      if (!start.declare.empty()) continue;
      if (!start.owner.empty() && !seen_.dump.respawned.contains(node))
        launchers[start.owner].push_back(names_.at(node));
      withheld.insert(start.withheld.begin(), start.withheld.end());
    }
    std::string text;
    for (const auto& [owner, components] : launchers)
      text += fmt::format(
          "# guess: {} started {}. If it restarts nodes that exit, add RESPAWNED to them.\n", owner,
          fmt::join(components, ", "));
    if (!withheld.empty())
      text +=
          fmt::format("# Variables of theirs that are not copied, for they may be secrets: {}\n",
                      escape_controls(fmt::format("{}", fmt::join(withheld, ", "))));
    add(Part::Kind::kHead, "", text);
  }

  void component(const std::string& node) {
    const PackUse* pack = pack_of(node);
    const bool is_managed = !seen_.robot.nodes.at(node).lifecycle.empty();
    add(Part::Kind::kComponent, node,
        "COMPONENT " + names_.at(node) + " NODE " + all_nodes(node) + " " + owner_of(node) +
            (pack != nullptr && pack->has_launcher && is_managed ? " LIFECYCLE launcher\n" : "\n"));
  }

  // With the others of its process.
  std::string all_nodes(const std::string& node) const {
    const auto others = others_.find(node);
    const bool is_alone = others == others_.end() || others->second.empty();
    return is_alone ? node : fmt::format("{} {}", node, fmt::join(others->second, " "));
  }

  std::string owner_of(const std::string& node) const {
    if (const auto recipe = recipes_.find(node); recipe != recipes_.end())
      return composed_text(recipe->second, seen_.parameter_file);
    const Start& start = seen_.starts.at(node);
    if (!start.declare.empty()) return start.declare;
    return launch_text(start) + (seen_.dump.respawned.contains(node) ? " RESPAWNED" : "");
  }

  void rule(const std::string& node) {
    const std::string& name = names_.at(node);
    const bool is_managed = seen_.robot.nodes.at(node).lifecycle == "active";
    std::string text;
    std::string trigger = "!alive(" + name + ")";
    for (const auto& each : seen_.robot.topics) {
      const std::string& topic = each.first;
      const auto publisher = watched_publisher(name, topic);
      if (!publisher) continue;
      const auto limit = silence_of(seen_, topic, *publisher);
      if (!limit) continue;
      text += evidence_of_silence(seen_, topic, *publisher);
      trigger += " || age(" + topic + (publisher->empty() ? "" : " FROM " + name) + ") > " +
                 to_string(*limit);
    }
    text += "RULE " + name + "_failed\n  POLICIES ERROR\n  TRIGGER " + trigger + "\n";
    text += "    # guess: how often it helps, in percent; culprit learns that from every attempt\n";
    if (is_managed) text += strategy(name, "restart", 50, 10);
    add(Part::Kind::kRule, node, text + strategy(name, "redeploy", 90, 25));
  }

  std::string component_of(const std::string& node) const {
    const auto found = names_.find(node);
    return found == names_.end() ? "" : found->second;
  }

  // The node of the component whose messages on that topic show that it is silent, if others publish it, too; empty: the
  // component alone publishes it. Nothing: its silence shows nothing. Bonds come and go with the states of their nodes.
  std::optional<std::string> watched_publisher(const std::string& component,
                                               const std::string& topic) const {
    const LiveInventory::Topic& what = seen_.robot.topics.at(topic);
    if (is_topic_of_ros(topic) || !is_valid_topic_name(topic) || what.type == "bond/msg/Status")
      return std::nullopt;
    std::vector<std::string> own;
    for (const std::string& node : what.publishers) {
      if (component_of(node) == component) own.push_back(node);
    }
    if (own.empty()) return std::nullopt;
    if (own.size() == what.publishers.size()) return "";
    return own.size() == 1 ? std::optional(own.front()) : std::nullopt;
  }

  // The impact is in cycles: until the failure is gone.
  static std::string strategy(const std::string& name, const std::string& what, int percent,
                              int impact) {
    return fmt::format("    STRATEGY {0}_{1} {2} 10\n      ADAPTATION {0} {1} {3}\n", name, what,
                       percent, impact);
  }

  // Whether the nodes belong to more than one component, as far as they are declared.
  bool are_of_several(const std::set<std::string>& nodes) const {
    std::set<std::string> components;
    for (const std::string& node : nodes) {
      const auto component = names_.find(node);
      components.insert(component == names_.end() ? node : component->second);
    }
    return components.size() > 1;
  }

  void topics_without_rule() {
    for (const auto& [name, what] : seen_.robot.topics) {
      const std::string& topic = name;  // for the lambda: clang 14 captures no bindings
      if (is_topic_of_ros(topic) || !what.is_published()) continue;
      if (are_of_several(what.publishers)) {
        const bool has_rule = std::ranges::any_of(what.publishers, [&](const std::string& node) {
          return names_.contains(node) && pack_of(node) == nullptr &&
                 watched_publisher(component_of(node), topic) && silence_of(seen_, topic, node);
        });
        if (!has_rule)
          left_out_.push_back(topic +
                              ": several nodes publish it, so its silence has no one to blame");
      } else if (const auto limit = silence_of(seen_, topic);
                 !limit && names_.contains(*what.publishers.begin())) {
        left_out_.push_back(topic + ": " + limit.error());
      }
    }
  }

  const RobotProfile& seen_;
  const std::map<std::string, Recipe> recipes_;
  std::vector<std::string> nodes_;
  std::map<std::string, std::vector<std::string>> others_;  // of the same process, by its main node
  std::map<std::string, std::string> names_;
  Names declared_;
  std::vector<std::string> left_out_;
  std::vector<PackUse> packs_;
  std::vector<Part> parts_;
};

}  // namespace

std::vector<Part> parts_of_draft(const RobotProfile& seen, Packs packs, const KnownNames& known) {
  return Draft(seen, packs, known).parts();
}

std::string draft(const RobotProfile& seen, Packs packs) {
  const std::vector<Part> parts = parts_of_draft(seen, packs);
  std::string text;
  std::vector<Mark> marks;
  const Part* before = nullptr;
  for (const Part& part : parts) {
    const bool belongs_to_it = before != nullptr && part.kind == Part::Kind::kComponent &&
                               (before->kind == part.kind || (before->kind == Part::Kind::kHead &&
                                                              before->text.starts_with('#')));
    if (before != nullptr && !belongs_to_it) text += "\n";
    text += part.text;
    before = &part;
    if (const auto mark = mark_of(part)) marks.push_back(*mark);
  }
  return text + (marks.empty() ? "" : "\n" + text_of(marks));
}

std::string parameters_text(const RobotProfile& seen, const std::string& before) {
  std::map<std::string, std::string> sections = sections_in(before);  // by the line above
  bool names_one = false;
  for (const auto& [node, recipe] : usable_recipes(seen)) {
    if (recipe.parameters.empty()) {
      sections.erase(node + ":\n");
      continue;
    }
    names_one = true;
    std::string& section = sections[node + ":\n"] = "  ros__parameters:\n";
    for (const auto& [name, value] : recipe.parameters)
      section += "    \"" + name + "\": " + value + "\n";
  }
  if (!names_one) return "";
  std::string all;
  for (const auto& [node, section] : sections) all += node + section;
  return with_mark(all);
}

}  // namespace culprit::init
