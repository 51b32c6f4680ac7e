#include "language/adaptation_reader.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <optional>
#include <utility>
#include <variant>

#include "base/closest.h"
#include "language/foreign_words.h"

namespace culprit {
namespace {

using syntax::Name;

class AdaptationReader {
 public:
  AdaptationReader(LineReader& read, const Source& source) : read_(read), source_(source) {}

  std::optional<syntax::Adaptation> read(Scanner& s) {
    auto component = read_.component_reference(s);
    if (!component) return std::nullopt;
    syntax::Adaptation adaptation;
    adaptation.span.begin = component->span.begin;
    if (!is_one_component(s, *component)) return std::nullopt;
    const Token word = s.next();
    const auto type = syntax::adaptation_type(word.text);
    if (!type && syntax::adaptation_type(component->text))
      lacks_component(*component, word);
    else if (!type)
      unknown_adaptation(word, s);
    if (!type || is_command(*component, word, s)) return std::nullopt;
    adaptation.component = std::move(*component);
    adaptation.type = *type;
    if (!adaptation_arguments(s, adaptation)) return std::nullopt;
    if (is_call(s) || is_negative_impact(adaptation, s)) return std::nullopt;
    const auto impact = read_.number(s, "the impact in cycles", impact_remedy(adaptation, s));
    if (!impact) return std::nullopt;
    adaptation.impact = *impact;
    adaptation.span.end = impact->span.end;
    return adaptation;
  }

 private:
  // "camera.redeploy", "camera, lidar redeploy", "robot/camera redeploy": reported.
  bool is_one_component(Scanner& s, const Name& component) {
    const Token& next = s.peek();
    const std::string_view written = source_.text(next.span);
    if (Scanner ahead = s.ahead(); written == "." && ahead.next().span.begin == next.span.begin &&
                                   !syntax::adaptation_type(ahead.peek().text) &&
                                   read_.has_dot(s, component))
      return false;
    if (written == ".")
      return read_.fail(Code::kSyntax, next.span, "unexpected '.' after a component",
                        "write a blank", Edit{next.span, " "});
    if (next.is(","))
      return read_.fail(Code::kSyntax, next.span, "one line adapts one component",
                        "write a line of its own for each component");
    if (next.is("/"))
      return read_.fail(Code::kBadRosName, component.span,
                        "'" + component.text + "/' begins no full ROS name",
                        "write the component, or the full name of its node with a '/' in front",
                        Edit{{component.span.begin, component.span.begin}, "/"});
    return true;
  }

  // "systemctl restart camera 3": reported.
  bool is_command(const Name& program, const Token& type, Scanner& s) {
    if (!is_command_word(program.text) || s.peek().kind != Token::Kind::kIdentifier) return false;
    Scanner ahead = s.ahead();
    const std::string component(ahead.next().text);
    const std::string impact(ahead.at_end() ? "10" : source_.text(ahead.rest()));
    const Span span{program.span.begin, s.rest().end};
    const std::string meant = component + " " + std::string(type.text) + " " + impact;
    return !read_.fail(Code::kUnknownAdaptation, span, "no adaptation runs a command",
                       "write ADAPTATION " + meant, Edit{span, meant});
  }

  // "set_parameter level true -5", where the last number is read as a part of the value: reported.
  bool is_negative_impact(const syntax::Adaptation& adaptation, const Scanner& s) {
    if (!adaptation.value || !s.at_end()) return false;
    const syntax::Expression& value = *adaptation.value;
    if (value.kind != syntax::Expression::Kind::kBinary || value.op != syntax::Operator::kSubtract)
      return false;
    const Span number = value.children[1].span;
    const bool adjoins = source_.text()[number.begin - 1] == '-';
    const bool is_apart = number.begin > 1 && source_.text()[number.begin - 2] == ' ';
    if (!adjoins || !is_apart) return false;
    return !read_.fail(
        Code::kImpactRange, {number.begin - 1, number.end}, "an impact is at least 1",
        "write how many cycles it takes, as in " + std::string(source_.text(number)));
  }

