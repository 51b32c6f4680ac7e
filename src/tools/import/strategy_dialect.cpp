#include "import/strategy_dialect.h"

#include "import/actions.h"
#include "import/expression_reader.h"
#include "import/file_reader.h"

namespace culprit::foreign {
namespace {

using enum AdaptationType;

class StrategyDialect {
 public:
  explicit StrategyDialect(const Source& source)
      : reader_(source, {"RULE", "POLICIES", "TRIGGER", "STRATEGY", "ADAPTATION"}) {}

  Expected<File> read() {
    reader_.file().dialect = "RULE, POLICIES, TRIGGER, STRATEGY, ADAPTATION";
    auto file = reader_.read([this](const std::vector<Word>& words) { return statement(words); });
    if (!file) return file;
    if (!file->rules.empty() && !is_complete(file->rules.back())) return Error{reader_.error()};
    return file;
  }

 private:
  bool statement(const std::vector<Word>& words) {
    const std::string& head = words[0].text;
    if (head == "RULE") return rule(words);
    if (reader_.file().rules.empty())
      return reader_.fail(words[0].span, head + " belongs to a RULE", "put a RULE line before it");
    Rule& rule = reader_.file().rules.back();
    if (head == "POLICIES") return policies(words, rule);
    if (head == "TRIGGER") return trigger(words, rule);
    return head == "STRATEGY" ? strategy(words, rule) : adaptation(words, rule);
  }

  bool rule(const std::vector<Word>& words) {
    if (!reader_.file().rules.empty() && !is_complete(reader_.file().rules.back())) return false;
    if (words.size() != 2)
      return reader_.fail(words[0].span, "a rule has one name", "write RULE name");
    Rule rule;
    rule.remarks = reader_.remarks();
    rule.name = words[1].text;
    reader_.file().rules.push_back(std::move(rule));
    rule_span_ = words[1].span;
    has_trigger_ = false;
    return true;
  }

  bool is_complete(const Rule& rule) {
    const char* missing = !rule.criticality         ? "POLICIES"
                          : !has_trigger_           ? "TRIGGER"
                          : rule.strategies.empty() ? "STRATEGY"
                                                    : nullptr;
    return missing == nullptr ||
           reader_.fail(rule_span_, "rule '" + rule.name + "' has no " + missing,
                        "add it, or remove the rule");
  }

  bool policies(const std::vector<Word>& words, Rule& rule) {
    if (rule.criticality) return twice(words[0]);
    if (words.size() < 2 || words.size() > 4)
      return reader_.fail(words[0].span, "policies are a level, when to act, and a filter",
                          "write for example POLICIES FAILURE ON_TICK 1/1");
    const std::string& level = words[1].text;
    using enum Criticality;
    if (level == "OK" || level == "NON_CRITICAL") rule.criticality = kNonCritical;
    if (level == "DEGRADED" || level == "WARNING") rule.criticality = kWarning;
    if (level == "FAILURE" || level == "ERROR") rule.criticality = kError;
    if (!rule.criticality)
      return reader_.fail(words[1].span, "there is no level '" + level + "'",
                          "known: OK, DEGRADED, FAILURE");
    take_comments(rule.remarks);
    if (words.size() > 2 && words[2].text != "ON_TICK" && words[2].text != "ON_CHANGE")
      return reader_.fail(words[2].span, "there is no policy '" + words[2].text + "'",
                          "known: ON_TICK, ON_CHANGE");
    rule.on_change = words.size() > 2 && words[2].text == "ON_CHANGE";
    if (rule.on_change)
      rule.remarks.notes.push_back(
          "ON_CHANGE: the reference calls any strategy of such a rule successful one tick later; "
          "here its verdict waits for the trigger to become false");
    return words.size() < 4 || filter(words[3], rule);
  }

  bool filter(const Word& word, Rule& rule) {
    const std::size_t slash = word.text.find('/');
    const auto whole = [](const std::string& digits) {
      const bool is_number = !digits.empty() && digits.size() <= 9 &&
                             digits.find_first_not_of("0123456789") == std::string::npos;
      return is_number ? std::stoll(digits) : 0;
    };
    if (slash != std::string::npos) {
      rule.hold_needed = whole(word.text.substr(0, slash));
      rule.hold_window = whole(word.text.substr(slash + 1));
    }
    if (slash == std::string::npos || rule.hold_needed < 1 || rule.hold_window < rule.hold_needed)
      return reader_.fail(word.span, "'" + word.text + "' is no filter",
                          "write n/k: true in n of the last k ticks, 1 <= n <= k");
    if (rule.hold_needed != rule.hold_window)
      rule.remarks.notes.push_back("the reference reads the filter " + word.text + " as " +
                                   std::to_string(rule.hold_needed) + "/" +
                                   std::to_string(rule.hold_needed) + "; it is taken as written");
    return true;
  }

