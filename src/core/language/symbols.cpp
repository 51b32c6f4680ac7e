#include "language/symbols.h"

#include <algorithm>
#include <utility>

namespace culprit {
namespace {

// Splits a launch command into its arguments: blanks separate, quotes group, a backslash takes the
// next character as it is. No variables, no globs, no shell.
std::optional<std::vector<std::string>> split_command(std::string_view text) {
  std::vector<std::string> arguments;
  bool inside = false;
  char quote = '\0';
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quote == '\0' && (c == ' ' || c == '\t')) {
      inside = false;
      continue;
    }
    if (!inside) arguments.emplace_back();
    inside = true;
    if (c == '\\' && quote != '\'' && i + 1 < text.size()) {
      arguments.back() += text[++i];
    } else if (quote == '\0' && (c == '"' || c == '\'')) {
      quote = c;
    } else if (c == quote) {
      quote = '\0';
    } else {
      arguments.back() += c;
    }
  }
  if (quote != '\0' || arguments.empty() || arguments.front().empty()) return std::nullopt;
  return arguments;
}

// NAME=value
bool is_assignment(std::string_view text) {
  const std::string_view name = text.substr(0, text.find('='));
  const auto may_be_there = [](unsigned char c) {
    return c < 128 && (std::isalnum(c) || c == '_');
  };
  return name.size() < text.size() && !name.empty() && std::isdigit(name[0]) == 0 &&
         std::all_of(name.begin(), name.end(), may_be_there);
}

// As systemd names them (systemd.unit(5)); a template without its instance is none.
bool is_service_unit(std::string_view name) {
  constexpr std::string_view kSuffix = ".service";
  const auto may_be_there = [](unsigned char c) {
    return c < 128 &&
           (std::isalnum(c) != 0 || std::string_view(":-_.\\@").find(c) != std::string_view::npos);
  };
  return name.size() > kSuffix.size() && name.ends_with(kSuffix) && !name.ends_with("@.service") &&
         name[0] != '@' && std::all_of(name.begin(), name.end(), may_be_there);
}

// For PlaceIndex, which folds what comes of it.
std::size_t mixed(std::size_t hash, std::size_t more) {
  hash = (hash ^ more) * 0x9E3779B97F4A7C15;
  return hash ^ (hash >> 29);
}

std::size_t command_hash(const std::vector<std::string>& command) {
  std::size_t hash = command.size();
  for (const std::string& argument : command) hash = mixed(hash, name_hash(argument));
  return hash;
}

std::size_t parameter_hash(ComponentId component, std::string_view name) {
  return mixed(name_hash(name), component.index);
}

std::size_t input_hash(const Input& input) {
  std::size_t hash = static_cast<std::size_t>(input.kind);
  for (const std::uint32_t id : {input.topic.index, input.signal.index, input.component.index,
                                 input.parameter.index, input.diagnostic.index})
    hash = mixed(hash, id);
  hash = mixed(hash, static_cast<std::size_t>(input.window.count()));
  return mixed(mixed(hash, static_cast<std::size_t>(input.outcome)),
               static_cast<std::size_t>(input.log_level));
}

bool is_same_input(const Input& a, const Input& b) {
  return a.kind == b.kind && a.topic == b.topic && a.signal == b.signal &&
         a.component == b.component && a.parameter == b.parameter && a.diagnostic == b.diagnostic &&
         a.window == b.window && a.outcome == b.outcome && a.log_level == b.log_level;
}

}  // namespace

bool Symbols::first_declaration(const syntax::Name& name, const char* what) {
  const auto component = place_of(name.text, rules_.components, components_);
  const bool is_component = component && rules_.components[*component].declared;
  const bool is_constant = constants_.contains(name.text);
  if (!is_component && !is_constant && !known_signal(name.text)) return true;
  const std::string kind = is_component ? "component" : is_constant ? "constant" : "signal";
  diagnostics_.push_back({Code::kDuplicateName, Severity::kError, name.span,
                          "'" + name.text + "' is a " + kind + " already",
                          std::string("give this ") + what + " another name"});
  return false;
}

