#include "language/parser.h"

#include <algorithm>
#include <array>
#include <utility>

#include "language/line_reader.h"
#include "language/scanner.h"

namespace culprit {
namespace {

using syntax::Name;

class Parser {
 public:
  Parser(const Source& source, std::vector<Diagnostic>& diagnostics, std::vector<Lexeme>* lexemes)
      : source_(source), read_(source, diagnostics), lexemes_(lexemes) {}

  syntax::File parse() {
    for (std::uint32_t line = 1; line <= source_.line_count(); ++line) {
      Scanner scanner(source_.text(), source_.line(line), lexemes_);
      if (!scanner.at_end()) statement(scanner);
    }
    return std::move(file_);
  }

 private:
  void statement(Scanner& s) {
    struct Statement {
      std::string_view keyword;
      bool (Parser::*parse)(Scanner&);
    };
    static constexpr std::array kStatements = {
        Statement{"ROBOT", &Parser::robot},
        Statement{"CYCLE", &Parser::cycle},
        Statement{"CONST", &Parser::constant},
        Statement{"COMPONENT", &Parser::component},
        Statement{"DEPENDENCY", &Parser::dependency},
        Statement{"IGNORE", &Parser::ignore},
        Statement{"INTERLOCK", &Parser::interlock},
        Statement{"SIGNAL", &Parser::signal},
        Statement{"RULE", &Parser::rule},
        Statement{"POLICIES", &Parser::policies},
        Statement{"TRIGGER", &Parser::trigger},
        Statement{"STRATEGY", &Parser::strategy},
        Statement{"ADAPTATION", &Parser::adaptation},
    };
    const Token head = s.next();
    if (head.kind == Token::Kind::kBad) {
      read_.fail(Code::kBadToken, head.span, head.text, "", head.fix);
      return broken();
    }
    for (const Statement& candidate : kStatements) {
      if (head.text != candidate.keyword) continue;
      keyword_ = head.span;
      const Scanner behind_keyword = s;
      if (has_placeholder(s) || has_colon(s) || !(this->*candidate.parse)(s) ||
          !read_.line_ends(s)) {
        broken();
        broken_declaration(candidate.keyword, behind_keyword);
      }
      return;
    }
    std::vector<std::string_view> keywords;
    for (const Statement& known : kStatements) keywords.push_back(known.keyword);
    std::string upper = head.text;
    std::transform(upper.begin(), upper.end(), upper.begin(),
                   [](unsigned char c) { return std::toupper(c); });
    const bool lower_case = std::find(keywords.begin(), keywords.end(), upper) != keywords.end();
    std::string near = lower_case ? upper : closest(upper, keywords);
    if (near.empty()) near = word_of_other_tools(upper);
    const std::string word = head.text.empty() ? std::string(source_.text(head.span)) : head.text;
    read_.fail(Code::kUnknownStatement, head.span, "no statement begins with '" + word + "'",
               !near.empty() ? "did you mean " + near + "?"
                             : "a line begins with one of ROBOT CYCLE CONST COMPONENT DEPENDENCY "
                               "IGNORE INTERLOCK SIGNAL RULE "
                               "POLICIES TRIGGER STRATEGY ADAPTATION",
               replacement(head.span, near));
    broken();
    broken_declaration(near, s);
  }

  // Where people who know alerting or behaviour tools look first.
  static std::string word_of_other_tools(std::string_view word) {
    constexpr std::array<std::pair<std::string_view, std::string_view>, 7> kWords = {
        {{"ALERT", "RULE"},
         {"SEVERITY", "POLICIES"},
         {"IF", "TRIGGER"},
         {"EXPR", "TRIGGER"},
         {"CONDITION", "TRIGGER"},
         {"ACTION", "ADAPTATION"},
         {"DO", "ADAPTATION"}}};
    for (const auto& [theirs, ours] : kWords) {
      if (theirs == word) return std::string(ours);
    }
    return "";
  }

