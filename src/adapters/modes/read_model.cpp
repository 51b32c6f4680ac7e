#include "modes/read_model.h"

#include <algorithm>
#include <set>
#include <sstream>
#include <stdexcept>

#include <yaml-cpp/yaml.h>

#include "base/name_grammar.h"
#include "language/diagnostic.h"
#include "modes/parts_first.h"

namespace culprit::modes {
namespace {

constexpr std::size_t kLongest = 1 << 20;  // bytes; such a model is not written by hand
constexpr int kDeepest = 8;                // namespaces

// Leaves the reader at the first thing that is wrong; yaml-cpp's own errors leave it likewise.
struct Wrong : std::runtime_error {
  Wrong(const YAML::Mark& at, const std::string& what) : std::runtime_error(what), mark(at) {}
  YAML::Mark mark;
};

[[noreturn]] void fail(const YAML::Node& at, const std::string& what) {
  throw Wrong(at.Mark(), what);
}

std::string suggestion(std::string_view name, const std::vector<std::string_view>& known) {
  const std::string close = closest(name, known);
  return close.empty() ? "" : "; did you mean " + close + "?";
}

template <class T>
std::vector<std::string_view> names_of(const std::vector<T>& all) {
  std::vector<std::string_view> names;
  for (const T& each : all) names.push_back(each.name);
  return names;
}

std::string text_of(const YAML::Node& node, const char* what) {
  if (!node.IsScalar() || node.Scalar().empty()) fail(node, std::string(what) + " is not a word");
  return node.Scalar();
}

// Calls `visit(key, value)` for each entry, and fails where one is there twice.
template <class Visit>
void for_each(const YAML::Node& map, const std::string& what, Visit visit) {
  if (!map.IsMap()) fail(map, what + " must be a mapping: one \"name: ...\" for each entry");
  std::set<std::string> seen;
  for (const auto& entry : map) {
    const std::string key = text_of(entry.first, "a key");
    if (!seen.insert(key).second) fail(entry.first, key + " is there twice");
    visit(key, entry.first, entry.second);
  }
}

// The entry of this name; a null node if there is none.
YAML::Node entry_of(const YAML::Node& map, const std::string& name) {
  for (const auto& entry : map)
    if (entry.first.IsScalar() && entry.first.Scalar() == name) return entry.second;
  return YAML::Node(YAML::NodeType::Undefined);
}

YAML::Node needed(const YAML::Node& map, const std::string& name, const std::string& where) {
  const YAML::Node entry = entry_of(map, name);
  if (!entry.IsDefined()) fail(map, where + " has no '" + name + "'");
  return entry;
}

// A name in the file belongs to the namespace of the others beside it.
std::string full_name(const std::string& name_space, const std::string& name,
                      const YAML::Node& at) {
  const std::string full = name.front() == '/' ? name : name_space + "/" + name;
  if (!is_valid_topic_name(full))
    fail(at, "'" + printable(name) + "' cannot be the name of a node");
  return full;
}

// As the parameter files of ROS 2 read scalars: quoted is text.
Value value_of(const YAML::Node& node) {
  if (!node.IsScalar()) fail(node, "only bool, int, double and string parameters have modes");
  const std::string& text = node.Scalar();
  if (node.Tag() == "!") return text;
  bool flag = false;
  if (YAML::convert<bool>::decode(node, flag)) return flag;
  return value_from_text(text);
}

class Reader {
 public:
  Model read(const YAML::Node& root) {
    read_namespace(root, "", 0);
    if (model_.entities.empty()) fail(root, "there are no systems and no nodes in it");
    for (const Entry& entry : entries_) read_system(entry);
    return std::move(model_);
  }

  std::vector<YAML::Mark> marks() const {
    std::vector<YAML::Mark> marks;
    for (const Entry& entry : entries_) marks.push_back(entry.key.Mark());
    return marks;
  }

 private:
  // Where the entity of the same place in the model is written.
  struct Entry {
    std::size_t entity;
    std::string name_space;
    YAML::Node key;
    YAML::Node fields;
  };