  bool trigger(const std::vector<Word>& words, Rule& rule) {
    if (has_trigger_) return twice(words[0]);
    has_trigger_ = true;
    take_comments(rule.remarks);
    Scanner scanner(reader_.source().text(), reader_.rest(words, 1));
    auto expression = read_expression(scanner, reader_, rule.remarks.notes);
    if (!expression || !line_ends(scanner)) return false;
    rule.trigger = std::move(*expression);
    return true;
  }

  bool strategy(const std::vector<Word>& words, Rule& rule) {
    if (words.size() < 3 || words.size() > 4)
      return reader_.fail(words[0].span, "a strategy has a name and a success probability",
                          "write for example STRATEGY restart 40");
    Strategy strategy;
    strategy.remarks = reader_.remarks();
    strategy.name = words[1].text;
    for (std::size_t i = 2; i < words.size(); ++i) {
      const auto value = number(words[i]);
      if (!value) return false;
      (i == 2 ? strategy.probability : strategy.confidence) = value;
    }
    rule.strategies.push_back(std::move(strategy));
    return true;
  }

  std::optional<double> number(const Word& word) {
    Scanner scanner(reader_.source().text(), word.span);
    const Token token = scanner.next();
    if (token.kind == Token::Kind::kNumber && token.span == word.span) return value_of(token);
    reader_.fail(word.span, "'" + word.text + "' is no number", "write a percentage, 0 to 100");
    return std::nullopt;
  }

  bool adaptation(const std::vector<Word>& words, Rule& rule) {
    if (rule.strategies.empty())
      return reader_.fail(words[0].span, "an ADAPTATION belongs to a STRATEGY",
                          "put a STRATEGY line before it");
    if (words.size() < 3)
      return reader_.fail(words[0].span, "an adaptation has a component and an action",
                          "write for example ADAPTATION /robot/camera action_restart");
    const auto type = action(words[2].text);
    if (!type)
      return reader_.fail(words[2].span, "there is no action '" + words[2].text + "'",
                          std::string(kKnownActions));
    Adaptation adaptation;
    adaptation.remarks = reader_.remarks();
    adaptation.component = words[1].text;
    adaptation.type = *type;
    Scanner scanner(reader_.source().text(), reader_.rest(words, 3));
    if (!arguments(scanner, words, adaptation)) return false;
    impact(scanner, adaptation);
    if (!line_ends(scanner)) return false;
    rule.strategies.back().adaptations.push_back(std::move(adaptation));
    return true;
  }

  bool arguments(Scanner& scanner, const std::vector<Word>& words, Adaptation& adaptation) {
    const bool needs_subject = takes_value(adaptation.type) || adaptation.type == kChangeMode;
    if (!needs_subject) return true;
    if (words.size() < 4)
      return reader_.fail(
          words[2].span, words[2].text + " needs an argument",
          adaptation.type == kChangeMode ? "name the mode" : "name the parameter and its value");
    adaptation.subject = words[3].text;
    scanner = Scanner(reader_.source().text(), reader_.rest(words, 4));
    if (adaptation.type == kChangeMode) {
      const bool is_quoted = adaptation.subject.size() > 2 && adaptation.subject.front() == '"' &&
                             adaptation.subject.back() == '"';
      if (!is_quoted) return true;
      adaptation.subject = adaptation.subject.substr(1, adaptation.subject.size() - 2);
      adaptation.remarks.notes.push_back("the reference would send the quotes as part of the mode");
      return true;
    }
    auto value = read_expression(scanner, reader_, adaptation.remarks.notes);
    if (!value) return false;
    adaptation.value = std::move(*value);
    return true;
  }

  static void impact(Scanner& scanner, Adaptation& adaptation) {
    const Token token = scanner.peek();
    if (token.kind == Token::Kind::kNumber) adaptation.impact = value_of(scanner.next());
  }

  static double value_of(const Token& number) {
    const auto* whole = std::get_if<std::int64_t>(&number.literal);
    return whole != nullptr ? static_cast<double>(*whole) : std::get<double>(number.literal);
  }

  bool line_ends(const Scanner& scanner) {
    return scanner.at_end() || reader_.fail(scanner.rest(), "this text does not belong to the line",
                                            "remove it, or begin a comment with //");
  }

  // Comments at a rule's POLICIES and TRIGGER become comments of the rule.
  void take_comments(Remarks& remarks) {
    Remarks more = reader_.remarks();
    if (!more.comment_behind.empty()) more.comments.push_back(std::move(more.comment_behind));
    for (std::string& comment : more.comments) remarks.comments.push_back(std::move(comment));
  }

  bool twice(const Word& word) {
    return reader_.fail(word.span, "this rule has a " + word.text + " line already",
                        "keep one of them");
  }

  FileReader reader_;
  Span rule_span_;  // of the last rule's name
  bool has_trigger_ = false;
};

}  // namespace

Expected<File> read_strategy_dialect(const Source& source) {
  return StrategyDialect(source).read();
}

}  // namespace culprit::foreign