void Symbols::declare(const syntax::File& file) {
  components_.reserve(file.components.size());
  components_by_node_.reserve(file.components.size());
  components_by_launch_.reserve(file.components.size());
  signals_.reserve(file.signals.size());
  for (const syntax::Constant& c : file.constants) {
    // Its value follows, in file order: a constant may use the ones before it.
    if (first_declaration(c.name, "constant")) constants_[c.name.text] = {{}, true};
  }
  for (const syntax::Component& c : file.components) {
    if (first_declaration(c.name, "component")) declare_component(c);
  }
  for (const syntax::Signal& s : file.signals) {
    if (first_declaration(s.name, "signal")) declare_signal(s);
  }
  for (const syntax::BrokenDeclaration& broken : file.broken_declarations) {
    if (!broken.name.text.empty()) declare_broken(broken);
  }
  for (const syntax::Group& g : file.groups) {
    if (first_declaration(g.name, "group")) declare_group(g);
  }
  for (const auto& [constant, value] : constants_) declared_values_.push_back(constant);
}

const std::vector<std::string_view>& Symbols::sorted_values() {
  if (!std::exchange(are_values_sorted_, true))
    std::sort(declared_values_.begin(), declared_values_.end());
  return declared_values_;
}

void Symbols::declare_component(const syntax::Component& written) {
  Component component{written.name.text,
                      written.node ? written.node->text : "",
                      {},
                      true,
                      written.is_required,
                      written.lifecycle,
                      written.is_respawned,
                      written.ready.value_or(Duration::zero())};
  if (written.node) declare_node(*written.node, component);
  for (const syntax::Name& other : written.other_nodes) {
    if (declare_node(other, component)) component.other_nodes.push_back(other.text);
  }
  declare_launch(written, component);
  if (written.unit) component.unit = declared_unit(written);
  if (!written.unit && !written.engine) declared_host(written);
  declare_engine(written, component);
  declare_composition(written, component);
  declared_components_.push_back(written.name.text);
  add_component(std::move(component));
}

// Whether no component has it yet.
bool Symbols::declare_node(const syntax::Name& node, const Component& component) {
  const auto first = components_by_node_.find(name_hash(node.text), [&](std::uint32_t place) {
    return place == rules_.components.size() ? component.has_node(node.text)
                                             : rules_.components[place].has_node(node.text);
  });
  if (!first) {
    components_by_node_.add(name_hash(node.text), rules_.components.size());
    return true;
  }
  const bool is_own = *first == rules_.components.size();
  const std::string& owner = is_own ? component.name : rules_.components[*first].name;
  diagnostics_.push_back({Code::kDuplicateName, Severity::kError, node.span,
                          "this node is component '" + owner + "' already",
                          "declare each node once"});
  return false;
}

ComponentId Symbols::add_component(Component component) {
  const ComponentId id(rules_.components.size());
  components_.add(name_hash(component.name), id.index);
  rules_.components.push_back(std::move(component));
  return id;
}

SignalId Symbols::add_signal(Signal signal, std::optional<Type> type) {
  const SignalId id(rules_.signals.size());
  signals_.add(name_hash(signal.name), id.index);
  signal_types_.push_back(types_.add(type));
  rules_.signals.push_back(std::move(signal));
  return id;
}

// The first component that has the same owner; null: the one that is being declared.
const Component* Symbols::other_of_owner(std::string owner) {
  const auto [first, is_new] =
      by_owner_.emplace(std::move(owner), ComponentId(rules_.components.size()));
  return is_new ? nullptr : &rules_[first->second];
}

// The same for those with a LAUNCH command.
const Component* Symbols::other_of_launch(const std::vector<std::string>& command) {
  const std::size_t hash = command_hash(command);
  const auto first = components_by_launch_.find(
      hash, [&](std::uint32_t place) { return rules_.components[place].launch == command; });
  if (first) return &rules_.components[*first];
  components_by_launch_.add(hash, rules_.components.size());
  return nullptr;
}