  void read_namespace(const YAML::Node& map, const std::string& name_space, int depth) {
    if (depth > kDeepest) fail(map, "namespaces are nested too deeply");
    for_each(map, "the model",
             [&](const std::string& name, const YAML::Node& key, const YAML::Node& value) {
               const std::string full = full_name(name_space, name, key);
               if (!value.IsMap()) fail(value, full + " must be a mapping with ros__parameters");
               const YAML::Node fields = entry_of(value, "ros__parameters");
               if (!fields.IsDefined()) return read_namespace(value, full, depth + 1);
               read_entity({model_.entities.size(), name_space, key, fields}, full);
             });
  }

  // Reads all but the parts of a system: those are not known yet.
  void read_entity(Entry entry, const std::string& name) {
    if (model_.find(name) != nullptr) fail(entry.key, name + " is there twice");
    if (!entry.fields.IsMap()) fail(entry.fields, name + ": ros__parameters must be a mapping");
    const YAML::Node type = needed(entry.fields, "type", name);
    const std::string kind = text_of(type, "type");
    if (kind != "system" && kind != "node")
      fail(type, "type is '" + kind + "'; there are 'system' and 'node'");
    Entity entity;
    entity.name = name;
    entity.is_system = kind == "system";
    if (entity.is_system) read_parts(entry, entity);
    const YAML::Node modes = needed(entry.fields, "modes", name);
    for_each(modes, "modes",
             [&](const std::string& mode, const YAML::Node& key, const YAML::Node& value) {
               if (entity.modes.empty() && mode != kDefaultMode)
                 fail(key, name + " has no " + std::string(kDefaultMode) +
                               " as its first mode; the others begin as copies of it");
               entity.modes.push_back(entity.modes.empty() ? Mode{} : entity.modes.front());
               entity.modes.back().name = mode;
               if (!entity.is_system) read_parameters(entity, value);
             });
    if (entity.modes.empty())
      fail(modes, name + " has no modes; it needs at least " + kDefaultMode);
    model_.entities.push_back(std::move(entity));
    entries_.push_back(std::move(entry));
  }

  // A list, or words in one text, as the original writes them.
  void read_parts(const Entry& entry, Entity& entity) {
    const YAML::Node parts = needed(entry.fields, "parts", entity.name);
    std::vector<std::string> names;
    if (parts.IsSequence()) {
      for (const auto& part : parts) names.push_back(text_of(part, "a part"));
    } else {
      std::istringstream words(text_of(parts, "parts"));
      for (std::string word; words >> word;) names.push_back(word);
    }
    for (const std::string& name : names) {
      const std::string part = full_name(entry.name_space, name, parts);
      if (std::count(entity.parts.begin(), entity.parts.end(), part) > 0)
        fail(parts, part + " is there twice");
      entity.parts.push_back(part);
    }
  }

  // Reads the parameters of the last mode.
  void read_parameters(Entity& node, const YAML::Node& value) {
    const bool is_default = node.modes.size() == 1;
    Mode& mode = node.modes.back();
    const std::string where = node.name + ", mode " + mode.name;
    if (!value.IsMap()) fail(value, where + " must be a mapping with ros__parameters");
    const YAML::Node parameters = needed(value, "ros__parameters", where);
    for_each(parameters, "ros__parameters",
             [&](const std::string& name, const YAML::Node& key, const YAML::Node& text) {
               const auto known = mode.parameters.find(name);
               if (!is_default && known == mode.parameters.end())
                 fail(key, where + " sets " + name + ", which " + kDefaultMode +
                               " does not; add it there");
               const Value read = value_of(text);
               if (!is_default && known->second.index() != read.index())
                 fail(text, where + ": " + name + " is of another type than in " + kDefaultMode);
               mode.parameters[name] = read;
             });
  }

  void read_system(const Entry& entry) {
    Entity& system = model_.entities[entry.entity];
    if (!system.is_system) return;
    for (const std::string& part : system.parts) {
      if (model_.find(part) == nullptr)
        fail(entry.key, part + ", a part of " + system.name + ", has no entry" +
                            suggestion(part, names_of(model_.entities)));
    }
    std::size_t mode = 0;
    for (const auto& written : entry_of(entry.fields, "modes"))
      read_part_modes(entry, system, mode++, written.second);
    const YAML::Node rules = entry_of(entry.fields, "rules");
    if (rules.IsDefined()) {
      for_each(rules, "rules",
               [&](const std::string& name, const YAML::Node& key, const YAML::Node& value) {
                 system.rules.push_back(read_rule(entry, system, name, key, value));
               });
    }
  }

