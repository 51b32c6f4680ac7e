#include "import/condition_dialect.h"

#include <array>

#include "import/actions.h"
#include "import/expression_reader.h"
#include "import/file_reader.h"
#include "language/expression_parser.h"
#include "language/scanner.h"

namespace culprit::foreign {
namespace {

using syntax::Operator;
using Kind = Expression::Kind;
using enum AdaptationType;

bool is_space(char c) { return c == ' ' || c == '\t'; }

class ConditionDialect {
 public:
  explicit ConditionDialect(const Source& source)
      : reader_(source, {"RULE", "COMPONENTS", "IF", "THEN"}) {}

  Expected<File> read() {
    reader_.file().dialect = "RULE, COMPONENTS, IF, THEN";
    reader_.file().last_constant_counts = true;
    auto file = reader_.read([this](const std::vector<Word>& words) { return statement(words); });
    if (file && expected_ != kRule && !out_of_order(rule_span_, "the end")) {
      return Error{reader_.error()};
    }
    return file;
  }

 private:
  enum Line { kRule, kComponents, kIf, kThen };

  bool statement(const std::vector<Word>& words) {
    static constexpr std::array<std::string_view, 4> kKeywords = {"RULE", "COMPONENTS", "IF",
                                                                  "THEN"};
    const std::string& head = words[0].text;
    if (head != kKeywords[expected_]) return out_of_order(words[0].span, head);
    switch (expected_) {
      case kRule:
        expected_ = kComponents;
        return rule(words);
      case kComponents:
        expected_ = kIf;
        return components(words);
      case kIf:
        expected_ = kThen;
        return condition(words);
      case kThen:
        expected_ = kRule;
        return then(words);
    }
    return false;
  }

  bool out_of_order(Span span, const std::string& what) {
    return reader_.fail(span, what + " is out of place",
                        "a rule is four lines: RULE, COMPONENTS, IF, THEN");
  }

  Rule& present() { return reader_.file().rules.back(); }

  bool rule(const std::vector<Word>& words) {
    Rule rule;
    rule.remarks = reader_.remarks();
    rule_span_ = words[0].span;
    if (words.size() < 2 || words.size() > 3)
      return reader_.fail(words[0].span, "a rule has a name and perhaps a policy",
                          "write RULE name ON_TRIGGER_CHANGE");
    rule.name = words[1].text;
    const std::string policy = words.size() == 3 ? words[2].text : "ON_TRIGGER_CHANGE";
    if (policy != "ON_TRIGGER_CHANGE" && policy != "ON_EVERY_TRIGGER")
      return reader_.fail(words[2].span, "there is no policy '" + policy + "'",
                          "known: ON_TRIGGER_CHANGE, ON_EVERY_TRIGGER");
    rule.on_change = policy == "ON_TRIGGER_CHANGE";
    rule.repeats = !rule.on_change;
    reader_.file().rules.push_back(std::move(rule));
    return true;
  }

  bool components(const std::vector<Word>& words) {
    take_comments();
    components_.clear();
    const Span rest = reader_.rest(words, 1);
    const std::string_view text = reader_.source().text(rest);
    if (text.size() < 2 || text.front() != '[' || text.back() != ']')
      return reader_.fail(rest, "components stand in brackets",
                          "write for example COMPONENTS [/robot/camera, /robot/lidar]");
    std::string name;
    for (const char c : text.substr(1)) {
      if (c != ',' && c != ']' && !is_space(c)) {
        name += c;
      } else if (!name.empty()) {
        components_.push_back(std::move(name));
        name.clear();
      }
    }
    return !components_.empty() ||
           reader_.fail(rest, "a rule adapts at least one component", "name it in the brackets");
  }

  bool condition(const std::vector<Word>& words) {
    take_comments();
    const Span rest = reader_.rest(words, 1);
    at_ = rest.begin;
    end_ = rest.end;
    auto trigger = group(0);
    if (!trigger) return false;
    skip_blanks();
    if (at_ != end_)
      return reader_.fail({at_, end_}, "this text does not belong to the condition",
                          "put one pair of parentheses around the whole of it");
    present().trigger = std::move(*trigger);
    return true;
  }

  // '(' comparison ')', or '(' group AND group ... ')'.
  std::optional<Expression> group(int depth) {
    skip_blanks();
    const Span open{at_, at_ < end_ ? at_ + 1 : at_};
    if (at_ == end_ || text()[at_] != '(') return fail(open, "a condition begins with '('");
    if (depth >= kMaxNesting) return fail(open, "this condition is nested too deeply");
    ++at_;
    skip_blanks();
    auto content = at_ < end_ && text()[at_] == '(' ? chain(depth) : comparison();
    if (!content) return std::nullopt;
    skip_blanks();
    if (at_ == end_ || text()[at_] != ')') return fail(open, "this '(' is never closed");
    ++at_;
    return content;
  }