// ENV, SETUP and CWD are a launch command's, and of nothing else that starts it.
void Symbols::declare_launch(const syntax::Component& written, Component& component) {
  const auto report = [&](const syntax::Name& where, std::string cause, std::string remedy) {
    diagnostics_.push_back(
        {Code::kSyntax, Severity::kError, where.span, std::move(cause), std::move(remedy)});
  };
  if (written.launch) {
    if (auto command = split_command(written.launch->text)) {
      component.launch = std::move(*command);
    } else {
      report(*written.launch, "this is no command",
             "write the program and its arguments; close every quote");
    }
  }
  const auto is_for_launch = [&](const char* word, const Seldom<syntax::Name>& what) {
    if (what && !written.launch)
      report(*what,
             std::string(word) + " is for a LAUNCH, and component '" + written.name.text +
                 "' has none",
             std::string("add LAUNCH \"program arguments\", or leave ") + word + " out");
    return what.has_value();
  };
  const auto whole_path = [&](const syntax::Name& path) {
    const auto blank = path.text.find(' ');
    const std::string word = path.text.substr(0, blank);
    if (blank != std::string::npos && (word == "source" || word == "." || word == "cd"))
      report(path, "this is a command of a shell, and no path",
             "write only the path: " + path.text.substr(path.text.find_first_not_of(' ', blank)));
    else if (!path.text.starts_with('/'))
      report(path, "this path is not whole",
             path.text.starts_with('~') ? "write it from the root, as in /home/robot/ws"
                                        : "write it from the root, with a '/' in front");
    return path.text;
  };
  if (is_for_launch("SETUP", written.setup)) component.setup = whole_path(*written.setup);
  if (is_for_launch("CWD", written.folder)) component.folder = whole_path(*written.folder);
  const auto* same = component.launch.empty() ? nullptr : other_of_launch(component.launch);
  if (same != nullptr)
    diagnostics_.push_back({Code::kTwoOwners, Severity::kWarning, written.launch->span,
                            "component '" + same->name +
                                "' is started by the same command: if it makes both nodes, there "
                                "would be two of each",
                            "leave LAUNCH to one of them, and redeploy that"});
  if (!is_for_launch("ENV", written.environment)) return;
  const auto variables = split_command(written.environment->text);
  if (variables && std::all_of(variables->begin(), variables->end(), is_assignment)) {
    component.environment = *variables;
  } else {
    report(*written.environment, "these are no variables",
           "write them as NAME=value, with blanks between them: ENV \"ROS_DOMAIN_ID=7 LANG=C\"");
  }
}

// On another computer only an owner can start and end it that can be asked over ssh.
std::string Symbols::declared_host(const syntax::Component& written) {
  if (!written.host) return "";
  const std::string& host = written.host->text;
  const auto report = [&](std::string cause, std::string remedy) {
    diagnostics_.push_back(
        {Code::kSyntax, Severity::kError, written.host->span, std::move(cause), std::move(remedy)});
  };
  const auto may_be_there = [](unsigned char c) {
    constexpr std::string_view kOthers = "@._-:%";
    return c < 128 &&
           (std::isalnum(c) != 0 || kOthers.find(static_cast<char>(c)) != std::string_view::npos);
  };
  const auto at = host.find('@');
  const bool is_name = !host.empty() && std::all_of(host.begin(), host.end(), may_be_there) &&
                       std::isalnum(static_cast<unsigned char>(host.front())) != 0 &&
                       (at == std::string::npos ||
                        (at + 1 < host.size() && host.find('@', at + 1) == std::string::npos &&
                         std::isalnum(static_cast<unsigned char>(host[at + 1])) != 0));
  if (!is_name)
    report("this is no host name for ssh",
           "write HOST computer or HOST user@computer; what else it needs, as a port, is for "
           "~/.ssh/config");
  if (!written.unit && !written.engine)
    report("component '" + written.name.text +
               "' has a HOST, but no owner there that could start and end it",
           "declare its UNIT or its CONTAINER on that computer, or leave HOST out");
  return host;
}

