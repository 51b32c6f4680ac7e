#include "language/component_reader.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

namespace culprit {
namespace {
namespace component_reader {

using syntax::Component;
using syntax::Name;

struct Reader {
  LineReader& read;
  const Source& source;
  Scanner& s;
  Component& component;
};

enum class Form { kRosName, kText, kNameOrText };

// A clause may stand once.
struct Clause {
  std::string_view word;
  bool (*is_there)(const Component&);
  bool (*parse)(Reader&, std::string_view what, std::string_view remedy);
  std::string_view what{};  // it names
  std::string_view remedy{};
};

template <auto Slot>
bool has(const Component& component) {
  return static_cast<bool>(component.*Slot);
}

template <auto Slot, Form form>
bool name(Reader& r, std::string_view what, std::string_view remedy) {
  std::optional<Name> found = form == Form::kRosName ? r.read.ros_name(r.s, what)
                              : form == Form::kText  ? r.read.text(r.s, what, remedy)
                                                     : r.read.name_or_text(r.s, what);
  if (!found) return false;
  r.component.*Slot = std::move(*found);
  return true;
}

template <auto Slot>
bool flag(Reader& r, std::string_view, std::string_view) {
  return r.component.*Slot = true;
}

// The node, and the other nodes of the same process.
bool nodes(Reader& r, std::string_view what, std::string_view remedy) {
  if (!name<&Component::node, Form::kRosName>(r, what, remedy)) return false;
  while (!r.s.at_end() && r.source.text()[r.s.position()] == '/') {
    auto node = r.read.ros_name(r.s, "the full name of another node of the process");
    if (!node) return false;
    r.component.other_nodes.push_back(std::move(*node));
  }
  return true;
}

bool unit(Reader& r, std::string_view what, std::string_view remedy) {
  if (!name<&Component::unit, Form::kNameOrText>(r, what, remedy)) return false;
  const Span next = r.s.rest();
  if (constexpr std::string_view kOption = "--user"; r.source.text(next).starts_with(kOption)) {
    const Span option{next.begin, next.begin + static_cast<std::uint32_t>(kOption.size())};
    return r.read.fail(Code::kSyntax, option, "unexpected options after a unit",
                       "did you mean USER?", Edit{option, "USER"});
  }
  r.component.is_users_unit = r.s.peek().text == "USER";
  if (r.component.is_users_unit) r.s.next();
  return true;
}

// ssh has its own place for the port.
bool host(Reader& r, std::string_view what, std::string_view remedy) {
  if (!name<&Component::host, Form::kNameOrText>(r, what, remedy)) return false;
  const Name& written = *r.component.host;
  const auto colon = written.text.find(':');
  const bool has_port =
      colon != std::string::npos && colon + 1 < written.text.size() &&
      written.text.find_first_not_of("0123456789", colon + 1) == std::string::npos;
  return !has_port || r.read.fail(Code::kSyntax, written.span, "a HOST has no port",
                                  "write HOST " + written.text.substr(0, colon) +
                                      ", and the port in the configuration of ssh");
}

bool engine(Reader& r, std::string_view what, std::string_view remedy) {
  if (!name<&Component::engine, Form::kNameOrText>(r, what, remedy)) return false;
  const Name& first = *r.component.engine;
  if (r.s.at_end() && first.text != "docker" && first.text != "podman")
    return r.read.fail(Code::kSyntax, first.span, "the engine of this container is missing",
                       "write docker or podman in front of it: CONTAINER docker " + first.text);
  return name<&Component::engine_container, Form::kNameOrText>(r, "the container's name", "");
}

bool ready(Reader& r, std::string_view what, std::string_view) {
  r.component.ready = r.read.positive_duration(r.s, what);
  return r.component.ready.has_value();
}

bool has_lifecycle(const Component& component) {
  return component.lifecycle != syntax::LifecycleDriver::kUndeclared;
}

bool lifecycle(Reader& r, std::string_view what, std::string_view remedy) {
  using enum syntax::LifecycleDriver;
  const Token driver = r.s.next();
  if (driver.text == "self") {
    r.component.lifecycle = kSelf;
  } else if (driver.text == "managed") {
    r.component.lifecycle = kManaged;
  } else if (driver.text == "launcher") {
    r.component.lifecycle = kLauncher;
  } else {
    return r.read.fail_token(driver, what, std::string(remedy));
  }
  return true;
}

constexpr std::array kClauses = {
    Clause{"NODE", has<&Component::node>, nodes, "the node's full name"},
    Clause{"LAUNCH", has<&Component::launch>, name<&Component::launch, Form::kText>,
           "the launch command", "write it in quotes: LAUNCH \"ros2 run package program\""},
    Clause{"ENV", has<&Component::environment>, name<&Component::environment, Form::kText>,
           "the variables", "write them in quotes: ENV \"ROS_DOMAIN_ID=7 LANG=C\""},
    Clause{"SETUP", has<&Component::setup>, name<&Component::setup, Form::kNameOrText>,
           "the file to source"},
    Clause{"CWD", has<&Component::folder>, name<&Component::folder, Form::kNameOrText>,
           "the folder to run in"},
    Clause{"UNIT", has<&Component::unit>, unit, "the unit's name"},
    Clause{"CONTAINER", has<&Component::engine>, engine, "the engine: docker or podman"},
    Clause{"HOST", has<&Component::host>, host, "the computer that runs it, as for ssh"},
    Clause{"IN", has<&Component::container>, name<&Component::container, Form::kRosName>,
           "the full name of the node that loads it"},
    Clause{"PLUGIN", has<&Component::plugin>, name<&Component::plugin, Form::kNameOrText>,
           "the class to load"},
    Clause{"PACKAGE", has<&Component::package>, name<&Component::package, Form::kNameOrText>,
           "the package that has the class"},
    Clause{"PARAMETERS", has<&Component::parameters>,
           name<&Component::parameters, Form::kNameOrText>, "the file of its parameters"},
    Clause{"REMAP", has<&Component::remaps>, name<&Component::remaps, Form::kNameOrText>,
           "which name stands for which"},
    Clause{"RESPAWNED", has<&Component::is_respawned>, flag<&Component::is_respawned>},
    Clause{"REQUIRED", has<&Component::is_required>, flag<&Component::is_required>},
    Clause{"READY", has<&Component::ready>, ready, "how long a start may take, with several tries"},
    Clause{"LIFECYCLE", has_lifecycle, lifecycle, "the driver of its lifecycle",
           "write self (the node does), managed (culprit does) or launcher (the program that "
           "starts it does)"},
};

constexpr auto kWords = [] {
  std::array<std::string_view, kClauses.size()> words{};
  std::ranges::transform(kClauses, words.begin(), &Clause::word);
  return words;
}();

// A clause of a unit's file, a launch file or another tool: reported.
bool fail_foreign_clause(Reader& r) {
  Scanner ahead = r.s.ahead();
  const Token word = ahead.next();
  const std::string written(word.text);
  if (r.component.unit && ahead.peek().is("=")) {
    const Span span{word.span.begin, r.s.rest().end};
    return !r.read.fail(Code::kExtraText, span, "no settings of the unit stand here",
                        "remove it: the file of the unit says that");
  }
  // pkg="my_cameras" exec="driver"
  if (upper_case(written) == "PKG" && ahead.take('=')) {
    const std::string package = ahead.next_name().text;
    ahead.next();
    const std::string program = ahead.take('=') ? ahead.next_name().text : "program";
    return !r.read.fail(Code::kSyntax, {word.span.begin, ahead.taken()},
                        "no attributes of a launch file stand here",
                        "write LAUNCH \"ros2 run " + package + " " + program + "\"");
  }
  if (r.component.package && upper_case(written) == "EXECUTABLE") {
    const std::string program = ahead.next_name().text;
    return !r.read.fail(Code::kSyntax, word.span, "unexpected '" + written + "' in this line",
                        "write LAUNCH \"ros2 run " + r.component.package->text + " " + program +
                            "\" instead of both");
  }
  return r.read.is_foreign_word(word, "COMPONENT");
}

}  // namespace component_reader
}  // namespace

std::span<const std::string_view> component_clauses() { return component_reader::kWords; }

bool read_component_clauses(LineReader& read, const Source& source, Scanner& s,
                            syntax::Component& component) {
  using namespace component_reader;
  Reader reader{read, source, s, component};
  while (!s.at_end()) {
    const Token& word = s.peek();
    const auto clause = std::ranges::find(kClauses, word.text, &Clause::word);
    if (clause == kClauses.end() || clause->is_there(component)) {
      if (fail_foreign_clause(reader)) return false;
      const bool is_node = word.is("/") && !component.node;
      const bool adjoins_text = word.span.begin > 0 && source.text()[word.span.begin - 1] == '"';
      return read.unexpected_clause(word, {kWords.begin(), kWords.end()},
                                    is_node               ? "write NODE in front of the node's name"
                                    : adjoins_text        ? "write \\\" for a quote within a text"
                                    : word.text == "USER" ? "write it behind the name of a UNIT"
                                                          : "");
    }
    s.next();
    if (!clause->parse(reader, clause->what, clause->remedy)) return false;
  }
  return true;
}

}  // namespace culprit
