#include "init/launch_dump.h"

#include <algorithm>
#include <cctype>

#include <yaml-cpp/yaml.h>

#include "base/name_grammar.h"

namespace culprit::init {
namespace {

std::string text_at(const YAML::Node& map, const char* key) {
  const YAML::Node value = map[key];
  return value && value.IsScalar() ? value.Scalar() : "";
}

// "/ns" and "node" are "/ns/node"; names that are whole already stay so.
std::string full_name(const std::string& name_space, const std::string& name) {
  if (name.starts_with('/')) return name;
  std::string full = name_space.starts_with('/') ? name_space : "/" + name_space;
  if (!full.ends_with('/')) full += '/';
  return full + name;
}

bool is_number_or_truth(const std::string& text) {
  YAML::Node node(text);
  bool truth = false;
  double number = 0;
  return YAML::convert<bool>::decode(node, truth) || YAML::convert<double>::decode(node, number);
}

std::string text_as_yaml(const std::string& text) {
  YAML::Emitter out;
  out << YAML::DoubleQuoted << text;
  return out.c_str();
}

// Dumps write texts and what looks like numbers alike; a launch file takes what looks like a number for one.
std::string scalar_as_yaml(const YAML::Node& value) {
  const auto text = value.as<std::string>();
  return is_number_or_truth(text) ? text : text_as_yaml(text);
}

// `is_text`: it is known to be one.
std::string value_as_yaml(const YAML::Node& value, bool is_text = false) {
  const auto scalar = [&](const YAML::Node& each) {
    return is_text ? text_as_yaml(each.as<std::string>()) : scalar_as_yaml(each);
  };
  if (!value.IsSequence()) return scalar(value);
  std::string all;
  for (const auto& each : value) all += (all.empty() ? "" : ", ") + scalar(each);
  return "[" + all + "]";
}

// The names of packages and classes, which stand in the draft as they are.
bool is_word(const std::string& text) {
  return std::ranges::all_of(text, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == ':' || c == '/' || c == '.' || c == '-';
  });
}

// {name: value}, or [[name, value], ...]; [name, value, "text"] of composed_nodes_of_launch (owners/launch_file.h).
std::vector<std::pair<std::string, std::string>> parameters_in(const YAML::Node& all) {
  std::vector<std::pair<std::string, std::string>> found;
  for (const auto& each : all) {
    if (all.IsMap()) {
      found.emplace_back(each.first.as<std::string>(), value_as_yaml(each.second));
    } else {
      found.emplace_back(each[0].as<std::string>(), value_as_yaml(each[1], each.size() > 2));
    }
  }
  return found;
}

// [{from: a, to: b}, ...], or [[a, b], ...].
std::vector<std::pair<std::string, std::string>> remaps_in(const YAML::Node& all) {
  std::vector<std::pair<std::string, std::string>> found;
  for (const auto& each : all) {
    if (each.IsMap()) {
      found.emplace_back(text_at(each, "from"), text_at(each, "to"));
    } else {
      found.emplace_back(each[0].as<std::string>(), each[1].as<std::string>());
    }
  }
  return found;
}

void take_recipe(const std::string& node, const std::string& container, const YAML::Node& how,
                 const std::string& package, LaunchDump& dump) {
  const std::string plugin = text_at(how, "plugin");
  if (!is_valid_topic_name(node) || !is_valid_topic_name(container) || plugin.empty()) return;
  if (!is_word(plugin) || !is_word(package)) return;
  dump.recipes[node] = {container, package, plugin, parameters_in(how["params"]),
                        remaps_in(how["remaps"])};
}

LaunchDump from_model(const YAML::Node& nodes) {
  LaunchDump dump;
  for (const auto& each : nodes) {
    const auto name = each.first.as<std::string>();
    const YAML::Node& how = each.second;
    if (text_at(how, "respawn") == "true") dump.respawned.insert(name);
    take_recipe(name, text_at(how, "container"), how, text_at(how, "pkg"), dump);
  }
  return dump;
}

LaunchDump from_record(const YAML::Node& record) {
  LaunchDump dump;
  for (const char* kind : {"node", "container"}) {
    for (const auto& how : record[kind]) {
      const std::string name = text_at(how, "name");
      if (text_at(how, "respawn") == "true" && !name.empty())
        dump.respawned.insert(full_name(text_at(how, "namespace"), name));
    }
  }
  for (const auto& how : record["load_node"]) {
    const std::string name_space = text_at(how, "namespace");
    take_recipe(full_name(name_space, text_at(how, "node_name")),
                full_name("/", text_at(how, "target_container_name")), how, text_at(how, "package"),
                dump);
  }
  return dump;
}

}  // namespace

Expected<LaunchDump> read_launch_dump(const std::string& text, const std::string& file) {
  try {
    const YAML::Node root = YAML::Load(text);
    if (root.IsMap() && root["structure"] && root["structure"].IsMap() &&
        root["structure"]["nodes"])
      return from_model(root["structure"]["nodes"]);
    if (root.IsMap() && (root["load_node"] || root["node"])) return from_record(root);
  } catch (const YAML::Exception& e) {
    return Error{file + ":" + std::to_string(e.mark.line + 1) + ": " + e.msg};
  }
  return Error{file +
               " is no dump of a launch file that culprit reads: the system_model.yaml of "
               "play_launch, or its record.json"};
}

}  // namespace culprit::init