// One container runs one component, which has no other owner.
void Symbols::declare_engine(const syntax::Component& written, Component& component) {
  if (!written.engine) return;
  const syntax::Name& name = *written.engine_container;
  const auto report = [&](Code code, const syntax::Name& where, std::string cause,
                          std::string remedy) {
    diagnostics_.push_back(
        {code, Severity::kError, where.span, std::move(cause), std::move(remedy)});
  };
  using Engine = EngineContainer::Engine;
  const bool is_podman = written.engine->text == "podman";
  EngineContainer container{is_podman ? Engine::kPodman : Engine::kDocker, name.text,
                            declared_host(written)};
  if (!is_podman && written.engine->text != "docker")
    report(Code::kSyntax, *written.engine, "this is no engine that culprit knows",
           "write docker or podman, and the container's name: CONTAINER podman slam");
  const auto may_be_there = [](unsigned char c) {
    return c < 128 && (std::isalnum(c) != 0 || c == '_' || c == '.' || c == '-');
  };
  if (std::isalnum(static_cast<unsigned char>(container.name[0])) == 0 ||
      !std::all_of(container.name.begin(), container.name.end(), may_be_there))
    report(Code::kSyntax, name, "this is no name of a container",
           "write it as " + written.engine->text + " ps shows it");
  const char* other = written.launch         ? "LAUNCH"
                      : written.unit         ? "UNIT"
                      : written.is_respawned ? "RESPAWNED"
                                             : nullptr;
  if (other != nullptr)
    report(Code::kTwoOwners, name,
           "component '" + written.name.text + "' has both CONTAINER and " + other +
               ", but only one program may start it",
           std::string("keep CONTAINER if its engine starts it; otherwise keep ") + other);
  const auto* same = other_of_owner(std::string(is_podman ? "podman" : "docker") + '\0' +
                                    container.host + '\0' + container.name);
  if (same != nullptr)
    report(Code::kTwoOwners, name,
           "this container runs component '" + same->name + "' already, and would end with it",
           "give each component a container of its own, or leave one of them without");
  component.engine = std::move(container);
}

// PLUGIN, PACKAGE, PARAMETERS and REMAP say how it is loaded, and IN by whom; its NODE is the name
// that it is loaded under.
void Symbols::declare_composition(const syntax::Component& written, Component& component) {
  const auto report = [&](const syntax::Name& where, std::string cause, std::string remedy,
                          Code code = Code::kSyntax) {
    diagnostics_.push_back(
        {code, Severity::kError, where.span, std::move(cause), std::move(remedy)});
  };
  if (!written.container) {
    for (const auto& [word, what] : {std::pair("PLUGIN", &written.plugin),
                                     {"PACKAGE", &written.package},
                                     {"PARAMETERS", &written.parameters},
                                     {"REMAP", &written.remaps}}) {
      if (*what)
        report(**what, std::string(word) + " is for a component that a container loads",
               written.launch && what == &written.remaps
                   ? "write it in LAUNCH: --ros-args -r " + (*what)->text
                   : "add IN and the full name of the container's node: IN /container");
    }
    return;
  }
  const std::string self = "component '" + written.name.text + "'";
  Composition composed{written.container->text, {}, {}};
  const char* other = written.launch         ? "LAUNCH"
                      : written.unit         ? "UNIT"
                      : written.engine       ? "CONTAINER"
                      : written.is_respawned ? "RESPAWNED"
                                             : nullptr;
  if (other != nullptr)
    report(*written.container,
           self + " has both IN and " + other + ", but only one program may start it",
           std::string("keep IN if the container loads it; otherwise keep ") + other,
           Code::kTwoOwners);
  if (!written.node) {
    report(*written.container, self + " has no NODE to be loaded as", "add NODE and its full name");
  } else if (written.node->text == composed.container) {
    report(*written.container, "a node cannot be loaded into itself",
           "write the full name of the node that loads it");
  }
  if (!written.plugin) {
    report(*written.container, self + " has no PLUGIN, so its container cannot load it again",
           "add PLUGIN package::Class, as ros2 component types shows it");
  } else {
    composed.plugin = written.plugin->text;
    composed.package = composed.plugin.substr(0, composed.plugin.find("::"));
    if (composed.package.empty() || (composed.package == composed.plugin && !written.package))
      report(*written.plugin, "this class does not say which package has it",
             "write package::Class, or add PACKAGE");
  }
  if (written.package) composed.package = written.package->text;
  if (written.parameters) {
    composed.parameters = written.parameters->text;
    if (!composed.parameters.starts_with('/'))
      report(*written.parameters, "this path is not whole",
             "write it from the root, with a '/' in front");
  }
  if (written.remaps) {
    const auto remaps = split_command(written.remaps->text);
    const auto is_remap = [](std::string_view text) {
      const std::size_t at = text.find(":=");
      return at != std::string_view::npos && at > 0 && at + 2 < text.size();
    };
    if (remaps && std::all_of(remaps->begin(), remaps->end(), is_remap)) {
      composed.remaps = *remaps;
    } else {
      report(*written.remaps, "these are no remappings",
             "write them as from:=to, with blanks between them: REMAP \"image:=/camera/image\"");
    }
  }
  component.composed = std::move(composed);
}

