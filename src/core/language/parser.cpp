#include "language/parser.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "language/component_reader.h"
#include "language/foreign_words.h"
#include "language/line_reader.h"
#include "language/reuse/statements.h"
#include "language/scanner.h"

namespace culprit {
namespace {

using syntax::Name;

constexpr std::array<std::string_view, 1> kEqualsSign = {"="};
constexpr std::array<std::string_view, 3> kSignalSources = {"DIAGNOSTIC", "TOPIC", "PARAMETER"};

class Parser {
 public:
  // Appends the parsed lines to `file`.
  Parser(const Source& source, syntax::File& file, std::vector<Diagnostic>& diagnostics,
         std::vector<Lexeme>* lexemes)
      : source_(source), read_(source, diagnostics), lexemes_(lexemes), file_(file) {}

  void parse() {
    for (std::uint32_t line = 1; line <= source_.line_count(); ++line) {
      line_ = source_.line(line);
      if (template_) {
        template_line();
        continue;
      }
      Scanner scanner(source_.text(), line_, lexemes_);
      if (!scanner.at_end()) statement(scanner);
    }
    if (template_) {
      read_.fail(Code::kIncomplete, template_keyword_, "this TEMPLATE has no END",
                 "write END on a line of its own behind its last statement");
      close_template(text_end(), text_end());
    }
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
        Statement{"GROUP", &Parser::group},
        Statement{"IGNORE", &Parser::ignore},
        Statement{"INTERLOCK", &Parser::interlock},
        Statement{"ABORT", &Parser::abort},
        Statement{"DRILL", &Parser::drill},
        Statement{"SIGNAL", &Parser::signal},
        Statement{"RULE", &Parser::rule},
        Statement{"POLICIES", &Parser::policies},
        Statement{"TRIGGER", &Parser::trigger},
        Statement{"STRATEGY", &Parser::strategy},
        Statement{"ADAPTATION", &Parser::adaptation},
        Statement{"THEN", &Parser::step},
        Statement{"INCLUDE", &Parser::include},
        Statement{"TEMPLATE", &Parser::begin_template},
        Statement{"END", &Parser::end_template},
        Statement{"USE", &Parser::use},
    };
    const Token head = s.next();
    if (head.kind == Token::Kind::kBad) {
      if (source_.text(head.span) == ";")
        foreign_comment(head.span);
      else
        read_.fail_token(head, "a statement", "");
      return broken();
    }
    const auto known = [](std::string_view word) -> const Statement* {
      const char first = word.empty() ? '\0' : word.front();  // which most differ in
      for (const Statement& candidate : kStatements) {
        if (candidate.keyword.front() == first && candidate.keyword == word) return &candidate;
      }
      return nullptr;
    };
    const Statement* meant = known(head.text);
    const std::size_t complaints = read_.complaints() + 1;
    keyword_ = head.span;
    bool is_good_head = meant != nullptr;
    if (meant == nullptr && (meant = known(s.peek().text)) != nullptr) {
      keyword_ = s.next().span;
      superfluous_word(head);
    }
    if (meant == nullptr) {
      std::vector<std::string_view> keywords;
      for (const Statement& each : kStatements) keywords.push_back(each.keyword);
      const std::string near = meant_keyword(head, keywords);
      if (!foreign_comment(head, s)) unknown_statement(head, near);
      // A word of another tool may stand for a line that the rule has as well.
      const bool is_foreign =
          near != "RULE" && near == statement_of_other_tools(upper_case(head.text));
      meant = is_foreign ? nullptr : known(near);
      if (meant == nullptr) return broken();
    }
    if (has_placeholder(s)) is_good_head = false;
    if (has_colon(s)) is_good_head = false;  // it is taken, so that the line can be read
    // The expansion takes only the words as they are.
    if (!is_good_head && is_of_reuse(meant->keyword)) return broken();
    const Scanner behind_keyword = s;
    const bool is_good = (this->*meant->parse)(s) && read_.line_ends(s);
    // One mistake, one message: the statement is read as it was meant, so that the lines that
    // follow stand where they belong; its own other mistakes show once its first word is right.
    if (!is_good_head) read_.forget_since(complaints);
    if (is_good && is_good_head) return;
    broken();
    broken_declaration(meant->keyword, behind_keyword);
  }