  // "redeploy() 10": reported.
  bool is_call(Scanner& s) {
    const Token& next = s.peek();
    return next.is("(") && !read_.fail(Code::kSyntax, next.span, "an adaptation has no parentheses",
                                       "write its arguments behind it, with blanks between them");
  }

  bool adaptation_arguments(Scanner& s, syntax::Adaptation& adaptation) {
    using enum syntax::AdaptationType;
    const auto take_name = [&](Name& name, std::string_view what) {
      auto found = read_.name_or_text(s, what);
      if (!found) return false;
      name = std::move(*found);
      // The impact, which a name stands in front of.
      const bool is_number = s.at_end() && source_.text(name.span).find_first_not_of(
                                               "0123456789") == std::string_view::npos;
      return !is_number || read_.fail(Code::kSyntax, name.span,
                                      "expected " + std::string(what) + ", not '" + name.text + "'",
                                      "write it in front of the impact");
    };
    switch (adaptation.type) {
      case kSetParameter:
      case kIncreaseParameter:
      case kDecreaseParameter:
        if (!take_name(adaptation.subject, "the parameter") || is_value_first(adaptation, s) ||
            has_node(adaptation.subject))
          return false;
        return value(s, adaptation);
      case kChangeCommunication:
        return take_name(adaptation.subject, "the parameter that holds the topic") &&
               take_name(adaptation.topic, "the topic") && !is_topic_first(adaptation);
      case kChangeMode:
        return take_name(adaptation.subject, "the mode");
      case kCall:
        if (!take_name(adaptation.subject, "the service")) return false;
        if (const Name& service = adaptation.subject; names_type(service.text))
          return read_.fail(Code::kSyntax, service.span,
                            "this is the type of a service, and no name",
                            "write the name that ros2 service list shows, as in ~/enable");
        if (s.peek().kind == Token::Kind::kString)
          adaptation.request = read_.text(s, "the request", "");
        if (has_type(s)) return false;
        if (const Token& next = s.peek(); next.kind == Token::Kind::kIdentifier
                                              ? !source_.text(next.span).starts_with('{')
                                              : source_.text(next.span) == "{")
          return read_.fail(Code::kSyntax, next.span, "a request stands in quotes",
                            "write it as in call ~/enable \"data: true\" 5");
        return true;
      case kActivate:
      case kDeactivate:
      case kRestart:
      case kRedeploy:
      case kStart:
      case kStop:
      case kStartGroup:
        return true;
    }
    return false;
  }

  // "change_communication /scan_2 scan_topic 5": reported.
  bool is_topic_first(const syntax::Adaptation& adaptation) {
    const Name& first = adaptation.subject;
    const Name& second = adaptation.topic;
    if (!first.text.starts_with('/') || second.text.find_first_of("/{\"") != std::string::npos)
      return false;
    const Span span{first.span.begin, second.span.end};
    const std::string meant = second.text + " " + first.text;
    return !read_.fail(Code::kBadRosName, span, "the parameter stands in front of the topic",
                       "write change_communication " + meant, Edit{span, meant});
  }

  // "set_parameter /base.max_speed 0.2 5": reported.
  bool has_node(const Name& parameter) {
    const auto dot = parameter.text.find('.');
    if (dot == std::string::npos || !parameter.text.starts_with('/') ||
        !is_component_reference(parameter.text.substr(0, dot)))
      return false;
    const std::string meant = parameter.text.substr(dot + 1);
    return !read_.fail(Code::kBadRosName, parameter.span, "a parameter is named without its node",
                       "write " + meant, Edit{parameter.span, meant});
  }

  // "set_parameter 0.2 max_speed 5": reported.
  bool is_value_first(const syntax::Adaptation& adaptation, const Scanner& s) {
    const Name& first = adaptation.subject;
    const Token& second = s.peek();
    if (first.text.find_first_not_of("0123456789.") != std::string::npos ||
        second.kind != Token::Kind::kIdentifier)
      return false;
    const Span span{first.span.begin, second.span.end};
    const std::string meant = std::string(second.text) + " " + first.text;
    return !read_.fail(Code::kTypeMismatch, span, "the parameter stands in front of its value",
                       "write " + std::string(keyword(adaptation.type)) + " " + meant,
                       Edit{span, meant});
  }

