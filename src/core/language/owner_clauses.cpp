#include "language/owner_clauses.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <string_view>
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

std::size_t command_hash(const std::vector<std::string>& command) {
  std::size_t hash = command.size();
  for (const std::string& argument : command) hash = mixed_hash(hash, name_hash(argument));
  return hash;
}

}  // namespace

void OwnerClauses::read(const syntax::Component& written, Component& component) {
  launch(written, component);
  if (written.unit) component.unit = unit(written);
  if (!written.unit && !written.engine) host(written);
  engine(written, component);
  composition(written, component);
}

// The first component that has the same owner; null: the one that is being declared.
const Component* OwnerClauses::other_of_owner(std::string owner) {
  const auto [first, is_new] =
      by_owner_.emplace(std::move(owner), ComponentId(rules_.components.size()));
  return is_new ? nullptr : &rules_[first->second];
}

// The same for those with a LAUNCH command.
const Component* OwnerClauses::other_of_launch(const std::vector<std::string>& command) {
  const std::size_t hash = command_hash(command);
  const auto first = components_by_launch_.find(
      hash, [&](std::uint32_t place) { return rules_.components[place].launch == command; });
  if (first) return &rules_.components[*first];
  components_by_launch_.add(hash, rules_.components.size());
  return nullptr;
}