  static bool is_of_reuse(std::string_view keyword) {
    return keyword == "INCLUDE" || keyword == "TEMPLATE" || keyword == "END" || keyword == "USE";
  }

  static std::string meant_keyword(const Token& head,
                                   const std::vector<std::string_view>& keywords) {
    const std::string upper = upper_case(head.text);
    if (std::find(keywords.begin(), keywords.end(), upper) != keywords.end()) return upper;
    if (!statement_of(upper).empty()) return "";
    const std::string near = closest(upper, keywords);
    return near.empty() ? std::string(statement_of_other_tools(upper)) : near;
  }

  // The statement that `word` is a part of; empty: none.
  static std::string_view statement_of(std::string_view word) {
    const bool is_clause =
        std::ranges::find(component_clauses(), word) != component_clauses().end();
    if (is_clause && word != "IN") return "COMPONENT";
    constexpr std::array<std::pair<std::string_view, std::string_view>, 12> kParts = {
        {{"FOR", "POLICIES"},
         {"HOLD", "POLICIES"},
         {"COOLDOWN", "POLICIES"},
         {"ATTEMPTS", "POLICIES"},
         {"ON_CHANGE", "POLICIES"},
         {"WHEN", "STRATEGY"},
         {"LASTRESORT", "STRATEGY"},
         {"FIELD", "SIGNAL"},
         {"KEY", "SIGNAL"},
         {"STALE", "SIGNAL"},
         {"RANGE", "SIGNAL"},
         {"MANAGER", "GROUP"}}};
    for (const auto& [part, statement] : kParts) {
      if (part == word) return statement;
    }
    return "";
  }

  void unknown_statement(const Token& head, const std::string& near) {
    const std::string word(source_.text(head.span));
    if (const auto statement = statement_of(upper_case(word)); !statement.empty()) {
      read_.fail(
          Code::kUnknownStatement, head.span, "no statement begins with '" + word + "'",
          "write it on the line of its " + std::string(statement) + ": a statement is one line");
      return;
    }
    if (near == "TRIGGER" && !is_in_rule_) {
      read_.fail(Code::kUnknownStatement, head.span, "no statement begins with '" + word + "'",
                 "write RULE and its name, then lines with POLICIES, TRIGGER, STRATEGY and "
                 "ADAPTATION");
      return;
    }
    read_.fail(Code::kUnknownStatement, head.span, "no statement begins with '" + word + "'",
               !near.empty()
                   ? "did you mean " + near + "?"
                   : "a line begins with one of ROBOT CYCLE CONST COMPONENT DEPENDENCY "
                     "GROUP IGNORE INTERLOCK ABORT DRILL SIGNAL RULE POLICIES TRIGGER STRATEGY "
                     "ADAPTATION THEN INCLUDE TEMPLATE END USE",
               replacement(head.span, near));
  }

  // A line that is a comment elsewhere.
  bool foreign_comment(const Token& head, Scanner& s) {
    const Token& second = s.peek();
    const bool adjoins = second.span.begin == head.span.end;
    const bool is_comment =
        adjoins && ((head.is("-") && second.is("-")) || (head.is("/") && second.is("*")));
    if (!is_comment) return false;
    const Span both{head.span.begin, second.span.end};
    return foreign_comment(both);
  }
  bool foreign_comment(Span mark) {
    return !read_.fail(Code::kUnknownStatement, mark,
                       "no comment begins with '" + std::string(source_.text(mark)) + "'",
                       "begin each line of a comment with #", Edit{mark, "#"});
  }

  // "ELSE STRATEGY …": all strategies of a rule are alternatives.
  void superfluous_word(const Token& head) {
    const std::string keyword(source_.text(keyword_));
    read_.fail(Code::kUnknownStatement, head.span,
               "no '" + std::string(source_.text(head.span)) + "' stands in front of " + keyword,
               "remove it", Edit{{head.span.begin, keyword_.begin}, ""});
  }

  bool has_colon(Scanner& s) {
    const Token& token = s.peek();
    if (!token.is(":")) return false;
    read_.fail(Code::kExtraText, token.span, "no ':' stands behind the word of a statement",
               "remove the ':'", Edit{token.span, ""});
    s.next();
    return true;
  }