  void read_part_modes(const Entry& entry, Entity& system, std::size_t index,
                       const YAML::Node& value) {
    Mode& mode = system.modes[index];
    const std::string where = system.name + ", mode " + mode.name;
    if (index > 0) mode.parts = system.modes.front().parts;
    for_each(value, where,
             [&](const std::string& name, const YAML::Node& key, const YAML::Node& target) {
               const std::string part = part_of(entry, system, name, key);
               mode.parts[part] = read_target(target, *model_.find(part));
             });
    for (const std::string& part : system.parts)
      if (!mode.parts.contains(part)) fail(value, where + " says nothing about " + part);
  }

  std::string part_of(const Entry& entry, const Entity& system, const std::string& name,
                      const YAML::Node& at) const {
    const std::string part = full_name(entry.name_space, name, at);
    const std::vector<std::string_view> parts(system.parts.begin(), system.parts.end());
    if (std::find(parts.begin(), parts.end(), part) == parts.end())
      fail(at, name + " is no part of " + system.name + suggestion(part, parts));
    return part;
  }

  static Target read_target(const YAML::Node& at, const Entity& of) {
    const std::string text = text_of(at, "a state");
    const std::string state = text.substr(0, text.find('.'));
    const std::string mode = state.size() == text.size() ? "" : text.substr(state.size() + 1);
    if (state == "inactive" && mode.empty()) return {false, ""};
    if (state != "active")
      fail(at, "'" + text + "' is no state; there are inactive, active and active.MODE");
    Target target{true, mode.empty() ? kDefaultMode : mode};
    if (of.find(target.mode) == nullptr)
      fail(at,
           of.name + " has no mode " + target.mode + suggestion(target.mode, names_of(of.modes)));
    return target;
  }

  Rule read_rule(const Entry& entry, const Entity& system, const std::string& name,
                 const YAML::Node& key, const YAML::Node& value) const {
    const std::string where = system.name + ", rule " + name;
    if (!value.IsMap()) fail(value, where + " must be a mapping");
    Rule rule;
    rule.name = name;
    rule.if_target = read_target(needed(value, "if_target", where), system);
    rule.new_target = read_target(needed(value, "new_target", where), system);
    const YAML::Node part = needed(value, "if_part", where);
    if (!part.IsSequence() || part.size() != 2)
      fail(part, where + ": if_part must be [part, state]");
    rule.part = part_of(entry, system, text_of(part[0], "a part"), part[0]);
    rule.if_part = read_target(part[1], *model_.find(rule.part));
    if (rule.if_target == rule.new_target)
      fail(key, where + " changes nothing: if_target and new_target are the same");
    return rule;
  }

  Model model_;
  std::vector<Entry> entries_;  // by entity
};

std::string place(const std::string& file, const YAML::Mark& mark) {
  if (mark.is_null()) return file + ": ";
  return file + ":" + std::to_string(mark.line + 1) + ":" + std::to_string(mark.column + 1) + ": ";
}

}  // namespace

Expected<Model> read_model(const std::string& file, const std::string& text) {
  if (text.size() > kLongest) return Error{file + ": it is longer than 1 MB"};
  try {
    Reader reader;
    Model model = reader.read(YAML::Load(text));
    const auto marks = reader.marks();
    const auto order = parts_first(model);
    if (!order.circle.empty())
      return Error{place(file, marks[order.circle.front()]) + describe_circle(model, order.circle)};
    Model sorted;
    for (const std::size_t i : order.entities)
      sorted.entities.push_back(std::move(model.entities[i]));
    return sorted;
  } catch (const Wrong& wrong) {
    return Error{place(file, wrong.mark) + wrong.what()};
  } catch (const YAML::Exception& wrong) {
    return Error{place(file, wrong.mark) + "this is no YAML: " + wrong.msg};
  }
}

}  // namespace culprit::modes