  // "std_srvs/srv/Trigger"; a service itself may be called /lidar/srv/enable.
  static bool names_type(std::string_view word) {
    return word.find("/srv/") != std::string_view::npos && word.front() != '/' &&
           word.front() != '~';
  }

  // "call /reset std_srvs/srv/Trigger 5": reported.
  bool has_type(const Scanner& s) {
    Scanner ahead = s.ahead();
    const bool is_word = ahead.peek().kind == Token::Kind::kIdentifier;
    const Name type = ahead.next_name();
    return is_word && names_type(type.text) &&
           !read_.fail(Code::kSyntax, type.span, "a call names no type of service", "remove it",
                       Edit{{type.span.begin, ahead.position()}, ""});
  }

  // "increase_parameter gain 10% 2": reported. "10% 3 2" has a remainder, and its impact.
  bool has_percent(const Scanner& s) {
    Scanner ahead = s.ahead();
    const Token number = ahead.next();
    const Token sign = ahead.next();
    const Token impact = ahead.next();
    const bool is_so = number.kind == Token::Kind::kNumber && sign.is("%") &&
                       sign.span.begin == number.span.end && impact.span.begin > sign.span.end &&
                       ahead.at_end();
    return is_so && !read_.fail(Code::kSyntax, sign.span, "unexpected '%' after a number",
                                "write the amount itself, in the unit of the parameter");
  }

  // "set_parameter max_speed 0.4m/s 2": reported.
  bool has_metres(const Scanner& s) {
    const Span first = s.peek().span;
    const std::string_view rest = source_.text(s.rest());
    std::string_view word = rest.substr(0, rest.find_first_of(" \t"));
    const std::string number(word.substr(0, word.find_first_not_of("0123456789.")));
    const bool is_apart = !number.empty() && number.size() == word.size();  // "0.4 m/s"
    if (is_apart) word = rest.substr(0, rest.find_first_of(" \t", word.size() + 1));
    constexpr std::array<std::string_view, 8> kUnits = {"m",   "cm",    "mm",   "km",
                                                        "m/s", "m/s^2", "cm/s", "km/h"};
    const bool is_so =
        !number.empty() &&
        std::ranges::find(kUnits, trimmed(word.substr(number.size()))) != kUnits.end();
    const Span all{first.begin, first.begin + static_cast<std::uint32_t>(word.size())};
    return is_so && !read_.fail(Code::kBadToken, all, "ROS parameters have no unit",
                                "write " + number + ", in the unit that the node expects",
                                Edit{all, number});
  }

  bool value(Scanner& s, syntax::Adaptation& adaptation) {
    const Token& next = s.peek();
    constexpr std::string_view kNoSign = "unexpected '=' between a parameter and its value";
    if (next.text == "to" || next.text == "by") {
      Scanner ahead = s.ahead();
      ahead.next();
      return read_.fail(Code::kSyntax, next.span,
                        "unexpected '" + std::string(next.text) + "' before a value", "remove it",
                        Edit{{next.span.begin, ahead.peek().span.begin}, ""});
    }
    if (source_.text(next.span) == "[")
      return read_.fail(Code::kSyntax, next.span, "a list stands in quotes",
                        "write it as in set_parameter gains \"[1, 2]\" 5");
    if (const std::string& first = adaptation.subject.text;
        first.starts_with('{') && first.ends_with(':'))
      return read_.fail(
          Code::kSyntax, {adaptation.subject.span.begin, s.rest().end},
          "no braces stand around a parameter and its value",
          "write for example set_parameter " + first.substr(1, first.size() - 2) + " 15 5");
    if (adaptation.subject.text.size() > 1 && adaptation.subject.text.ends_with(':')) {
      const Span colon{adaptation.subject.span.end - 1, adaptation.subject.span.end};
      return read_.fail(Code::kExtraText, colon, "unexpected ':' after a parameter",
                        "remove the ':'", Edit{colon, ""});
    }
    // "gain=2.0 5": what stands behind it is the impact.
    if (const auto sign = adaptation.subject.text.find('=');
        sign != std::string::npos && holds_one_number(s)) {
      const auto at = adaptation.subject.span.begin + static_cast<std::uint32_t>(sign);
      return read_.fail(Code::kSyntax, {at, at + 1}, std::string(kNoSign), "write a blank",
                        Edit{{at, at + 1}, " "});
    }
    if (next.is("="))
      return read_.fail(Code::kSyntax, next.span, std::string(kNoSign), "remove the '='",
                        Edit{next.span, ""});
    Scanner ahead = s.ahead();
    if (ahead.next().kind == Token::Kind::kNumber && !duration_unit(ahead.next_letters()).empty())
      return read_.fail(Code::kTypeMismatch, {next.span.begin, ahead.peek().span.end},
                        "ROS parameters hold no durations",
                        "write only the number, in the unit that the node expects");
    if (has_percent(s) || has_metres(s)) return false;
    if (s.at_end())
      return read_.fail(Code::kSyntax, next.span, "a value is missing here",
                        both_at_the_end(adaptation));
    adaptation.value = read_.expression(s);
    if (adaptation.value && read_.is_in_number(s.peek()))
      return read_.fail_comma_in_number(s.peek());
    return adaptation.value.has_value();
  }