  // The name that the line was about to declare, so that its uses are not called undeclared.
  void broken_declaration(std::string_view keyword, Scanner s) {
    using Broken = syntax::BrokenDeclaration::Kind;
    const auto declare = [&](const Token& name) {
      if (keyword == "CONST")
        into_->broken_declarations.push_back(
            {Broken::kConstant, {std::string(name.text), name.span}});
      if (keyword == "COMPONENT")
        into_->broken_declarations.push_back(
            {Broken::kComponent, {std::string(name.text), name.span}});
      if (keyword == "SIGNAL" || keyword == "GROUP")
        into_->broken_declarations.push_back(
            {Broken::kSignal, {std::string(name.text), name.span}});
    };
    // All words of a name with blanks in it: each may be how the rules call it.
    const auto reserved = reserved_words();
    if (keyword == "COMPONENT" && s.peek().kind != Token::Kind::kIdentifier)
      into_->broken_declarations.push_back({Broken::kComponent, {"", s.peek().span}});
    bool is_first = true;  // which is the name, even if it may be none
    for (Token name = s.next(); name.kind == Token::Kind::kIdentifier; name = s.next()) {
      const bool is_reserved =
          std::find(reserved.begin(), reserved.end(), name.text) != reserved.end();
      if (is_reserved && !std::exchange(is_first, false)) return;
      is_first = false;
      declare(name);
    }
  }

  // The paper's and our own documentation write <name> where a name is to be put in; people copy
  // that.
  bool has_placeholder(const Scanner& s) {
    if (source_.text({s.taken(), line_.end}).find('<') == std::string_view::npos) return false;
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
    if (!name || !read_.is_one_word(s, *name)) return false;
    if (into_->robot)
      return read_.fail(Code::kDuplicateName, name->span, "the robot has a name already",
                        "keep one ROBOT line");
    into_->robot = *name;
    return true;
  }

  bool cycle(Scanner& s) {
    const Span span = s.rest();
    const auto length = read_.duration(s, "the length of a cycle");
    if (!length) return false;
    if (into_->cycle)
      return read_.fail(Code::kDuplicateName, span, "CYCLE is set already", "keep one CYCLE line");
    if (*length <= Duration::zero())
      return read_.fail(Code::kPolicyRange, span, "a cycle takes some time",
                        "write for example 200ms");
    into_->cycle = {*length, span};
    return true;
  }

  bool constant(Scanner& s) {
    auto name = read_.declared_name(s, "the constant's name");
    if (!name || !read_.is_one_word(s, *name, kEqualsSign) || !equals_sign(s, *name)) return false;
    auto value = read_.expression(s);
    if (!value || !read_.line_ends(s)) return false;
    into_->constants.push_back({std::move(*name), std::move(*value)});
    return true;
  }

  bool equals_sign(Scanner& s, const Name& constant) {
    const Token token = s.next();
    if (token.is("=")) return true;
    const bool is_assignment = token.is(":") && s.peek().is("=");
    return read_.fail_token(
        token, "'='", "write CONST " + constant.text + " = 0.5",
        is_assignment ? Edit{token.span, ""} : Edit{{token.span.begin, token.span.begin}, "= "});
  }

  bool component(Scanner& s) {
    if (const Span rest = s.rest(); source_.text(rest).starts_with('/'))
      return read_.fail(Code::kSyntax, rest, "a component's name is no node's name",
                        "write its own name first: COMPONENT camera NODE /robot/camera");
    auto name = read_.declared_name(s, "the component's name");
    if (!name) return false;
    const auto clauses = component_clauses();
    if (is_clause_far(s, clauses) && !read_.is_one_word(s, *name, clauses)) return false;
    syntax::Component component{std::move(*name), {}, {}};
    if (!read_component_clauses(read_, source_, s, component)) return false;
    into_->components.push_back(std::move(component));
    return true;
  }

  // Whether the next word is none of these `clauses` nor one of them written wrong.
  static bool is_clause_far(const Scanner& s, std::span<const std::string_view> clauses) {
    const Token& token = s.peek();
    if (std::find(clauses.begin(), clauses.end(), token.text) != clauses.end()) return false;
    const std::string upper = upper_case(token.text);
    return std::find(clauses.begin(), clauses.end(), upper) == clauses.end() &&
           closest(upper, {clauses.begin(), clauses.end()}).empty();
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
    into_->dependencies.push_back(std::move(dependency));
    return true;
  }