// One unit runs one component, which has no other owner.
SystemdUnit Symbols::declared_unit(const syntax::Component& written) {
  const syntax::Name& name = *written.unit;
  const auto report = [&](Code code, std::string cause, std::string remedy) {
    diagnostics_.push_back(
        {code, Severity::kError, name.span, std::move(cause), std::move(remedy)});
  };
  SystemdUnit unit{name.text, written.is_users_unit, declared_host(written)};
  if (!is_service_unit(unit.name)) {
    report(Code::kSyntax, "this is no service of systemd",
           unit.name.find_first_of("./@") == std::string::npos
               ? "write " + unit.name + ".service"
               : "write its whole name, as systemctl list-units does: UNIT lidar.service");
  } else if (written.launch || written.is_respawned) {
    const std::string other = written.launch ? "LAUNCH" : "RESPAWNED";
    report(Code::kTwoOwners,
           "component '" + written.name.text + "' has both UNIT and " + other +
               ", but only one program may start it",
           "keep UNIT if systemd starts it; otherwise keep " + other);
  }
  const auto* same = other_of_owner(std::string(unit.is_of_user ? "user" : "system") + '\0' +
                                    unit.host + '\0' + unit.name);
  if (same != nullptr) {
    report(Code::kTwoOwners,
           "this unit runs component '" + same->name + "' already, and would end with it",
           "give each component a unit of its own, or leave one of them without");
  }
  return unit;
}

// "pose/position/x"
void Symbols::check_field(const syntax::Name& field) {
  if (field.text.starts_with('.') && field.text.size() > 1) {
    const std::string meant = field.text.substr(1);
    diagnostics_.push_back({Code::kSyntax, Severity::kError, field.span,
                            "a path of fields begins with no '.'", "write " + meant,
                            Edit{field.span, meant}});
    return;
  }
  if (field.text.find("[-") != std::string::npos) {
    diagnostics_.push_back({Code::kSyntax, Severity::kError, field.span,
                            "elements count from 0, from the front",
                            "write its number, as in ranges[0]"});
    return;
  }
  if (field.text.find('/') == std::string::npos ||
      field.text.find_first_of("[(") != std::string::npos)
    return;
  std::string meant = field.text.substr(field.text.starts_with('/') ? 1 : 0);
  std::replace(meant.begin(), meant.end(), '/', '.');
  diagnostics_.push_back({Code::kSyntax, Severity::kError, field.span,
                          "a path of fields has dots, and no '/'", "write " + meant,
                          Edit{field.span, meant}});
}