  std::optional<Expression> chain(int depth) {
    auto left = group(depth + 1);
    std::string used;
    for (int length = 1; left; ++length) {
      const Word word = next_word();
      if (word.text.empty()) break;
      if (length + depth > kMaxNesting)
        return fail(word.span, "this condition is nested too deeply");
      if (word.text != "AND" && word.text != "OR")
        return fail(word.span, "expected AND or OR, not '" + word.text + "'");
      if (!used.empty() && used != word.text)
        return fail(word.span, "AND and OR stand in one pair of parentheses");
      used = word.text;
      auto right = group(depth + length);
      if (!right) return std::nullopt;
      left = binary(used == "AND" ? Operator::kAnd : Operator::kOr, std::move(*left),
                    std::move(*right));
    }
    return left;
  }

  std::optional<Expression> comparison() {
    struct Comparison {
      std::string_view symbol;
      Operator op;
    };
    static constexpr std::array kComparisons = {
        Comparison{"==", Operator::kEqual},  Comparison{"!=", Operator::kNotEqual},
        Comparison{"<", Operator::kLess},    Comparison{"<=", Operator::kLessEqual},
        Comparison{">", Operator::kGreater}, Comparison{">=", Operator::kGreaterEqual},
    };
    const Word left = next_word();
    const Word op = next_word();
    const Word right = next_word();
    if (right.text.empty())
      return fail({left.span.begin, right.span.end},
                  "a comparison is three words: name, operator and name");
    for (const Comparison& known : kComparisons) {
      if (known.symbol != op.text) continue;
      return binary(known.op, operand(left), operand(right));
    }
    return fail(op.span, "there is no operator '" + op.text + "'");
  }

  // A name, of whatever characters. A number or true is a name, too, in the reference.
  Expression operand(const Word& word) {
    Expression e;
    Scanner scanner(text(), word.span);
    const Token token = scanner.next();
    const bool is_whole = token.span == word.span;
    const bool is_truth = token.text == "true" || token.text == "false";
    if (is_whole && (token.kind == Token::Kind::kNumber || is_truth)) {
      e.literal = token.value();
      present().remarks.notes.push_back("the reference takes " + word.text +
                                        " for a name, and finds no value of it; it is read as "
                                        "written");
      return e;
    }
    e.kind = Kind::kName;
    e.name = {word.text, word.span};
    return e;
  }

  bool then(const std::vector<Word>& words) {
    take_comments();
    if (words.size() < 2)
      return reader_.fail(words[0].span, "THEN needs an action", std::string(kKnownActions));
    const auto type = action(words[1].text);
    if (!type || type == kChangeMode)
      return reader_.fail(words[1].span, "there is no action '" + words[1].text + "'",
                          std::string(kKnownActions));
    const std::size_t wanted = takes_value(*type) ? 4 : 2;
    if (words.size() < wanted)
      return reader_.fail(words[1].span, words[1].text + " needs a parameter and a value",
                          "write THEN " + words[1].text + " parameter name_of_the_value");
    if (words.size() > wanted)
      return reader_.fail(words[wanted].span, "this text does not belong to the line", "remove it");
    Strategy strategy;
    strategy.remarks.line = present().remarks.line;
    strategy.name = present().name;
    for (const std::string& component : components_) {
      Adaptation adaptation;
      adaptation.remarks.line = present().remarks.line;
      adaptation.component = component;
      adaptation.type = *type;
      if (takes_value(*type)) {
        adaptation.subject = words[2].text;
        adaptation.value = operand(words[3]);
      }
      strategy.adaptations.push_back(std::move(adaptation));
    }
    present().strategies.push_back(std::move(strategy));
    return true;
  }

  std::string_view text() const { return reader_.source().text(); }
  void skip_blanks() {
    while (at_ < end_ && is_space(text()[at_])) ++at_;
  }
  // Up to a blank or a parenthesis.
  Word next_word() {
    skip_blanks();
    const std::uint32_t begin = at_;
    while (at_ < end_ && !is_space(text()[at_]) && text()[at_] != '(' && text()[at_] != ')') ++at_;
    return {std::string(text().substr(begin, at_ - begin)), {begin, at_}};
  }

  std::nullopt_t fail(Span span, const std::string& cause) {
    reader_.fail(span, cause, "write for example IF ((a < b) AND (c == d))");
    return std::nullopt;
  }

  void take_comments() {
    Remarks more = reader_.remarks();
    std::vector<std::string>& comments = present().remarks.comments;
    for (std::string& comment : more.comments) comments.push_back(std::move(comment));
    if (!more.comment_behind.empty()) comments.push_back(std::move(more.comment_behind));
  }

  FileReader reader_;
  Line expected_ = kRule;
  Span rule_span_;
  std::vector<std::string> components_;
  std::uint32_t at_ = 0;
  std::uint32_t end_ = 0;
};

}  // namespace

Expected<File> read_condition_dialect(const Source& source) {
  return ConditionDialect(source).read();
}

}  // namespace culprit::foreign