  bool group(Scanner& s) {
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
      return read_.fail_token(s.next(), "',' or '}'", "commas stand between the components");
    if (!read_.expect_word(s, "MANAGER")) return false;
    auto manager = read_.identifier(s, "the component that manages the group");
    if (!manager) return false;
    group.manager = std::move(*manager);
    into_->groups.push_back(std::move(group));
    return true;
  }

  bool ignore(Scanner& s) {
    if (const Span rest = s.rest(); source_.text(rest).starts_with('/'))
      return read_.fail(Code::kSyntax, rest,
                        "expected TOPIC, not '" + std::string(source_.text(rest)) + "'",
                        "write TOPIC in front of it", Edit{{rest.begin, rest.begin}, "TOPIC "});
    if (!read_.expect_word(s, "TOPIC")) return false;
    do {
      auto topic = read_.ros_name(s, "a topic");
      if (!topic) return false;
      into_->ignored_topics.push_back(std::move(*topic));
    } while (!s.at_end());
    return true;
  }

  bool interlock(Scanner& s) { return condition(s, into_->interlocks); }
  bool abort(Scanner& s) { return condition(s, into_->aborts); }

  bool condition(Scanner& s, std::vector<syntax::Interlock>& all) {
    auto condition = read_.expression(s);
    if (!condition || !read_.line_ends(s)) return false;
    std::string text(source_.text(condition->span));
    all.push_back({std::move(*condition), std::move(text)});
    return true;
  }

  bool drill(Scanner& s) {
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
      return read_.unexpected_clause(
          word, {"set_parameter", "without", "limit"},
          "write the component and what drills may do to it, as in DRILL camera limit 3");
    }
    into_->drills.push_back(std::move(drill));
    return true;
  }

