#include "language/parser.h"

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "language/declaration_reader.h"
#include "language/line_reader.h"
#include "language/reserved_words.h"
#include "language/reuse/statements.h"
#include "language/rule_reader.h"
#include "language/scanner.h"
#include "language/unknown_line.h"

namespace culprit {
namespace {

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
      if (scanner.at_end()) foreign_directive();
    }
    if (template_) {
      if (!template_->name.text.empty())
        read_.fail(Code::kIncomplete, template_keyword_, "this TEMPLATE has no END",
                   "write END on a line of its own behind its last statement");
      close_template(text_end(), text_end());
    }
  }

 private:
  struct Statement {
    std::string_view keyword;
    bool (Parser::*parse)(Scanner&);
  };

  static std::span<const Statement> statements() {
    static constexpr std::array kStatements = {
        Statement{"ROBOT", &Parser::setting<&DeclarationReader::robot>},
        Statement{"CYCLE", &Parser::setting<&DeclarationReader::cycle>},
        Statement{"CONST", &Parser::declaration<&DeclarationReader::constant>},
        Statement{"COMPONENT", &Parser::declaration<&DeclarationReader::component>},
        Statement{"DEPENDENCY", &Parser::declaration<&DeclarationReader::dependency>},
        Statement{"GROUP", &Parser::declaration<&DeclarationReader::group>},
        Statement{"IGNORE", &Parser::setting<&DeclarationReader::ignore>},
        Statement{"INTERLOCK", &Parser::setting<&DeclarationReader::interlock>},
        Statement{"ABORT", &Parser::setting<&DeclarationReader::abort>},
        Statement{"DRILL", &Parser::setting<&DeclarationReader::drill>},
        Statement{"SIGNAL", &Parser::declaration<&DeclarationReader::signal>},
        Statement{"RULE", &Parser::line_of_rule<&RuleReader::rule>},
        Statement{"POLICIES", &Parser::line_of_rule<&RuleReader::policies>},
        Statement{"TRIGGER", &Parser::line_of_rule<&RuleReader::trigger>},
        Statement{"STRATEGY", &Parser::line_of_rule<&RuleReader::strategy>},
        Statement{"ADAPTATION", &Parser::line_of_rule<&RuleReader::adaptation>},
        Statement{"THEN", &Parser::line_of_rule<&RuleReader::step>},
        Statement{"INCLUDE", &Parser::include},
        Statement{"TEMPLATE", &Parser::begin_template},
        Statement{"END", &Parser::end_template},
        Statement{"USE", &Parser::use},
    };
    return kStatements;
  }

  static const Statement* known(std::string_view word) {
    const char first = word.empty() ? '\0' : word.front();  // which most differ in
    for (const Statement& candidate : statements()) {
      if (candidate.keyword.front() == first && candidate.keyword == word) return &candidate;
    }
    return nullptr;
  }

  void statement(Scanner& s) {
    const Token head = s.next();
    is_below_unknown_ = std::exchange(is_unknown_, false);
    const Statement* meant = known(head.text);
    const std::size_t complaints = read_.complaints() + 1;
    keyword_ = head.span;
    bool is_good_head = meant != nullptr;
    const bool is_numbered = head.kind == Token::Kind::kNumber && s.peek().is(":");
    if (meant == nullptr && is_numbered) s.next();  // "12: RULE", as it was copied from an editor
    if (meant == nullptr && (meant = known(s.peek().text)) != nullptr) {
      keyword_ = s.next().span;
      superfluous_word(head);
    }
    if (meant == nullptr) meant = unknown_statement(head, s);
    if (meant == nullptr) return rules_.broken();
    if (has_placeholder(s)) is_good_head = false;
    if (has_colon(s)) is_good_head = false;  // it is taken, so that the line can be read
    // The expansion takes only the words as they are.
    if (!is_good_head && is_of_reuse(meant->keyword)) return reuse_was_meant(meant->keyword, s);
    const Scanner behind_keyword = s;
    const bool is_good = (this->*meant->parse)(s) && read_.line_ends(s);
    // One mistake, one message: the statement is read as it was meant, so that the lines that
    // follow stand where they belong; its own other mistakes show once its first word is right.
    if (!is_good_head) read_.forget_since(complaints);
    is_unfinished_ = !is_good && read_.complaints() > 0 &&
                     (read_.last_place() == line_.end ||  // something is missing there
                      is_unfinished(source_.text({head.span.begin, s.rest().end})));
    if (is_good && is_good_head) return;
    rules_.broken();
    broken_declaration(meant->keyword, behind_keyword);
  }

  // Reported. Null: nothing can be read in place of it.
  const Statement* unknown_statement(Token head, Scanner& s) {
    if (head.is("-") && s.peek().kind == Token::Kind::kIdentifier) head = s.next();  // a list
    std::vector<std::string_view> keywords;
    for (const Statement& each : statements()) keywords.push_back(each.keyword);
    keyword_ = head.span;
    const Statement* meant = known(report_unknown_line(
        {source_, read_, keywords, rules_.is_in_rule(), rules_.has_trigger(), is_unfinished_}, head,
        s));
    is_unfinished_ = is_unfinished_ && meant == nullptr &&
                     is_unfinished(source_.text({head.span.begin, s.rest().end}));
    is_unknown_ = meant == nullptr;
    const std::string_view rest = source_.text(s.rest());
    if (is_unknown_ && (s.peek().is("=") || rest.starts_with(":=")))
      declare_broken_constant(head);  // "limit = 0.5"
    return meant;
  }

  // One mistake, one message: a TEMPLATE ends where its END was meant.
  void reuse_was_meant(std::string_view keyword, const Scanner& behind) {
    rules_.broken();
    if (keyword != "END" || !template_ || !behind.at_end()) return;
    rules_.end_rule();
    close_template(line_.begin, behind_line());
  }

  static bool is_of_reuse(std::string_view keyword) {
    return keyword == "INCLUDE" || keyword == "TEMPLATE" || keyword == "END" || keyword == "USE";
  }

  // "ELSE STRATEGY …": all strategies of a rule are alternatives.
  void superfluous_word(const Token& head) {
    const std::string keyword(source_.text(keyword_));
    read_.fail(Code::kUnknownStatement, head.span,
               "unexpected '" + std::string(source_.text(head.span)) + "' before " + keyword,
               "remove it", Edit{{head.span.begin, keyword_.begin}, ""});
  }

  bool has_colon(Scanner& s) {
    const Token& token = s.peek();
    if (!token.is(":")) return false;
    read_.fail(Code::kExtraText, token.span, "unexpected ':' after the word of a statement",
               "remove the ':'", Edit{token.span, ""});
    s.next();
    return true;
  }

  // "#define limit 0.5", which is a comment.
  void foreign_directive() {
    constexpr std::string_view kDefine = "#define ";
    const std::string_view text = source_.text(line_);
    if (!text.starts_with(kDefine)) return;
    const auto begin = line_.begin + static_cast<std::uint32_t>(kDefine.size());
    Scanner s(source_.text(), {begin, line_.end});
    const Token name = s.next();
    if (name.kind != Token::Kind::kIdentifier || s.at_end()) return;
    const Span line{line_.begin, s.rest().end};
    const std::string meant =
        "CONST " + std::string(name.text) + " = " + std::string(source_.text(s.rest()));
    read_.fail(Code::kUnknownStatement, line, "this line is a comment, as it begins with '#'",
               "write " + meant, Edit{line, meant});
    declare_broken_constant(name);
  }

  void declare_broken_constant(const Token& name) {
    into_->broken_declarations.push_back(
        {syntax::BrokenDeclaration::Kind::kConstant, {std::string(name.text), name.span}});
  }

  // The name that the line was about to declare, so that its uses are not called undeclared.
  void broken_declaration(std::string_view keyword, Scanner s) {
    using Broken = syntax::BrokenDeclaration::Kind;
    const auto declare = [&](const Token& name) {
      if (keyword == "CONST") declare_broken_constant(name);
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

  template <bool (DeclarationReader::*read)(Scanner&)>
  bool declaration(Scanner& s) {
    return (DeclarationReader(source_, read_, *into_).*read)(s);
  }

  // Holds for the whole file. Among the lines of a rule, or indented below one, it looks like a part
  // of that rule.
  template <bool (DeclarationReader::*read)(Scanner&)>
  bool setting(Scanner& s) {
    if (rules_.is_in_rule()) {
      settings_below_rule_.push_back({std::string(source_.text(keyword_)), keyword_});
      if (is_indented_below_rule()) note_settings_in_rule();
    }
    return declaration<read>(s);
  }

  bool is_indented_below_rule() const {
    const Origin here = source_.origin(keyword_);
    const Origin rule = source_.origin(rule_keyword_);
    // The lines of a USE or an INCLUDE have an indentation of their own.
    return here.place.file == rule.place.file && here.steps.size() == rule.steps.size() &&
           source_.position(keyword_.begin).column > source_.position(rule_keyword_.begin).column;
  }

  void note_settings_in_rule() {
    auto& all = into_->settings_in_rules;
    all.insert(all.end(), settings_below_rule_.begin(), settings_below_rule_.end());
    settings_below_rule_.clear();
  }

  template <bool (RuleReader::*read)(Scanner&)>
  bool line_of_rule(Scanner& s) {
    if (read == &RuleReader::rule) {
      rule_keyword_ = keyword_;
      settings_below_rule_.clear();
    }
    note_settings_in_rule();
    rules_.begin_line(*into_, keyword_, is_below_unknown_);
    return (rules_.*read)(s);
  }

  // ---- reuse

  bool include(Scanner& s) {
    rules_.end_rule();
    if (template_)
      return read_.fail(Code::kOutOfPlace, keyword_, "an INCLUDE stands in no TEMPLATE",
                        "put it in front of the TEMPLATE");
    auto include = read_include(read_, s, {keyword_.begin, line_.end});
    if (!include) return false;
    into_->includes.push_back(std::move(*include));
    return true;
  }

  bool use(Scanner& s) {
    rules_.end_rule();
    auto use = read_use(read_, s, {keyword_.begin, line_.end});
    if (!use) return false;
    into_->uses.push_back(std::move(*use));
    return true;
  }

  // Its lines are its own also if its first one is broken.
  bool begin_template(Scanner& s) {
    rules_.end_rule();
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
    if (are_known && !check_holes(read_, source_.text(), taken, *template_)) rules_.broken();
    if (lexemes_ != nullptr) lexemes_->insert(lexemes_->end(), taken.begin(), taken.end());
  }

  bool end_template(Scanner& s) {
    rules_.end_rule();
    if (!template_)
      return read_.fail(Code::kOutOfPlace, keyword_, "this END closes no TEMPLATE",
                        "remove it, or write TEMPLATE name(parameters) above");
    close_template(line_.begin, behind_line());
    return s.at_end() || read_.fail(Code::kExtraText, s.rest(), "END stands alone on its line",
                                    "remove it", Edit{s.rest(), ""});
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

  const Source& source_;
  LineReader read_;
  RuleReader rules_{source_, read_};
  std::vector<Lexeme>* lexemes_;
  syntax::File& file_;
  syntax::File* into_ = &file_;  // what statements become part of: this, or a template's body
  Span line_;                    // that is at hand
  Span keyword_;                 // of it
  Span rule_keyword_;            // of the last RULE line
  std::vector<syntax::Name> settings_below_rule_;  // since the last line of that rule
  bool is_unknown_ = false;        // the statement at hand begins with no word of the language
  bool is_below_unknown_ = false;  // so did the one before
  bool is_unfinished_ = false;     // that one, which was reported, ends with an operator
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