void Symbols::declare_signal(const syntax::Signal& s) {
  Signal signal{s.name.text, LookedUp{}, Type::kDouble, s.stale, {}};
  std::optional<ComponentId> publisher;
  if (s.from) publisher = component(*s.from);
  if (const auto* d = std::get_if<syntax::DiagnosticSource>(&s.source)) {
    signal.source = DiagnosticKey{d->status.text, d->key.text, publisher};
  } else if (const auto* t = std::get_if<syntax::TopicSource>(&s.source)) {
    check_field(t->field);
    signal.source = TopicField{topic(t->topic.text, publisher), t->field.text};
  } else {
    const auto& p = std::get<syntax::ParameterSource>(s.source);
    signal.source = parameter(component(p.component), p.parameter.text);
  }
  if (s.range) {
    if (s.range->low >= s.range->high) {
      diagnostics_.push_back({Code::kEmptyRange, Severity::kError, s.range->span,
                              "this range holds no values", "write the smaller number first"});
    }
    signal.range = {s.range->low, s.range->high};
  }
  declared_values_.push_back(s.name.text);
  add_signal(std::move(signal), s.range ? std::optional(Type::kDouble) : std::nullopt);
}

// Nothing: the file does not declare it, which is an error here. A group is started in an order, so what
// belongs to it has to be certain.
std::optional<ComponentId> Symbols::declared_part(const syntax::Name& name,
                                                  const std::string& what) {
  const auto known = known_component(name.text);
  if (known && rules_[*known].declared) return known;
  const std::string near = near_name(name.text, declared_components_);
  diagnostics_.push_back(
      {Code::kBadGroup, Severity::kError, name.span, what + " '" + name.text + "' is not declared",
       near.empty() ? "declare it: COMPONENT " + name.text + " NODE /" + name.text
                    : "did you mean '" + near + "'?",
       replacement(name.span, near)});
  return std::nullopt;
}

void Symbols::declare_group(const syntax::Group& written) {
  const auto report = [&](const syntax::Name& where, std::string cause, std::string remedy) {
    diagnostics_.push_back(
        {Code::kBadGroup, Severity::kError, where.span, std::move(cause), std::move(remedy)});
  };
  Group group{written.name.text, {}, {}, {}};
  for (const syntax::Name& name : written.members) {
    const auto member = declared_part(name, "component");
    if (!member) continue;
    if (std::ranges::find(group.members, *member) != group.members.end()) {
      report(name, "'" + name.text + "' is twice in group '" + group.name + "'",
             "name each component once, in the order in which the manager starts them");
      continue;
    }
    group.members.push_back(*member);
  }
  if (const auto manager = declared_part(written.manager, "the manager")) {
    group.manager = *manager;
    if (std::ranges::find(group.members, *manager) != group.members.end())
      report(written.manager,
             "'" + written.manager.text + "' manages group '" + group.name + "' and is in it",
             "take it out of the braces");
  }
  declared_values_.push_back(written.name.text);
  group.health =
      add_signal({group.name, GroupId(rules_.groups.size()), Type::kString, {}, {}}, Type::kString);
  rules_.groups.push_back(std::move(group));
}

std::optional<GroupId> Symbols::group(const syntax::Name& name) {
  std::vector<std::string_view> groups;
  for (std::size_t g = 0; g < rules_.groups.size(); ++g) {
    if (rules_.groups[g].name == name.text) return GroupId(g);
    groups.push_back(rules_.groups[g].name);
  }
  if (broken_signals_.contains(name.text)) return std::nullopt;  // it may have been declared as one
  const std::string near = near_name(name.text, groups);
  diagnostics_.push_back(
      {Code::kBadGroup, Severity::kError, name.span, "'" + name.text + "' is no group",
       !near.empty() ? "did you mean '" + near + "'?"
       : known_component(name.text)
           ? "it is a component: name the group that it belongs to, or activate it"
           : "declare it: GROUP " + name.text + " { planner, controller } MANAGER manager",
       replacement(name.span, near)});
  return std::nullopt;
}