  bool signal(Scanner& s) {
    auto name = read_.declared_name(s, "the signal's name");
    if (!name) return false;
    if (is_clause_far(s, kSignalSources) && !read_.is_one_word(s, *name, kSignalSources))
      return false;
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
        const bool is_publisher = clause.text == "FROM";
        return read_.unexpected_clause(
            clause, {"STALE", "RANGE"},
            !is_publisher ? ""
            : std::holds_alternative<syntax::ParameterSource>(signal.source)
                ? "remove it: a parameter is its component's own"
            : signal.from ? "remove it: one FROM is enough"
                          : "write FROM behind the key or the field, in front of STALE and RANGE");
      }
    }
    into_->signals.push_back(std::move(signal));
    return true;
  }

  bool signal_source(Scanner& s, syntax::Signal& signal) {
    const Token kind = s.next();
    if (kind.text == "DIAGNOSTIC") {
      auto status = read_.name_or_text(s, "the status's name or hardware id");
      if (!status || !read_.expect_word(s, "KEY", "write KEY and the key, as in KEY temperature"))
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
      if (!field || !publisher(s, signal)) return false;
      signal.source = syntax::TopicSource{std::move(*topic), std::move(*field)};
    } else if (kind.text == "PARAMETER") {
      auto component = read_.component_reference(s);
      if (!component) return false;
      auto parameter = read_.name_or_text(s, "the parameter");
      if (!parameter) return false;
      signal.source = syntax::ParameterSource{std::move(*component), std::move(*parameter)};
    } else {
      return read_.unexpected_clause(
          kind, {kSignalSources.begin(), kSignalSources.end()},
          "write where its value comes from, as in TOPIC /battery FIELD percentage");
    }
    return true;
  }

  // FROM, if it is there.
  bool publisher(Scanner& s, syntax::Signal& signal) {
    if (s.peek().text != "FROM") return true;
    s.next();
    auto component = read_.component_reference(s);
    if (!component) return false;
    signal.from = std::move(*component);
    return true;
  }

  bool range(Scanner& s, syntax::Signal& signal) {
    const Span span = s.rest();
    const auto low = read_.signed_number(s);
    if (!low || !read_.expect_symbol(s, "..", "write the two ends, as in RANGE 0..100"))
      return false;
    const auto high = read_.signed_number(s);
    if (!high) return false;
    signal.range = {*low, *high, span};
    return true;
  }

  // ---- reuse

  bool include(Scanner& s) {
    is_in_rule_ = false;
    if (template_)
      return read_.fail(Code::kOutOfPlace, keyword_, "an INCLUDE stands in no TEMPLATE",
                        "put it in front of the TEMPLATE");
    auto include = read_include(read_, s, {keyword_.begin, line_.end});
    if (!include) return false;
    into_->includes.push_back(std::move(*include));
    return true;
  }

  bool use(Scanner& s) {
    is_in_rule_ = false;
    auto use = read_use(read_, s, {keyword_.begin, line_.end});
    if (!use) return false;
    into_->uses.push_back(std::move(*use));
    return true;
  }

  // Its lines are its own also if its first one is broken.
  bool begin_template(Scanner& s) {
    is_in_rule_ = false;
    if (template_)
      return read_.fail(Code::kOutOfPlace, keyword_, "a TEMPLATE stands in no other one",
                        "write END behind the last statement of the one above");
    auto read = read_template(read_, s);
    const bool is_good = read.has_value();
    template_ = is_good ? std::move(*read) : syntax::Template{};
    template_->span.begin = line_.begin;
    template_->lines.begin = behind_line();
    template_keyword_ = keyword_;
    into_ = &template_->body;
    return is_good;
  }

  void template_line() {
    std::vector<Lexeme> taken;
    Scanner scanner(source_.text(), line_, &taken, Holes::kAllowed);
    if (!scanner.at_end()) statement(scanner);
    // One without a name has a broken first line, and its parameters are not known.
    const bool are_known = template_ && !template_->name.text.empty();
    if (are_known && !check_holes(read_, source_.text(), taken, *template_)) broken();
    if (lexemes_ != nullptr) lexemes_->insert(lexemes_->end(), taken.begin(), taken.end());
  }

  bool end_template(Scanner&) {
    is_in_rule_ = false;
    if (!template_)
      return read_.fail(Code::kOutOfPlace, keyword_, "this END closes no TEMPLATE",
                        "remove it, or write TEMPLATE name(parameters) above");
    close_template(line_.begin, behind_line());
    return true;
  }

  void close_template(std::uint32_t lines_end, std::uint32_t end) {
    template_->lines.end = lines_end;
    template_->span.end = end;
    into_ = &file_;
    into_->templates.push_back(std::move(*template_));
    template_.reset();
  }

  std::uint32_t behind_line() const {
    const auto end = source_.text().find('\n', line_.end);
    return end == std::string_view::npos ? text_end() : static_cast<std::uint32_t>(end + 1);
  }
  std::uint32_t text_end() const { return static_cast<std::uint32_t>(source_.text().size()); }

  // ---- rules

  bool rule(Scanner& s) {
    into_->rules.emplace_back();
    is_in_rule_ = true;
    has_duplicate_line_ = false;
    // A part that stands before the rule may be the one that the rule then lacks.
    into_->rules.back().has_broken_part = std::exchange(stray_part_, false);
    auto name = read_.declared_name(s, "the rule's name");
    if (!name) return false;
    into_->rules.back().name = *name;
    return read_.is_one_word(s, *name);
  }

  bool policies(Scanner& s) {
    if (!inside_rule("POLICIES")) return false;
    syntax::Rule& rule = into_->rules.back();
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
    struct Other {
      std::string_view word, meant, remedy;
    };
    constexpr std::array<Other, 8> kOthers = {
        {{"CRITICAL", "ERROR", "did you mean ERROR, the highest one?"},
         {"FATAL", "ERROR", "did you mean ERROR, the highest one?"},
         {"HIGH", "ERROR", "did you mean ERROR, the highest one?"},
         {"WARN", "WARNING", "did you mean WARNING?"},
         {"MEDIUM", "WARNING", "did you mean WARNING, the middle one?"},
         {"INFO", "NON_CRITICAL", "did you mean NON_CRITICAL, the lowest one?"},
         {"NOTICE", "NON_CRITICAL", "did you mean NON_CRITICAL, the lowest one?"},
         {"LOW", "NON_CRITICAL", "did you mean NON_CRITICAL, the lowest one?"}}};
    for (const auto& [word, meant, remedy] : kOthers) {
      if (upper_case(level.text) != word) continue;
      return read_.fail(Code::kSyntax, level.span,
                        "there is no criticality " + std::string(level.text), std::string(remedy),
                        Edit{level.span, std::string(meant)});
    }
    if (level.text == "ERROR" || level.text == "FAILURE") {
      policies.criticality = kError;
    } else if (level.text == "WARNING" || level.text == "DEGRADED") {
      policies.criticality = kWarning;
    } else if (level.text == "NON_CRITICAL" || level.text == "OK") {
      policies.criticality = kNonCritical;
    } else if (level.has_hole) {
      policies.criticality = kError;
    } else {
      return read_.unexpected_clause(
          level, {"ERROR", "WARNING", "NON_CRITICAL", "FAILURE", "DEGRADED", "OK"},
          "a criticality comes first: NON_CRITICAL, WARNING or ERROR");
    }
    return true;
  }

  bool policy(Scanner& s, syntax::Policies& policies) {
    const Token clause = s.next();
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
      if (!needed || !read_.expect_symbol(
                         s, "/", "write two numbers: HOLD 3/5 is true in 3 of the last 5 cycles"))
        return false;
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
    if (clause.text == "REPORT" && !policies.is_report) return policies.is_report = true;
    return read_.unexpected_clause(clause,
                                   {"FOR", "HOLD", "COOLDOWN", "ATTEMPTS", "ON_CHANGE", "REPORT"},
                                   "", Code::kUnknownPolicy);
  }

  bool trigger(Scanner& s) {
    if (!inside_rule("TRIGGER")) return false;
    if (into_->rules.back().trigger) return duplicate_line("TRIGGER");
    auto expression = read_.expression(s);
    if (!expression || !read_.line_ends(s)) return false;
    into_->rules.back().trigger = std::move(*expression);
    return true;
  }

  bool strategy(Scanner& s) {
    if (!inside_rule("STRATEGY")) return false;
    syntax::Rule& rule = into_->rules.back();
    if (rule.strategies.empty()) rule.strategies.reserve(2);  // as most rules have
    rule.strategies.emplace_back();
    rule.strategies.back().has_broken_adaptation = true;  // until the line is understood
    auto name = read_.identifier(s, "the strategy's name");
    if (!name || !read_.is_one_word(s, *name)) return false;
    const auto probability =
        read_.number(s, "the success probability in percent",
                     s.at_end() ? "write how often it helps and how sure that is, as in 80 10"
                     : s.peek().text == "LASTRESORT" || s.peek().text == "WHEN"
                         ? "write " + std::string(s.peek().text) + " behind the two numbers"
                         : "");
    if (!probability) return false;
    const auto confidence = read_.number(
        s, "the confidence in it (1 to 100)",
        s.at_end() ? "write how many past attempts the probability is worth, as 10" : "");
    if (!confidence) return false;
    const bool is_last_resort = s.peek().text == "LASTRESORT";
    if (is_last_resort) s.next();
    std::optional<Duration> within;
    if (s.peek().text == "WITHIN") {
      const Token word = s.next();
      if (!is_last_resort)
        return read_.fail(Code::kOutOfPlace, word.span, "WITHIN belongs to a LASTRESORT",
                          "write LASTRESORT before it, or leave it out");
      within = read_.positive_duration(s, "how long the other strategies of the rule have");
      if (!within) return false;
    }
    std::optional<syntax::Expression> when;
    if (s.peek().text == "WHEN") {
      s.next();
      when = read_.expression(s);
      if (!when || !read_.line_ends(s)) return false;
    }
    rule.strategies.back() = {std::move(*name), *probability, *confidence, std::move(when), {},
                              is_last_resort,   within,       false};
    return true;
  }

  // THEN ADAPTATION …: a step of its own.
  bool step(Scanner& s) {
    const Span then = keyword_;
    const Token word = s.peek();
    if (!inside_rule("THEN") || !read_.expect_word(s, "ADAPTATION")) return false;
    keyword_ = word.span;
    const auto& strategies = into_->rules.back().strategies;
    const bool is_first = !strategies.empty() && strategies.back().adaptations.empty() &&
                          !strategies.back().has_broken_adaptation;
    if (is_first)
      return read_.fail(Code::kOutOfPlace, then, "THEN needs an ADAPTATION above it",
                        "begin the first step with ADAPTATION",
                        Edit{{then.begin, word.span.begin}, ""});
    if (!adaptation(s)) return false;
    into_->rules.back().strategies.back().adaptations.back().begins_step = true;
    return true;
  }

  bool adaptation(Scanner& s) {
    if (!inside_rule("ADAPTATION")) return false;
    syntax::Rule& rule = into_->rules.back();
    if (rule.strategies.empty()) {
      if (rule.has_broken_part) return false;
      return read_.fail(Code::kOutOfPlace, keyword_, "an ADAPTATION belongs to a STRATEGY",
                        "put a STRATEGY line before it");
    }
    auto component = read_.component_reference(s);
    if (!component) return false;
    const Token word = s.next();
    const auto type = syntax::adaptation_type(word.text);
    if (!type && syntax::adaptation_type(component->text)) return lacks_component(*component, word);
    if (!type) return unknown_adaptation(word, s);
    syntax::Adaptation adaptation;
    adaptation.component = std::move(*component);
    adaptation.type = *type;
    if (!adaptation_arguments(s, adaptation)) return false;
    const auto impact = read_.number(s, "the impact in cycles", impact_remedy(adaptation, s));
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
        if (!take_name(adaptation.subject, "the parameter")) return false;
        // "gain=2.0 5": what stands behind it is the impact.
        if (const auto sign = adaptation.subject.text.find('=');
            sign != std::string::npos && holds_one_number(s)) {
          const auto at = adaptation.subject.span.begin + static_cast<std::uint32_t>(sign);
          return read_.fail(Code::kSyntax, {at, at + 1},
                            "no '=' stands between a parameter and its value", "write a blank",
                            Edit{{at, at + 1}, " "});
        }
        if (const Token& sign = s.peek(); sign.is("="))
          return read_.fail(Code::kSyntax, sign.span,
                            "no '=' stands between a parameter and its value", "remove the '='",
                            Edit{sign.span, ""});
        adaptation.value = read_.expression(s);
        return adaptation.value.has_value();
      case kChangeCommunication:
        return take_name(adaptation.subject, "the parameter that holds the topic") &&
               take_name(adaptation.topic, "the topic");
      case kChangeMode:
        return take_name(adaptation.subject, "the mode");
      case kCall:
        if (!take_name(adaptation.subject, "the service")) return false;
        if (s.peek().kind == Token::Kind::kString)
          adaptation.request = read_.text(s, "the request", "");
        if (const Token& next = s.peek();
            next.kind == Token::Kind::kIdentifier && !source_.text(next.span).starts_with('{'))
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
        s.peek().kind != Token::Kind::kSymbol)
      return "remove it: " + std::string(keyword(adaptation.type)) + " takes the impact only";
    if (!adaptation.value) return "";
    if (!s.at_end()) return "";
    const std::string word(keyword(adaptation.type));
    return "the value and the impact stand at the end: " + word + " " + adaptation.subject.text +
           (adaptation.type == syntax::AdaptationType::kSetParameter ? " true 2" : " 0.5 2");
  }

  // "ADAPTATION redeploy camera 10", or no component at all
  bool lacks_component(const Name& type, const Token& word) {
    const bool is_swapped = word.kind == Token::Kind::kIdentifier;
    const std::string component = is_swapped ? std::string(word.text) : "component";
    const std::string right = component + " " + type.text;
    const Span span{type.span.begin, is_swapped ? word.span.end : type.span.end};
    return read_.fail(Code::kSyntax, span, "the component stands in front of what to do with it",
                      "write ADAPTATION " + right,
                      is_swapped ? std::optional(Edit{span, right}) : std::nullopt);
  }

  bool unknown_adaptation(const Token& word, Scanner& s) {
    if (hyphenated_adaptation(word, s)) return false;
    if (word.kind != Token::Kind::kIdentifier)
      return read_.fail_token(word, "what to do with the component", "");
    std::string plain(word.text);
    std::transform(plain.begin(), plain.end(), plain.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    if (plain.starts_with("action_")) plain.erase(0, 7);  // as in the reference's dialect
    std::string near =
        syntax::adaptation_type(plain) ? plain : std::string(adaptation_of_other_tools(plain));
    if (near.empty()) near = closest(plain, syntax::adaptation_keywords());
    return read_.fail(
        Code::kUnknownAdaptation, word.span,
        "there is no adaptation '" + std::string(word.text) + "'",
        near.empty()
            ? "known: set_parameter increase_parameter decrease_parameter change_communication "
              "activate deactivate restart redeploy start stop change_mode call start_group"
            : "did you mean '" + near + "'?",
        replacement(word.span, near));
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

  bool inside_rule(std::string_view keyword) {
    if (is_in_rule_) return true;
    stray_part_ = true;
    return read_.fail(
        Code::kOutOfPlace, keyword_, std::string(keyword) + " belongs to a RULE",
        into_->rules.empty()
            ? "put a RULE line before it"
            : "put a RULE line before it: INCLUDE, TEMPLATE and USE end the one above");
  }

  // Where one line is there twice, a RULE line is missing more likely, and the other lines follow.
  bool duplicate_line(const std::string& keyword) {
    if (std::exchange(has_duplicate_line_, true)) return false;
    return read_.fail(Code::kOutOfPlace, keyword_, "this rule has a " + keyword + " line already",
                      "keep one, or begin a new RULE before this line");
  }

  // The line was not understood: whatever its absence would make look wrong stays unreported.
  void broken() {
    if (!is_in_rule_) return;
    syntax::Rule& rule = into_->rules.back();
    rule.has_broken_part = true;
    if (!rule.strategies.empty()) rule.strategies.back().has_broken_adaptation = true;
  }

  const Source& source_;
  LineReader read_;
  std::vector<Lexeme>* lexemes_;
  syntax::File& file_;
  syntax::File* into_ = &file_;      // what statements become part of: this, or a template's body
  Span line_;                        // that is at hand
  Span keyword_;                     // of it
  bool is_in_rule_ = false;          // a part of a rule would belong to the last one
  bool stray_part_ = false;          // a part of a rule stood before any RULE line
  bool has_duplicate_line_ = false;  // of the rule at hand, which was reported
  std::optional<syntax::Template> template_;  // that is not closed yet
  Span template_keyword_;
};

// As editors of old computers end lines. A carriage return is a blank elsewhere.
bool has_line_of_a_carriage_return(std::string_view text) {
  for (auto at = text.find('\r'); at != std::string_view::npos; at = text.find('\r', at + 1)) {
    if (at + 1 < text.size() && text[at + 1] >= 'A' && text[at + 1] <= 'Z') return true;
  }
  return false;
}

// Text of a kind that has no lines for us: each of them would be a mistake.
std::optional<Diagnostic> foreign_text(const Source& source) {
  const std::string_view text = source.text();
  const Span begin{0, std::min<std::uint32_t>(1, static_cast<std::uint32_t>(text.size()))};
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    return Diagnostic{Code::kBadToken, Severity::kError, begin, "this file is UTF-16",
                      "save it as UTF-8"};
  if (text.find('\n') == std::string_view::npos && has_line_of_a_carriage_return(text))
    return Diagnostic{Code::kBadToken, Severity::kError, begin,
                      "the lines of this file end with a carriage return only",
                      "save it with Unix line ends (LF)"};
  return std::nullopt;
}

// For what large files have many of: a vector that grows moves all that it has, again and again.
void reserve(syntax::File& file, const Source& source) {
  std::size_t components = 0, dependencies = 0, signals = 0, rules = 0;
  for (std::uint32_t number = 1; number <= source.line_count(); ++number) {
    const std::string_view line = unindented(source.text(source.line(number)));
    components += line.starts_with("COMPONENT") ? 1 : 0;
    dependencies += line.starts_with("DEPENDENCY") ? 1 : 0;
    signals += line.starts_with("SIGNAL") ? 1 : 0;
    rules += line.starts_with("RULE") ? 1 : 0;
  }
  file.components.reserve(components);
  file.dependencies.reserve(dependencies);
  file.signals.reserve(signals);
  file.rules.reserve(rules);
}

}  // namespace

syntax::File parse(const Source& source, std::vector<Diagnostic>& diagnostics,
                   std::vector<Lexeme>* lexemes) {
  syntax::File file;
  if (const auto foreign = foreign_text(source)) {
    diagnostics.push_back(*foreign);
    return file;
  }
  reserve(file, source);
  Parser(source, file, diagnostics, lexemes).parse();
  return file;
}

Parsed parse_whole(Source source) {
  Parsed out{std::move(source), {}, {}};
  out.file = parse(out.source, out.said);
  return out;
}

}  // namespace culprit