  bool holds_one_number(const Scanner& s) const {
    const std::string_view rest = source_.text(s.rest());
    return !rest.empty() && rest.find_first_not_of("0123456789.") == std::string_view::npos;
  }

  // Where one number is there, it was read as the value.
  static std::string impact_remedy(const syntax::Adaptation& adaptation, Scanner& s) {
    if (s.peek().kind == Token::Kind::kDuration)
      return "an impact counts cycles, not time: write it without a unit";
    if (!adaptation.value && s.at_end()) return "add it at the end: a usual impact is 10";
    if (!adaptation.value && adaptation.subject.text.empty() &&
        s.peek().kind != Token::Kind::kSymbol && !is_last_word(s))
      return "remove it: " + std::string(keyword(adaptation.type)) + " takes the impact only";
    if (!adaptation.value) return "";
    if (s.peek().kind == Token::Kind::kIdentifier && !is_last_word(s))
      return "one line sets one parameter: write a line for each";
    if (!s.at_end()) return "";
    const syntax::Expression& value = *adaptation.value;
    const bool may_be_impact = value.kind != syntax::Expression::Kind::kLiteral ||
                               std::holds_alternative<std::int64_t>(*value.literal);
    return may_be_impact ? both_at_the_end(adaptation)
                         : "write it behind the value: a number of cycles, such as 5";
  }

  static std::string both_at_the_end(const syntax::Adaptation& adaptation) {
    const std::string word(keyword(adaptation.type));
    return "the value and the impact stand at the end: " + word + " " + adaptation.subject.text +
           (adaptation.type == syntax::AdaptationType::kSetParameter ? " true 2" : " 0.5 2");
  }

  static bool is_last_word(const Scanner& s) {
    Scanner ahead = s.ahead();
    ahead.next();
    return ahead.at_end();
  }

  // "ADAPTATION redeploy camera 10", or no component at all
  bool lacks_component(const Name& type, const Token& word) {
    if (word.is("("))
      return read_.fail(Code::kSyntax, type.span, "an adaptation has no parentheses",
                        "write the component in front of it, as in ADAPTATION camera " + type.text);
    const bool is_swapped = word.kind == Token::Kind::kIdentifier;
    const std::string component = is_swapped ? std::string(word.text) : "component";
    const std::string right = component + " " + type.text;
    const Span span{type.span.begin, is_swapped ? word.span.end : type.span.end};
    return read_.fail(Code::kSyntax, span, "the component stands in front of what to do with it",
                      "write ADAPTATION " + right,
                      is_swapped ? std::optional(Edit{span, right}) : std::nullopt);
  }