// There is an error, so the rule set will not be used; only the names have to be there.
void Symbols::declare_broken(const syntax::BrokenDeclaration& broken) {
  using Broken = syntax::BrokenDeclaration::Kind;
  const std::string& name = broken.name.text;
  switch (broken.kind) {
    case Broken::kConstant:
      constants_.try_emplace(name, Constant{{}, true});
      return;
    case Broken::kComponent:
      if (place_of(name, rules_.components, components_)) return;
      declared_components_.push_back(name);
      // Whether it has a LAUNCH command is not known, so no check may report it as missing.
      add_component({name, "", {""}, true});
      return;
    case Broken::kSignal:
      broken_signals_.insert(name);
      if (!known_signal(name)) add_signal({name, LookedUp{}, Type::kDouble, {}, {}});
      return;
  }
}

const Symbols::Constant* Symbols::constant(const std::string& name) const {
  const auto found = constants_.find(name);
  return found == constants_.end() ? nullptr : &found->second;
}

void Symbols::define_constant(const syntax::Name& name, Constant value) {
  constants_[name.text] = std::move(value);
}

std::string Symbols::near_name(const std::string& name,
                               const std::vector<std::string_view>& declared) {
  if (declared.size() > comparisons_left_) return "";
  comparisons_left_ -= declared.size();
  return closest(name, declared);
}

void Symbols::report_undeclared(const syntax::Name& name, const char* what,
                                const std::vector<std::string_view>& declared) {
  const std::string near = near_name(name.text, declared);
  const auto fix = replacement(name.span, near);
  if (strictness_ == Strictness::kStrict) {
    diagnostics_.push_back(
        {Code::kUndeclared, Severity::kError, name.span,
         std::string(what) + " '" + name.text + "' is not declared",
         near.empty() ? "declare it, or check without --strict" : "did you mean '" + near + "'?",
         fix});
  } else if (!near.empty()) {
    near_misses_[name.text] = {near, diagnostics_.size()};
    diagnostics_.push_back({Code::kUnknownName, Severity::kWarning, name.span,
                            std::string(what) + " '" + name.text +
                                "' is not declared and will be looked up on the robot",
                            "did you mean '" + near + "'?", fix});
  }
}

std::optional<ComponentId> Symbols::known_component(std::string_view name) const {
  auto found = place_of(name, rules_.components, components_);
  // A full node name may stand for the component that is declared with it.
  if (!found && name.starts_with('/'))
    found = components_by_node_.find(name_hash(name), [&](std::uint32_t place) {
      return rules_.components[place].has_node(name);
    });
  return found ? std::optional(ComponentId(*found)) : std::nullopt;
}

std::optional<SignalId> Symbols::known_signal(std::string_view name) const {
  const auto found = place_of(name, rules_.signals, signals_);
  return found ? std::optional(SignalId(*found)) : std::nullopt;
}

std::optional<ParameterId> Symbols::known_parameter(ComponentId component,
                                                    std::string_view name) const {
  const auto found = parameters_.find(parameter_hash(component, name), [&](std::uint32_t place) {
    const Parameter& known = rules_.parameters[place];
    return known.component == component && known.name == name;
  });
  return found ? std::optional(ParameterId(*found)) : std::nullopt;
}

bool Symbols::is_group(std::string_view name) const {
  const auto signal = known_signal(name);
  return signal && std::holds_alternative<GroupId>(rules_[*signal].source);
}

// Reports the name once; later uses of it as a component get no message.
ComponentId Symbols::group_as_component(const syntax::Name& name) {
  diagnostics_.push_back({Code::kBadGroup, Severity::kError, name.span,
                          "'" + name.text + "' is a group, and no component",
                          "read it as a signal, as in " + name.text +
                              " != \"active\", and adapt it with start_group, or name one of its "
                              "components"});
  return add_component({name.text, "", {""}, true});
}