  bool has_colon(Scanner& s) {
    const Token token = s.peek();
    if (!token.is(":")) return false;
    read_.fail(Code::kExtraText, token.span, "no ':' stands behind the word of a statement",
               "remove the ':'", Edit{token.span, ""});
    return true;
  }

  // The name that the line was about to declare, so that its uses are not called undeclared.
  void broken_declaration(std::string_view keyword, Scanner s) {
    using Broken = syntax::BrokenDeclaration::Kind;
    const Token name = s.next();
    if (name.kind != Token::Kind::kIdentifier) return;
    if (keyword == "CONST")
      file_.broken_declarations.push_back({Broken::kConstant, {name.text, name.span}});
    if (keyword == "COMPONENT")
      file_.broken_declarations.push_back({Broken::kComponent, {name.text, name.span}});
    if (keyword == "SIGNAL")
      file_.broken_declarations.push_back({Broken::kSignal, {name.text, name.span}});
  }

  // The paper's and our own documentation write <name> where a name is to be put in; people copy
  // that.
  bool has_placeholder(const Scanner& s) {
    const Span rest = s.rest();
    const std::string_view text = source_.text(rest);
    for (auto open = text.find('<'); open != std::string_view::npos;
         open = text.find('<', open + 1)) {
      const auto close = text.find_first_not_of(
          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_ \t\r\f\v", open + 1);
      if (close == std::string_view::npos || text[close] != '>' || is_blank(text[open + 1]) ||
          close == open + 1)
        continue;
      const auto begin = rest.begin + static_cast<std::uint32_t>(open);
      const Span span{begin, rest.begin + static_cast<std::uint32_t>(close) + 1};
      read_.fail(Code::kPlaceholder, span,
                 std::string(source_.text(span)) + " stands for something of yours",
                 "replace it, the angle brackets too");
      return true;
    }
    return false;
  }

  // ---- declarations

  bool robot(Scanner& s) {
    const auto name = read_.identifier(s, "the robot's name");
    if (!name) return false;
    if (file_.robot)
      return read_.fail(Code::kDuplicateName, name->span, "the robot has a name already",
                        "keep one ROBOT line");
    file_.robot = *name;
    return true;
  }

  bool cycle(Scanner& s) {
    const Span span = s.rest();
    const auto length = read_.duration(s, "the length of a cycle");
    if (!length) return false;
    if (file_.cycle)
      return read_.fail(Code::kDuplicateName, span, "CYCLE is set already", "keep one CYCLE line");
    if (*length <= Duration::zero())
      return read_.fail(Code::kPolicyRange, span, "a cycle takes some time",
                        "write for example 200ms");
    file_.cycle = {*length, span};
    return true;
  }

  bool constant(Scanner& s) {
    auto name = read_.declared_name(s, "the constant's name");
    if (!name || !read_.expect_symbol(s, "=")) return false;
    auto value = read_.expression(s);
    if (!value || !read_.line_ends(s)) return false;
    file_.constants.push_back({std::move(*name), std::move(*value)});
    return true;
  }

  bool component(Scanner& s) {
    auto name = read_.declared_name(s, "the component's name");
    if (!name) return false;
    syntax::Component component{std::move(*name), {}, {}};
    while (!s.at_end()) {
      const Token clause = s.peek();
      if (clause.text == "NODE" && !component.node) {
        s.next();
        component.node = read_.ros_name(s, "the node's full name");
        if (!component.node) return false;
      } else if (clause.text == "LAUNCH" && !component.launch) {
        s.next();
        const Token command = s.next();
        if (command.kind != Token::Kind::kString) {
          return read_.fail_token(command, "the launch command",
                                  "write it in quotes: LAUNCH \"ros2 run package program\"");
        }
        component.launch = Name{std::get<std::string>(command.literal), command.span};
      } else if (clause.text == "ENV" && !component.environment) {
        s.next();
        const Token variables = s.next();
        if (variables.kind != Token::Kind::kString) {
          return read_.fail_token(variables, "the variables",
                                  "write them in quotes: ENV \"ROS_DOMAIN_ID=7 LANG=C\"");
        }
        component.environment = Name{std::get<std::string>(variables.literal), variables.span};
      } else if (clause.text == "SETUP" && !component.setup) {
        s.next();
        component.setup = read_.name_or_text(s, "the file to source");
        if (!component.setup) return false;
      } else if (clause.text == "CWD" && !component.folder) {
        s.next();
        component.folder = read_.name_or_text(s, "the folder to run in");
        if (!component.folder) return false;
      } else if (clause.text == "UNIT" && !component.unit) {
        s.next();
        component.unit = read_.name_or_text(s, "the unit's name");
        if (!component.unit) return false;
        component.is_users_unit = s.peek().text == "USER";
        if (component.is_users_unit) s.next();
      } else if (clause.text == "CONTAINER" && !component.engine) {
        s.next();
        component.engine = read_.name_or_text(s, "the engine: docker or podman");
        if (!component.engine) return false;
        component.engine_container = read_.name_or_text(s, "the container's name");
        if (!component.engine_container) return false;
      } else if (clause.text == "HOST" && !component.host) {
        s.next();
        component.host = read_.name_or_text(s, "the computer that runs it, as ssh is told");
        if (!component.host) return false;
      } else if (clause.text == "IN" && !component.container) {
        s.next();
        component.container = read_.ros_name(s, "the full name of the node that loads it");
        if (!component.container) return false;
      } else if (clause.text == "PLUGIN" && !component.plugin) {
        s.next();
        component.plugin = read_.name_or_text(s, "the class to load");
        if (!component.plugin) return false;
      } else if (clause.text == "PACKAGE" && !component.package) {
        s.next();
        component.package = read_.name_or_text(s, "the package that has the class");
        if (!component.package) return false;
      } else if (clause.text == "PARAMETERS" && !component.parameters) {
        s.next();
        component.parameters = read_.name_or_text(s, "the file of its parameters");
        if (!component.parameters) return false;
      } else if (clause.text == "REMAP" && !component.remaps) {
        s.next();
        component.remaps = read_.name_or_text(s, "which name stands for which");
        if (!component.remaps) return false;
      } else if (clause.text == "REQUIRED" && !component.is_required) {
        s.next();
        component.is_required = true;
      } else if (clause.text == "RESPAWNED" && !component.is_respawned) {
        s.next();
        component.is_respawned = true;
      } else if (clause.text == "LIFECYCLE" &&
                 component.lifecycle == syntax::LifecycleDriver::kUndeclared) {
        s.next();
        if (!lifecycle(s, component)) return false;
      } else {
        return read_.unexpected_clause(
            clause,
            {"NODE", "LAUNCH", "ENV", "SETUP", "CWD", "UNIT", "CONTAINER", "HOST", "IN", "PLUGIN",
             "PACKAGE", "PARAMETERS", "REMAP", "RESPAWNED", "REQUIRED", "LIFECYCLE"});
      }
    }
    file_.components.push_back(std::move(component));
    return true;
  }

  bool lifecycle(Scanner& s, syntax::Component& component) {
    using enum syntax::LifecycleDriver;
    const Token driver = s.next();
    if (driver.text == "self") {
      component.lifecycle = kSelf;
    } else if (driver.text == "managed") {
      component.lifecycle = kManaged;
    } else if (driver.text == "launcher") {
      component.lifecycle = kLauncher;
    } else {
      return read_.fail_token(driver, "who takes it through its lifecycle",
                              "write self (the node does), managed (culprit does) or launcher "
                              "(whoever starts it does)");
    }
    return true;
  }

  bool dependency(Scanner& s) {
    auto consumer = read_.component_reference(s);
    if (!consumer || !read_.expect_word(s, "ON")) return false;
    syntax::Dependency dependency{std::move(*consumer), {}};
    do {
      auto producer = read_.component_reference(s);
      if (!producer) return false;
      dependency.producers.push_back(std::move(*producer));
    } while (!s.at_end());
    file_.dependencies.push_back(std::move(dependency));
    return true;
  }

  bool ignore(Scanner& s) {
    if (!read_.expect_word(s, "TOPIC")) return false;
    do {
      auto topic = read_.ros_name(s, "a topic");
      if (!topic) return false;
      file_.ignored_topics.push_back(std::move(*topic));
    } while (!s.at_end());
    return true;
  }

  bool interlock(Scanner& s) {
    auto condition = read_.expression(s);
    if (!condition || !read_.line_ends(s)) return false;
    std::string text(source_.text(condition->span));
    file_.interlocks.push_back({std::move(*condition), std::move(text)});
    return true;
  }

  bool signal(Scanner& s) {
    auto name = read_.declared_name(s, "the signal's name");
    if (!name) return false;
    syntax::Signal signal{std::move(*name), {}, {}, {}};
    if (!signal_source(s, signal)) return false;
    while (!s.at_end()) {
      const Token clause = s.peek();
      if (clause.text == "STALE" && !signal.stale) {
        s.next();
        signal.stale = read_.positive_duration(s, "how old a value may become");
        if (!signal.stale) return false;
      } else if (clause.text == "RANGE" && !signal.range) {
        s.next();
        if (!range(s, signal)) return false;
      } else {
        return read_.unexpected_clause(clause, {"STALE", "RANGE"});
      }
    }
    file_.signals.push_back(std::move(signal));
    return true;
  }

  bool signal_source(Scanner& s, syntax::Signal& signal) {
    const Token kind = s.next();
    if (kind.text == "DIAGNOSTIC") {
      auto status = read_.name_or_text(s, "the status's name or hardware id");
      if (!status || !read_.expect_word(s, "KEY")) return false;
      auto key = read_.name_or_text(s, "the key");
      if (!key) return false;
      signal.source = syntax::DiagnosticSource{std::move(*status), std::move(*key)};
    } else if (kind.text == "TOPIC") {
      auto topic = read_.ros_name(s, "the topic");
      if (!topic || !read_.expect_word(s, "FIELD")) return false;
      auto field = read_.name_or_text(s, "the field, for example data or pose.position.x");
      if (!field) return false;
      signal.source = syntax::TopicSource{std::move(*topic), std::move(*field)};
    } else if (kind.text == "PARAMETER") {
      auto component = read_.component_reference(s);
      if (!component) return false;
      auto parameter = read_.name_or_text(s, "the parameter");
      if (!parameter) return false;
      signal.source = syntax::ParameterSource{std::move(*component), std::move(*parameter)};
    } else {
      return read_.unexpected_clause(kind, {"DIAGNOSTIC", "TOPIC", "PARAMETER"});
    }
    return true;
  }

  bool range(Scanner& s, syntax::Signal& signal) {
    const Span span = s.rest();
    const auto low = read_.signed_number(s);
    if (!low || !read_.expect_symbol(s, "..")) return false;
    const auto high = read_.signed_number(s);
    if (!high) return false;
    signal.range = {*low, *high, span};
    return true;
  }

  // ---- rules

  bool rule(Scanner& s) {
    file_.rules.emplace_back();
    // A part that stands before the rule may be the one that the rule then lacks.
    file_.rules.back().has_broken_part = std::exchange(stray_part_, false);
    auto name = read_.declared_name(s, "the rule's name");
    if (!name) return false;
    file_.rules.back().name = std::move(*name);
    return true;
  }

  bool policies(Scanner& s) {
    if (!inside_rule("POLICIES")) return false;
    syntax::Rule& rule = file_.rules.back();
    if (rule.policies) return duplicate_line("POLICIES");
    syntax::Policies policies;
    policies.span = s.rest();
    rule.policies.emplace();  // there, if broken; the real one replaces it below
    if (!criticality(s, policies)) return false;
    while (!s.at_end()) {
      if (!policy(s, policies)) return false;
    }
    rule.policies = policies;
    return true;
  }

  bool criticality(Scanner& s, syntax::Policies& policies) {
    using enum syntax::Criticality;
    const Token level = s.next();
    if (level.text == "CRITICAL" || level.text == "FATAL") {
      // The nearest word would be NON_CRITICAL.
      return read_.fail(Code::kSyntax, level.span, "there is no criticality " + level.text,
                        "did you mean ERROR? It is the highest", Edit{level.span, "ERROR"});
    }
    if (level.text == "ERROR" || level.text == "FAILURE") {
      policies.criticality = kError;
    } else if (level.text == "WARNING" || level.text == "DEGRADED") {
      policies.criticality = kWarning;
    } else if (level.text == "NON_CRITICAL" || level.text == "OK") {
      policies.criticality = kNonCritical;
    } else {
      return read_.unexpected_clause(
          level, {"ERROR", "WARNING", "NON_CRITICAL", "FAILURE", "DEGRADED", "OK"},
          "a criticality comes first: NON_CRITICAL, WARNING or ERROR");
    }
    return true;
  }

  bool policy(Scanner& s, syntax::Policies& policies) {
    const Token clause = s.peek();
    s.next();
    if (clause.text == "FOR" && !policies.hold_for) {
      policies.hold_for = read_.positive_duration(s, "how long the trigger must hold");
      return policies.hold_for.has_value();
    }
    if (clause.text == "COOLDOWN" && !policies.cooldown) {
      policies.cooldown = read_.positive_duration(s, "the quiet time after a resolution");
      return policies.cooldown.has_value();
    }
    if (clause.text == "HOLD" && !policies.hold) {
      const Span span = s.rest();
      const auto needed = read_.whole_number(s, "a number of evaluations");
      if (!needed || !read_.expect_symbol(s, "/")) return false;
      const auto window = read_.whole_number(s, "a number of evaluations");
      if (!window) return false;
      policies.hold = {*needed, *window, span};
      return true;
    }
    if (clause.text == "ATTEMPTS" && !policies.attempts) {
      const Span span = s.rest();
      const auto count = read_.whole_number(s, "a number of attempts");
      if (!count) return false;
      policies.attempts = {*count, span};
      return true;
    }
    if (clause.text == "ON_CHANGE" && !policies.on_change) return policies.on_change = true;
    return read_.unexpected_clause(clause, {"FOR", "HOLD", "COOLDOWN", "ATTEMPTS", "ON_CHANGE"}, "",
                                   Code::kUnknownPolicy);
  }

  bool trigger(Scanner& s) {
    if (!inside_rule("TRIGGER")) return false;
    if (file_.rules.back().trigger) return duplicate_line("TRIGGER");
    auto expression = read_.expression(s);
    if (!expression || !read_.line_ends(s)) return false;
    file_.rules.back().trigger = std::move(*expression);
    return true;
  }

  bool strategy(Scanner& s) {
    if (!inside_rule("STRATEGY")) return false;
    syntax::Rule& rule = file_.rules.back();
    rule.strategies.emplace_back();
    rule.strategies.back().has_broken_adaptation = true;  // until the line is understood
    auto name = read_.identifier(s, "the strategy's name");
    if (!name) return false;
    const auto probability = read_.number(s, "the success probability in percent");
    if (!probability) return false;
    const auto confidence = read_.number(s, "the confidence in it (1 to 100)");
    if (!confidence) return false;
    const bool is_last_resort = s.peek().text == "LASTRESORT";
    if (is_last_resort) s.next();
    std::optional<syntax::Expression> when;
    if (s.peek().text == "WHEN") {
      s.next();
      when = read_.expression(s);
      if (!when || !read_.line_ends(s)) return false;
    }
    rule.strategies.back() = {std::move(*name), *probability, *confidence, std::move(when), {},
                              is_last_resort,   false};
    return true;
  }

  bool adaptation(Scanner& s) {
    if (!inside_rule("ADAPTATION")) return false;
    syntax::Rule& rule = file_.rules.back();
    if (rule.strategies.empty()) {
      if (rule.has_broken_part) return false;
      return read_.fail(Code::kOutOfPlace, keyword_, "an ADAPTATION belongs to a STRATEGY",
                        "put a STRATEGY line before it");
    }
    auto component = read_.component_reference(s);
    if (!component) return false;
    const Token word = s.next();
    const auto type = syntax::adaptation_type(word.text);
    if (!type) return unknown_adaptation(word);
    syntax::Adaptation adaptation;
    adaptation.component = std::move(*component);
    adaptation.type = *type;
    if (!adaptation_arguments(s, adaptation)) return false;
    const auto impact = read_.number(s, "the impact in cycles");
    if (!impact) return false;
    adaptation.impact = *impact;
    adaptation.span = {keyword_.begin, impact->span.end};
    rule.strategies.back().adaptations.push_back(std::move(adaptation));
    return true;
  }

  bool adaptation_arguments(Scanner& s, syntax::Adaptation& adaptation) {
    using enum syntax::AdaptationType;
    const auto take_name = [&](Name& name, std::string_view what) {
      auto found = read_.name_or_text(s, what);
      if (found) name = std::move(*found);
      return found.has_value();
    };
    switch (adaptation.type) {
      case kSetParameter:
      case kIncreaseParameter:
      case kDecreaseParameter:
        if (!take_name(adaptation.subject, "the parameter")) return false;
        adaptation.value = read_.expression(s);
        return adaptation.value.has_value();
      case kChangeCommunication:
        return take_name(adaptation.subject, "the parameter that holds the topic") &&
               take_name(adaptation.topic, "the topic");
      case kChangeMode:
        return take_name(adaptation.subject, "the mode");
      case kCall:
        if (!take_name(adaptation.subject, "the service")) return false;
        if (const Token next = s.peek(); next.kind == Token::Kind::kString) {
          s.next();
          adaptation.request = Name{std::get<std::string>(next.literal), next.span};
        }
        return true;
      case kActivate:
      case kDeactivate:
      case kRestart:
      case kRedeploy:
      case kStart:
      case kStop:
        return true;
    }
    return false;
  }

  bool unknown_adaptation(const Token& word) {
    if (word.kind != Token::Kind::kIdentifier)
      return read_.fail_token(word, "what to do with the component", "");
    std::string plain = word.text;
    if (plain.starts_with("action_")) plain.erase(0, 7);  // as in the reference's dialect
    const std::string near =
        syntax::adaptation_type(plain) ? plain : closest(plain, syntax::adaptation_keywords());
    return read_.fail(
        Code::kUnknownAdaptation, word.span, "there is no adaptation '" + word.text + "'",
        near.empty()
            ? "known: set_parameter increase_parameter decrease_parameter change_communication "
              "activate deactivate restart redeploy start stop change_mode call"
            : "did you mean '" + near + "'?",
        replacement(word.span, near));
  }

  bool inside_rule(const std::string& keyword) {
    if (!file_.rules.empty()) return true;
    stray_part_ = true;
    return read_.fail(Code::kOutOfPlace, keyword_, keyword + " belongs to a RULE",
                      "put a RULE line before it");
  }

  bool duplicate_line(const std::string& keyword) {
    return read_.fail(Code::kOutOfPlace, keyword_, "this rule has a " + keyword + " line already",
                      "keep one, or begin a new RULE before this line");
  }

  // The line was not understood: whatever its absence would make look wrong stays unreported.
  void broken() {
    if (file_.rules.empty()) return;
    syntax::Rule& rule = file_.rules.back();
    rule.has_broken_part = true;
    if (!rule.strategies.empty()) rule.strategies.back().has_broken_adaptation = true;
  }

  const Source& source_;
  LineReader read_;
  std::vector<Lexeme>* lexemes_;
  syntax::File file_;
  Span keyword_;             // of the line at hand
  bool stray_part_ = false;  // a part of a rule stood before any RULE line
};

}  // namespace

syntax::File parse(const Source& source, std::vector<Diagnostic>& diagnostics,
                   std::vector<Lexeme>* lexemes) {
  return Parser(source, diagnostics, lexemes).parse();
}

}  // namespace culprit
