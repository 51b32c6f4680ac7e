#include "language/declaration_reader.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

#include "base/closest.h"
#include "language/component_reader.h"

namespace culprit {
namespace {

using syntax::Name;

constexpr std::array<std::string_view, 1> kEqualsSign = {"="};
constexpr std::array<std::string_view, 3> kSignalSources = {"DIAGNOSTIC", "TOPIC", "PARAMETER"};

// Whether the next word is none of these `clauses` nor one of them written wrong.
bool is_clause_far(const Scanner& s, std::span<const std::string_view> clauses) {
  const Token& token = s.peek();
  if (std::find(clauses.begin(), clauses.end(), token.text) != clauses.end()) return false;
  const std::string upper = upper_case(token.text);
  return std::find(clauses.begin(), clauses.end(), upper) == clauses.end() &&
         closest(upper, {clauses.begin(), clauses.end()}).empty();
}

// "STALE 2s" or "RANGE 0..1", and not a parameter of that name?
bool is_clause_of_signal(const Scanner& s) {
  if (s.peek().text != "STALE" && s.peek().text != "RANGE") return false;
  Scanner ahead = s.ahead();
  ahead.next();
  const Token& value = ahead.peek();
  return value.is("-") || (value.kind != Token::Kind::kIdentifier && !ahead.at_end());
}

}  // namespace

bool DeclarationReader::robot(Scanner& s) {
  const auto name = read_.identifier(s, "the robot's name");
  if (!name || !read_.is_one_word(s, *name)) return false;
  if (into_.robot)
    return read_.fail(Code::kDuplicateName, name->span, "the robot has a name already",
                      "keep one ROBOT line");
  into_.robot = *name;
  return true;
}

bool DeclarationReader::cycle(Scanner& s) {
  const Span span = s.rest();
  const std::string written(source_.text(s.peek().span));
  const auto digits = written.find_first_not_of("0123456789");
  const int hertz = digits == std::string::npos || digits > 3 ? 0 : std::atoi(written.c_str());
  if (hertz > 0 && is_hertz(written.substr(digits))) {
    const std::string meant = to_string(Duration(std::chrono::milliseconds(1000 / hertz)));
    return read_.fail(Code::kBadToken, s.peek().span, "a cycle is a duration, and no rate",
                      "write " + meant, Edit{s.peek().span, meant});
  }
  const auto length = read_.duration(s, "the length of a cycle");
  if (!length) return false;
  if (into_.cycle)
    return read_.fail(Code::kDuplicateName, span, "CYCLE is set already", "keep one CYCLE line");
  if (*length <= Duration::zero())
    return read_.fail(Code::kPolicyRange, span, "a cycle takes some time",
                      "write for example 200ms");
  into_.cycle = {*length, span};
  return true;
}

bool DeclarationReader::constant(Scanner& s) {
  auto name = read_.declared_name(s, "the constant's name");
  if (!name || !read_.is_one_word(s, *name, kEqualsSign) || !equals_sign(s, *name)) return false;
  if (const Span next = s.peek().span; source_.text(next) == "[")
    return read_.fail(Code::kBadToken, next, "a constant is one value, and no list",
                      "write a CONST line for each value");
  auto value = read_.expression(s);
  if (value && s.peek().is(",") && !read_.is_in_number(s.peek()))
    return read_.fail(Code::kExtraText, s.peek().span, "one line has one constant",
                      "write the next one on a line of its own that begins with CONST");
  if (!value || !read_.line_ends(s)) return false;
  into_.constants.push_back({std::move(*name), std::move(*value)});
  return true;
}

bool DeclarationReader::equals_sign(Scanner& s, const Name& constant) {
  const Token token = s.next();
  if (token.is("=")) return true;
  if (const Token type = s.peek(); token.is(":") && is_type_word(type.text)) {
    const Span both{token.span.begin, type.span.end};
    return read_.fail(Code::kSyntax, both, "a constant has no type",
                      "remove '" + std::string(source_.text(both)) + "'", Edit{both, ""});
  }
  const bool is_assignment = s.peek().is("=");  // ":=", "+="
  Scanner value = s.ahead();
  if (is_assignment) value.next();
  const bool is_sign = token.is(":") || is_assignment;
  const Span rest{is_sign ? value.position() : token.span.begin, s.rest().end};
  const std::string written(rest.begin < rest.end ? source_.text(rest) : "0.5");
  return read_.fail_token(token, "'='", "write CONST " + constant.text + " = " + written,
                          is_assignment ? Edit{token.span, ""}
                          : is_sign     ? Edit{token.span, " ="}
                                        : Edit{{token.span.begin, token.span.begin}, "= "});
}

bool DeclarationReader::component(Scanner& s) {
  if (const Span rest = s.rest(); source_.text(rest).starts_with('/'))
    return read_.fail(Code::kSyntax, rest, "a component's name is no node's name",
                      "write its own name first: COMPONENT camera NODE /robot/camera");
  const auto clauses = component_clauses();
  if (const Token& word = s.peek(); std::ranges::find(clauses, word.text) != clauses.end()) {
    const std::string rest(source_.text(s.rest()));
    Scanner behind = s.ahead();
    behind.next();
    const Token name = behind.next();
    // "COMPONENT NODE lidar /lidar"
    const bool is_swapped = (word.text == "NODE" && behind.peek().is("/") &&
                             behind.peek().span.begin > name.span.end) ||
                            (word.text == "LAUNCH" && behind.peek().kind == Token::Kind::kString);
    const std::string right = std::string(name.text) + " " + std::string(word.text);
    if (is_swapped && name.kind == Token::Kind::kIdentifier &&
        std::ranges::find(clauses, name.text) == clauses.end())
      return read_.fail(Code::kReservedWord, word.span, "the component's name stands in front",
                        "write COMPONENT " + right, Edit{{word.span.begin, name.span.end}, right});
    const bool has_node = word.text == "NODE" && rest.rfind('/') != std::string::npos;
    return read_.fail(Code::kReservedWord, word.span, "the component's name is missing",
                      "write it in front: COMPONENT " +
                          (has_node ? rest.substr(rest.rfind('/') + 1) : "camera") + " " + rest);
  }
  auto name = read_.declared_name(s, "the component's name");
  if (!name) return false;
  if (is_clause_far(s, clauses) && !read_.is_one_word(s, *name, clauses)) return false;
  syntax::Component component{std::move(*name), {}, {}};
  if (!read_component_clauses(read_, source_, s, component)) return false;
  into_.components.push_back(std::move(component));
  return true;
}

bool DeclarationReader::dependency(Scanner& s) {
  if (s.peek().text == "ON")
    return read_.fail(
        Code::kReservedWord, s.peek().span, "a component is missing in front of ON",
        "write the component that needs the other one first: DEPENDENCY fusion ON camera");
  auto consumer = read_.component_reference(s);
  if (!consumer || !on(s)) return false;
  syntax::Dependency dependency{std::move(*consumer), {}};
  do {
    if (s.peek().is(",")) return read_.fail_comma(s.next());
    auto producer = read_.component_reference(s);
    if (!producer) return false;
    dependency.producers.push_back(std::move(*producer));
  } while (!s.at_end());
  into_.dependencies.push_back(std::move(dependency));
  return true;
}

// Or a word or an arrow in its place, which is reported.
bool DeclarationReader::on(Scanner& s) {
  Scanner behind = s.ahead();
  const Token word = behind.next();
  if (word.text == "ON") return s.next(), true;
  const Token& second = behind.peek();
  const bool is_arrow = word.is("-") && second.is(">");
  const bool is_phrase = upper_case(second.text) == "ON";
  const bool is_name = word.kind == Token::Kind::kIdentifier && behind.at_end();
  const Span span{word.span.begin, is_arrow || is_phrase ? second.span.end : word.span.end};
  std::optional<Edit> fix;
  if (is_arrow || is_phrase || upper_case(word.text) == "ON") fix = Edit{span, "ON"};
  if (is_name && !fix) fix = Edit{{word.span.begin, word.span.begin}, "ON "};
  const std::string got =
      word.kind == Token::Kind::kEnd ? "" : ", not '" + std::string(source_.text(span)) + "'";
  return read_.fail(
      Code::kSyntax, span, "expected ON" + got,
      "write the component that needs the other one first: DEPENDENCY fusion ON camera", fix);
}

bool DeclarationReader::group(Scanner& s) {
  auto name = read_.declared_name(s, "the group's name");
  if (!name) return false;
  syntax::Group group{std::move(*name), {}, {}};
  if (!s.take('{'))
    return read_.fail_token(s.next(), "'{'",
                            "write the components in braces: GROUP navigation { planner, "
                            "controller } MANAGER lifecycle_manager");
  do {
    if (const Span next = s.peek().span; source_.text(next) == "}")
      return read_.fail(Code::kSyntax, next, "a component is missing here",
                        "write the components of the group, with commas between them");
    auto member = read_.identifier(s, "a component of the group");
    if (!member) return false;
    group.members.push_back(std::move(*member));
  } while (s.take(','));
  if (!s.take('}'))
    return read_.fail_token(s.next(), "',' or '}'",
                            "commas stand between the components, and a brace behind the last one");
  if (!read_.expect_word(s, "MANAGER",
                         "write the component of its lifecycle manager, as in MANAGER "
                         "lifecycle_manager"))
    return false;
  auto manager = read_.identifier(s, "the component that manages the group");
  if (!manager || !read_.line_ends(s)) return false;
  group.manager = std::move(*manager);
  into_.groups.push_back(std::move(group));
  return true;
}

bool DeclarationReader::ignore(Scanner& s) {
  if (const Span rest = s.rest(); source_.text(rest).starts_with('/'))
    return read_.fail(Code::kSyntax, rest,
                      "expected TOPIC, not '" + std::string(source_.text(rest)) + "'",
                      "write TOPIC in front of it", Edit{{rest.begin, rest.begin}, "TOPIC "});
  if (s.peek().text == "NODE" || s.peek().text == "COMPONENT")
    return read_.fail(Code::kSyntax, s.peek().span, "only topics can be ignored",
                      "write IGNORE TOPIC and the topics that carry no failure");
  if (!read_.expect_word(s, "TOPIC")) return false;
  do {
    if (s.peek().is(",")) return read_.fail_comma(s.next());
    auto topic = read_.ros_name(s, "a topic");
    if (!topic) return false;
    into_.ignored_topics.push_back(std::move(*topic));
  } while (!s.at_end());
  return true;
}

bool DeclarationReader::interlock(Scanner& s) { return condition(s, into_.interlocks); }
bool DeclarationReader::abort(Scanner& s) { return condition(s, into_.aborts); }

bool DeclarationReader::condition(Scanner& s, std::vector<syntax::Interlock>& all) {
  if (s.at_end())
    return read_.fail(Code::kSyntax, s.peek().span, "a condition is missing here",
                      "write it on this line, as in speed < 0.1");
  auto condition = read_.expression(s);
  if (!condition || !read_.condition_ends(s)) return false;
  std::string text(source_.text(condition->span));
  all.push_back({std::move(*condition), std::move(text)});
  return true;
}

bool DeclarationReader::drill(Scanner& s) {
  using What = syntax::Drill::What;
  auto component = read_.component_reference(s);
  if (!component) return false;
  syntax::Drill drill{.component = std::move(*component)};
  const Token word = s.next();
  if (word.text == "set_parameter") {
    drill.what = What::kSetParameter;
    auto parameter = read_.name_or_text(s, "the parameter");
    if (!parameter) return false;
    drill.subject = std::move(*parameter);
    drill.value = read_.expression(s);
    if (!drill.value || !read_.line_ends(s)) return false;
  } else if (word.text == "without") {
    drill.what = What::kWithout;
    const Token fault = s.next();
    const auto known = syntax::drill_faults();
    if (std::ranges::find(known, fault.text) == known.end())
      return read_.unexpected_clause(fault, known);
    drill.subject = {std::string(fault.text), fault.span};
  } else if (word.text == "limit") {
    const auto times = read_.whole_number(s, "how often it is broken at most");
    if (!times) return false;
    drill.times = *times;
  } else {
    const auto faults = syntax::drill_faults();
    const std::string fault(word.text);
    const bool is_fault = std::ranges::find(faults, word.text) != faults.end();
    return read_.unexpected_clause(
        word, {"set_parameter", "without", "limit"},
        is_fault ? "drills do that already; DRILL camera without " + fault + " forbids it"
                 : "write the component and what drills may do to it, as in DRILL camera limit 3");
  }
  into_.drills.push_back(std::move(drill));
  return true;
}

bool DeclarationReader::signal(Scanner& s) {
  auto name = read_.declared_name(s, "the signal's name");
  if (!name) return false;
  if (is_clause_far(s, kSignalSources) && !read_.is_one_word(s, *name, kSignalSources))
    return false;
  if (const Token& sign = s.peek(); sign.is("=")) return assigned_signal(*name, sign);
  syntax::Signal signal{std::move(*name), {}, {}, {}};
  if (!signal_source(s, signal)) return false;
  while (!s.at_end()) {
    const Token& clause = s.peek();
    if (clause.text == "STALE" && !signal.stale) {
      s.next();
      signal.stale = read_.positive_duration(s, "how old a value may become");
      if (!signal.stale) return false;
    } else if (clause.text == "RANGE" && !signal.range) {
      s.next();
      if (!range(s, signal)) return false;
    } else {
      const bool is_publisher = upper_case(clause.text) == "FROM";
      if (is_publisher && clause.text != "FROM")
        return read_.fail(Code::kSyntax, clause.span,
                          "'" + std::string(clause.text) + "' is no word here",
                          "did you mean FROM?", Edit{clause.span, "FROM"});
      if (read_.is_foreign_word(clause, "SIGNAL")) return false;
      return read_.unexpected_clause(
          clause, {"STALE", "RANGE"},
          !is_publisher ? ""
          : std::holds_alternative<syntax::ParameterSource>(signal.source)
              ? "remove it: a parameter is its component's own"
          : signal.from ? "remove it: one FROM is enough"
                        : "write FROM behind the key or the field, in front of STALE and RANGE");
    }
  }
  into_.signals.push_back(std::move(signal));
  return true;
}

// "SIGNAL battery = /battery.percentage"
bool DeclarationReader::assigned_signal(const Name& name, const Token& sign) {
  const Span line = source_.line(source_.position(sign.span.begin).line);
  Scanner ahead(source_.text(), {sign.span.end, line.end});
  const Name value = ahead.next_name();
  if (std::ranges::find(kSignalSources, value.text) != kSignalSources.end())
    return read_.fail(Code::kSyntax, sign.span, "no '=' stands here", "remove the '='",
                      Edit{{sign.span.begin, value.span.begin}, ""});
  const auto dot = value.text.find('.');
  const bool is_field = value.text.starts_with('/') && dot != std::string::npos;
  const std::string source =
      is_field ? "TOPIC " + value.text.substr(0, dot) + " FIELD " + value.text.substr(dot + 1)
               : "TOPIC /battery FIELD percentage";
  return read_.fail(
      Code::kSyntax, sign.span, "no '=' stands here", "write SIGNAL " + name.text + " " + source,
      is_field ? std::optional(Edit{{sign.span.begin, value.span.end}, source}) : std::nullopt);
}

// How the path of a field is not written.
bool DeclarationReader::check_field(const Scanner& s, const Name& field) {
  const std::string_view text = source_.text();
  const bool is_quoted = text[field.span.begin] == '"';
  if (const Token& next = s.peek(); !is_quoted && next.is("(")) {
    const auto close = text.find(')', next.span.end);
    const Span line = source_.line(source_.position(field.span.begin).line);
    if (close < line.end) {
      const Span span{field.span.begin, static_cast<std::uint32_t>(close) + 1};
      const std::string quoted = "\"" + std::string(source_.text(span)) + "\"";
      return read_.fail(Code::kSyntax, span, "parentheses stand in a field only in quotes",
                        "write " + quoted, Edit{span, quoted});
    }
  }
  if (const auto all = field.text.find("[*]"); !is_quoted && all != std::string::npos) {
    const std::string list = field.text.substr(0, all);
    return read_.fail(Code::kSyntax, field.span, "a signal reads one element of a list",
                      "write its number, as in " + list + "[0], or \"min(" + list + ")\"");
  }
  if (std::ranges::count(field.text, '[') != std::ranges::count(field.text, ']'))
    return read_.fail(Code::kSyntax, field.span, "a bracket has no other one in this field",
                      "write both around the number of an element, as in ranges[0]");
  const auto dot = field.text.rfind('.');
  const std::string index = dot == std::string::npos ? "" : field.text.substr(dot + 1);
  if (index.empty() || index.find_first_not_of("0123456789") != std::string::npos) return true;
  const std::string meant = field.text.substr(0, dot) + "[" + index + "]";
  return read_.fail(Code::kSyntax, field.span, "an element of a list stands in brackets",
                    "write " + meant, Edit{field.span, meant});
}

// "PARAMETER /robot/camera.gain"
bool DeclarationReader::is_apart(const Scanner& s) {
  Scanner ahead = s.ahead();
  const Name written = ahead.next_name();
  const bool is_last =
      ahead.at_end() || ahead.peek().text == "STALE" || ahead.peek().text == "RANGE";
  // A node's full name has slashes of its own.
  const bool has_slash = is_last && !written.text.starts_with('/');
  const auto dot = written.text.find_first_of(has_slash ? "./" : ".");
  if (dot == std::string::npos || !is_component_reference(written.text.substr(0, dot))) return true;
  const std::string meant = written.text.substr(0, dot) + " " + written.text.substr(dot + 1);
  return read_.fail(Code::kSyntax, written.span, "a component and its parameter stand apart",
                    "write PARAMETER " + meant, Edit{written.span, meant});
}

// "PARAMETER gain", "PARAMETER camera STALE 2s": reported.
bool DeclarationReader::lacks_one_of_both(const Scanner& s, const Name& written) {
  if (!s.at_end() && !is_clause_of_signal(s)) return false;
  const bool is_component =
      written.text.starts_with('/') ||
      std::ranges::any_of(into_.components,
                          [&](const auto& each) { return each.name.text == written.text; }) ||
      std::ranges::any_of(into_.broken_declarations,
                          [&](const auto& each) { return each.name.text == written.text; });
  if (is_component && s.at_end()) return false;  // its reader says so
  return !read_.fail(
      Code::kSyntax, written.span, "PARAMETER names a component and its parameter",
      is_component ? "write the parameter behind it, as in PARAMETER " + written.text + " gain"
                   : "write the component in front of it, as in PARAMETER camera " + written.text);
}

// "DIAGNOSTIC left motor KEY heat"
bool DeclarationReader::is_status_whole(const Scanner& s, const Name& status) {
  Scanner ahead = s.ahead();
  Span span = status.span;
  while (ahead.peek().kind == Token::Kind::kIdentifier && ahead.peek().text != "KEY")
    span.end = ahead.next().span.end;
  const bool is_quoted = source_.text(status.span).starts_with('"');
  if (span.end == status.span.end || is_quoted || ahead.peek().text != "KEY") return true;
  const std::string quoted = "\"" + std::string(source_.text(span)) + "\"";
  return read_.fail(Code::kSyntax, span, "blanks stand in a name only in quotes", "write " + quoted,
                    Edit{span, quoted});
}

bool DeclarationReader::signal_source(Scanner& s, syntax::Signal& signal) {
  const Token kind = s.next();
  if (kind.text == "DIAGNOSTIC") {
    auto status = read_.name_or_text(s, "the status's name or hardware id");
    if (!status || !is_status_whole(s, *status) ||
        !read_.expect_word(s, "KEY", "write KEY and the key, as in KEY temperature"))
      return false;
    auto key = read_.name_or_text(s, "the key");
    if (!key || !publisher(s, signal)) return false;
    signal.source = syntax::DiagnosticSource{std::move(*status), std::move(*key)};
  } else if (kind.text == "TOPIC") {
    auto topic = read_.ros_name(s, "the topic");
    if (!topic ||
        !read_.expect_word(s, "FIELD", "write FIELD and the path of the field, as in FIELD data"))
      return false;
    auto field = read_.name_or_text(s, "the field, for example data or pose.position.x");
    if (!field || !check_field(s, *field) || !publisher(s, signal)) return false;
    signal.source = syntax::TopicSource{std::move(*topic), std::move(*field)};
  } else if (kind.text == "PARAMETER") {
    if (!is_apart(s)) return false;
    auto component = read_.component_reference(s);
    if (!component) return false;
    if (const auto slash = component->text.rfind('/');
        s.at_end() && slash != std::string::npos && slash > 0)
      return read_.fail(Code::kSyntax, component->span, "a parameter is no part of a node's name",
                        "write PARAMETER " + component->text.substr(0, slash) + " " +
                            component->text.substr(slash + 1));
    if (lacks_one_of_both(s, *component)) return false;
    auto parameter = read_.name_or_text(s, "the parameter");
    if (!parameter) return false;
    signal.source = syntax::ParameterSource{std::move(*component), std::move(*parameter)};
  } else {
    constexpr std::string_view kRemedy =
        "write where its value comes from, as in TOPIC /battery FIELD percentage";
    return read_.unexpected_clause(
        kind, {kSignalSources.begin(), kSignalSources.end()},
        kind.is("/")           ? "write TOPIC in front of the topic, and FIELD behind it"
        : kind.text == "FIELD" ? "write TOPIC and the topic in front of it"
        : kind.text == "KEY"   ? "write DIAGNOSTIC and the status in front of it"
                               : std::string(kRemedy));
  }
  return true;
}

// FROM, if it is there.
bool DeclarationReader::publisher(Scanner& s, syntax::Signal& signal) {
  if (s.peek().text != "FROM") return true;
  s.next();
  auto component = read_.component_reference(s);
  if (!component) return false;
  signal.from = std::move(*component);
  return true;
}

bool DeclarationReader::range(Scanner& s, syntax::Signal& signal) {
  constexpr std::string_view kRemedy = "write the two ends, as in RANGE 0..100";
  const Span span = s.rest();
  const std::string_view first = source_.text(s.peek().span);
  if (first == "[" || first == "(")
    return read_.fail(Code::kSyntax, s.peek().span, "a range has no brackets",
                      std::string(kRemedy));
  const auto low = read_.signed_number(s);
  if (!low || !read_.expect_symbol(s, "..", std::string(kRemedy))) return false;
  if (const Span next = s.peek().span;
      source_.text(next).starts_with('.') && next.begin == s.taken())
    return read_.fail(Code::kSyntax, {next.begin, next.begin + 1}, "a range has two points",
                      "remove the third one", Edit{{next.begin, next.begin + 1}, ""});
  const auto high = read_.signed_number(s);
  if (!high) return false;
  signal.range = {*low, *high, span};
  return true;
}

}  // namespace culprit