ComponentId Symbols::component(const syntax::Name& name) {
  if (const auto known = known_component(name.text)) return *known;
  if (is_group(name.text)) return group_as_component(name);
  report_undeclared(name, "component", declared_components_);
  const bool is_node = name.text.starts_with('/');
  return add_component({name.text, is_node ? name.text : "", {}, false});
}

SignalId Symbols::signal(const syntax::Name& name) {
  if (const auto known = known_signal(name.text)) return *known;
  report_undeclared(name, "signal", sorted_values());
  return add_signal({name.text, LookedUp{}, Type::kDouble, {}, {}});
}

bool Symbols::is_looked_up(const std::string& signal) const {
  const auto found = known_signal(signal);
  return strictness_ == Strictness::kLenient && found &&
         std::holds_alternative<LookedUp>(rules_[*found].source);
}

std::string Symbols::topic_of_signal(std::string_view name) const {
  const auto found = known_signal(name);
  const auto* field = found ? std::get_if<TopicField>(&rules_[*found].source) : nullptr;
  return field != nullptr ? rules_[field->topic].name : "";
}

bool Symbols::is_declared_component(std::string_view name) const {
  return std::ranges::find(declared_components_, name) != declared_components_.end();
}

std::string Symbols::forget_near_miss(const std::string& signal) {
  const auto found = near_misses_.find(signal);
  if (found == near_misses_.end()) return "";
  const NearMiss miss = found->second;
  near_misses_.erase(found);
  forgotten_reports_.insert(miss.report);
  return miss.near;
}

void Symbols::drop_forgotten_reports() {
  if (forgotten_reports_.empty()) return;
  std::vector<Diagnostic> kept;
  for (std::size_t i = 0; i < diagnostics_.size(); ++i) {
    if (!forgotten_reports_.contains(i)) kept.push_back(std::move(diagnostics_[i]));
  }
  diagnostics_ = std::move(kept);
  forgotten_reports_.clear();
}

namespace {

// The entry of `table` that is called so; a new one, if none is.
template <class Entry>
std::uint32_t known_or_new(const std::string& name, std::vector<Entry>& table,
                           PlaceIndex& by_name) {
  if (const auto known = place_of(name, table, by_name)) return *known;
  by_name.add(name_hash(name), table.size());
  table.push_back({name});
  return static_cast<std::uint32_t>(table.size() - 1);
}

}  // namespace

TopicId Symbols::topic(const std::string& name, std::optional<ComponentId> publisher) {
  const auto known = topics_.find(name_hash(name), [&](std::uint32_t place) {
    const Topic& topic = rules_.topics[place];
    return topic.name == name && topic.publisher == publisher;
  });
  const TopicId id(known.value_or(static_cast<std::uint32_t>(rules_.topics.size())));
  if (!known) {
    topics_.add(name_hash(name), id.index);
    rules_.topics.push_back({name, publisher});
  }
  return id;
}

DiagnosticId Symbols::diagnostic(const std::string& name) {
  return DiagnosticId(known_or_new(name, rules_.diagnostics, level_names_));
}

ParameterId Symbols::parameter(ComponentId component, const std::string& name) {
  const auto known = known_parameter(component, name);
  const ParameterId id = known.value_or(ParameterId(rules_.parameters.size()));
  if (!known) {
    parameters_.add(parameter_hash(component, name), id.index);
    rules_.parameters.push_back({component, name});
    parameter_types_.push_back(types_.add(std::nullopt));
  }
  return id;
}

InputId Symbols::input(const Input& wanted) {
  const std::size_t hash = input_hash(wanted);
  const auto known = inputs_.find(
      hash, [&](std::uint32_t place) { return is_same_input(rules_.inputs[place], wanted); });
  const InputId id(known.value_or(static_cast<std::uint32_t>(rules_.inputs.size())));
  if (!known) {
    inputs_.add(hash, id.index);
    rules_.inputs.push_back(wanted);
  }
  return id;
}

}  // namespace culprit