// ENV, SETUP and CWD are a launch command's, and of nothing else that starts it.
void OwnerClauses::launch(const syntax::Component& written, Component& component) {
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

// Gives it, whole or not.
std::string OwnerClauses::whole_path(const syntax::Name& path) {
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
}

// On another computer only an owner can start and end it that can be asked over ssh.
std::string OwnerClauses::host(const syntax::Component& written) {
  if (!written.host) return "";
  const std::string& name = written.host->text;
  const auto may_be_there = [](unsigned char c) {
    constexpr std::string_view kOthers = "@._-:%";
    return c < 128 &&
           (std::isalnum(c) != 0 || kOthers.find(static_cast<char>(c)) != std::string_view::npos);
  };
  const auto at = name.find('@');
  const bool is_name = !name.empty() && std::all_of(name.begin(), name.end(), may_be_there) &&
                       std::isalnum(static_cast<unsigned char>(name.front())) != 0 &&
                       (at == std::string::npos ||
                        (at + 1 < name.size() && name.find('@', at + 1) == std::string::npos &&
                         std::isalnum(static_cast<unsigned char>(name[at + 1])) != 0));
  if (!is_name)
    report(*written.host, "this is no host name for ssh",
           "write HOST computer or HOST user@computer; what else it needs, as a port, is for "
           "~/.ssh/config");
  if (!written.unit && !written.engine)
    report(*written.host,
           "component '" + written.name.text +
               "' has a HOST, but no owner there that could start and end it",
           "declare its UNIT or its CONTAINER on that computer, or leave HOST out");
  return name;
}

// One container runs one component, which has no other owner.
void OwnerClauses::engine(const syntax::Component& written, Component& component) {
  if (!written.engine) return;
  const syntax::Name& name = *written.engine_container;
  using Engine = EngineContainer::Engine;
  const bool is_podman = written.engine->text == "podman";
  EngineContainer container{is_podman ? Engine::kPodman : Engine::kDocker, name.text,
                            host(written)};
  if (!is_podman && written.engine->text != "docker")
    report(*written.engine, "this is no engine that culprit knows",
           "write docker or podman, and the container's name: CONTAINER podman slam");
  const auto may_be_there = [](unsigned char c) {
    return c < 128 && (std::isalnum(c) != 0 || c == '_' || c == '.' || c == '-');
  };
  if (std::isalnum(static_cast<unsigned char>(container.name[0])) == 0 ||
      !std::all_of(container.name.begin(), container.name.end(), may_be_there))
    report(name, "this is no name of a container",
           "write it as " + written.engine->text + " ps shows it");
  const char* other = written.launch         ? "LAUNCH"
                      : written.unit         ? "UNIT"
                      : written.is_respawned ? "RESPAWNED"
                                             : nullptr;
  if (other != nullptr)
    report(name,
           "component '" + written.name.text + "' has both CONTAINER and " + other +
               ", but only one program may start it",
           std::string("keep CONTAINER if its engine starts it; otherwise keep ") + other,
           Code::kTwoOwners);
  const auto* same = other_of_owner(std::string(is_podman ? "podman" : "docker") + '\0' +
                                    container.host + '\0' + container.name);
  if (same != nullptr)
    report(name,
           "this container runs component '" + same->name + "' already, and would end with it",
           "give each component a container of its own, or leave one of them without",
           Code::kTwoOwners);
  component.engine = std::move(container);
}

// PLUGIN, PACKAGE, PARAMETERS and REMAP say how it is loaded, and IN by whom; its NODE is the name
// that it is loaded under.
void OwnerClauses::composition(const syntax::Component& written, Component& component) {
  if (!written.container) return check_without_container(written);
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
  plugin(written, composed);
  if (written.parameters) {
    composed.parameters = written.parameters->text;
    if (!composed.parameters.starts_with('/'))
      report(*written.parameters, "this path is not whole",
             "write it from the root, with a '/' in front");
  }
  if (written.remaps) remaps(*written.remaps, composed);
  component.composed = std::move(composed);
}

void OwnerClauses::check_without_container(const syntax::Component& written) {
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
}

void OwnerClauses::plugin(const syntax::Component& written, Composition& composed) {
  if (!written.plugin) {
    report(*written.container,
           "component '" + written.name.text +
               "' has no PLUGIN, so its container cannot load it again",
           "add PLUGIN package::Class, as ros2 component types shows it");
  } else {
    composed.plugin = written.plugin->text;
    composed.package = composed.plugin.substr(0, composed.plugin.find("::"));
    if (composed.package.empty() || (composed.package == composed.plugin && !written.package))
      report(*written.plugin, "this class does not say which package has it",
             "write package::Class, or add PACKAGE");
  }
  if (written.package) composed.package = written.package->text;
}

void OwnerClauses::remaps(const syntax::Name& written, Composition& composed) {
  const auto all = split_command(written.text);
  const auto is_remap = [](std::string_view text) {
    const std::size_t at = text.find(":=");
    return at != std::string_view::npos && at > 0 && at + 2 < text.size();
  };
  if (all && std::all_of(all->begin(), all->end(), is_remap)) {
    composed.remaps = *all;
  } else {
    report(written, "these are no remappings",
           "write them as from:=to, with blanks between them: REMAP \"image:=/camera/image\"");
  }
}

// One unit runs one component, which has no other owner.
SystemdUnit OwnerClauses::unit(const syntax::Component& written) {
  const syntax::Name& name = *written.unit;
  SystemdUnit declared{name.text, written.is_users_unit, host(written)};
  if (!is_service_unit(declared.name)) {
    report(name, "this is no service of systemd",
           declared.name.find_first_of("./@") == std::string::npos
               ? "write " + declared.name + ".service"
               : "write its whole name, as systemctl list-units does: UNIT lidar.service");
  } else if (written.launch || written.is_respawned) {
    const std::string other = written.launch ? "LAUNCH" : "RESPAWNED";
    report(name,
           "component '" + written.name.text + "' has both UNIT and " + other +
               ", but only one program may start it",
           "keep UNIT if systemd starts it; otherwise keep " + other, Code::kTwoOwners);
  }
  const auto* same = other_of_owner(std::string(declared.is_of_user ? "user" : "system") + '\0' +
                                    declared.host + '\0' + declared.name);
  if (same != nullptr) {
    report(name, "this unit runs component '" + same->name + "' already, and would end with it",
           "give each component a unit of its own, or leave one of them without", Code::kTwoOwners);
  }
  return declared;
}

void OwnerClauses::report(const syntax::Name& where, std::string cause, std::string remedy,
                          Code code) {
  diagnostics_.push_back({code, Severity::kError, where.span, std::move(cause), std::move(remedy)});
}

}  // namespace culprit