  bool unknown_adaptation(const Token& word, Scanner& s) {
    if (hyphenated_adaptation(word, s) || is_state(word, s)) return false;
    if (const Token& sign = s.peek(); word.kind == Token::Kind::kIdentifier && sign.is("="))
      return read_.fail(
          Code::kUnknownAdaptation, {word.span.begin, sign.span.end},
          "no adaptation is written with '='",
          "write set_parameter " + std::string(word.text) + " and its value",
          Edit{{word.span.begin, sign.span.end}, "set_parameter " + std::string(word.text)});
    if (word.kind == Token::Kind::kIdentifier && syntax::adaptation_type(s.peek().text))
      return read_.fail(Code::kSyntax, word.span, "one line adapts one component",
                        "write a line of its own for each component");
    if (word.kind == Token::Kind::kNumber && syntax::adaptation_type(s.peek().text))
      return read_.fail(Code::kSyntax, word.span, "the impact stands at the end of the line",
                        "write " + std::string(s.peek().text) + " in front of it");
    if (word.kind != Token::Kind::kIdentifier)
      return read_.fail_token(word, "what to do with the component",
                              "write for example restart, redeploy or set_parameter");
    std::string plain(word.text);
    std::transform(plain.begin(), plain.end(), plain.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    if (plain.starts_with("action_")) plain.erase(0, 7);  // as in the reference's dialect
    std::string near =
        syntax::adaptation_type(plain) ? plain : std::string(adaptation_of_other_tools(plain));
    if (near.empty()) near = closest(plain, syntax::adaptation_keywords());
    if (const Token next = s.peek(); plain == "param" && next.text == "set") {
      const Span span{word.span.begin, next.span.end};
      return read_.fail(Code::kUnknownAdaptation, span, "there is no adaptation 'param set'",
                        "did you mean 'set_parameter'?", Edit{span, "set_parameter"});
    }
    if (is_command_word(plain))
      return read_.fail(Code::kUnknownAdaptation, word.span, "no adaptation runs a command",
                        "redeploy ends a process and starts it again, by its LAUNCH or UNIT; call "
                        "calls a service");
    return read_.fail(
        Code::kUnknownAdaptation, word.span,
        "there is no adaptation '" + std::string(word.text) + "'",
        near.empty()
            ? "known: set_parameter increase_parameter decrease_parameter change_communication "
              "activate deactivate restart redeploy start stop change_mode call start_group"
            : "did you mean '" + near + "'?",
        replacement(word.span, near));
  }

  // "state=restarted": reported.
  bool is_state(const Token& word, const Scanner& s) {
    Scanner ahead = s.ahead();
    if (word.text != "state" || !ahead.next().is("=")) return false;
    const Token value = ahead.next();
    const std::string meant(adaptation_of_other_tools(value.text));
    const Span span{word.span.begin, value.span.end};
    return !meant.empty() &&
           !read_.fail(Code::kUnknownAdaptation, span, "no adaptation is written with '='",
                       "write " + meant, Edit{span, meant});
  }

  static bool is_command_word(std::string_view word) {
    constexpr std::array<std::string_view, 11> kCommands = {
        "exec", "execute",   "command", "shell", "script", "bash",
        "sudo", "systemctl", "system",  "ros2",  "docker"};
    return std::ranges::find(kCommands, word) != kCommands.end();
  }

  // "re-deploy", "set-parameter": reported.
  bool hyphenated_adaptation(const Token& word, Scanner& s) {
    const Token dash = s.peek();
    if (!dash.is("-") || dash.span.begin != word.span.end) return false;
    s.next();
    const Token second = s.next();
    for (const char* between : {"", "_"}) {
      const std::string meant = std::string(word.text) + between + std::string(second.text);
      if (!syntax::adaptation_type(meant)) continue;
      const Span span{word.span.begin, second.span.end};
      return !read_.fail(Code::kUnknownAdaptation, span,
                         "there is no adaptation '" + std::string(source_.text(span)) + "'",
                         "did you mean '" + meant + "'?", Edit{span, meant});
    }
    return false;
  }

  LineReader& read_;
  const Source& source_;
};

}  // namespace

std::optional<syntax::Adaptation> read_adaptation(LineReader& read, const Source& source,
                                                  Scanner& s) {
  return AdaptationReader(read, source).read(s);
}

}  // namespace culprit
