#include "language/rule_reader.h"

#include <array>
#include <utility>

#include "base/closest.h"
#include "language/adaptation_reader.h"

namespace culprit {

void RuleReader::begin_line(syntax::File& into, Span keyword, bool is_below_unknown_line) {
  into_ = &into;
  keyword_ = keyword;
  is_below_unknown_line_ = is_below_unknown_line;
}

void RuleReader::begin_unnamed_rule() {
  into_->rules.emplace_back().has_broken_part = true;
  is_in_rule_ = true;
  is_below_unknown_line_ = false;
}

bool RuleReader::rule(Scanner& s) {
  into_->rules.emplace_back();
  is_in_rule_ = true;
  has_duplicate_line_ = false;
  has_stray_adaptation_ = false;
  // A part that stands before the rule may be the one that the rule then lacks.
  into_->rules.back().has_broken_part = std::exchange(stray_part_, false);
  auto name = read_.declared_name(s, "the rule's name");
  if (!name) return false;
  into_->rules.back().name = *name;
  return read_.is_one_word(s, *name) && !has_condition(s);
}

// "RULE name WHEN condition", as other languages write it: reported.
bool RuleReader::has_condition(Scanner& s) {
  const Token& word = s.peek();
  const std::string upper = upper_case(word.text);
  if (upper != "WHEN" && upper != "IF") return false;
  return !read_.fail(Code::kExtraText, word.span, "the condition of a rule is a line of its own",
                     "write it on the next line, behind TRIGGER", Edit{word.span, "\n  TRIGGER"});
}

bool RuleReader::policies(Scanner& s) {
  if (!inside_rule("POLICIES")) return false;
  syntax::Rule& rule = into_->rules.back();
  if (rule.policies && is_below_unknown_line_) return begin_unnamed_rule(), policies(s);
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

bool RuleReader::criticality(Scanner& s, syntax::Policies& policies) {
  using enum syntax::Criticality;
  const Token level = s.next();
  struct Other {
    std::string_view word, meant, remedy;
  };
  constexpr std::array<Other, 13> kOthers = {
      {{"SEVERE", "ERROR", "did you mean ERROR, the highest one?"},
       {"PAGE", "ERROR", "did you mean ERROR, the highest one?"},
       {"MAJOR", "WARNING", "did you mean WARNING, the middle one?"},
       {"MINOR", "NON_CRITICAL", "did you mean NON_CRITICAL, the lowest one?"},
       {"DEBUG", "NON_CRITICAL", "did you mean NON_CRITICAL, the lowest one?"},
       {"CRITICAL", "ERROR", "did you mean ERROR, the highest one?"},
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
                      "there is no criticality '" + std::string(level.text) + "'",
                      std::string(remedy), Edit{level.span, std::string(meant)});
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
    if (read_.is_foreign_word(level, "POLICIES")) return false;
    return read_.unexpected_clause(
        level, {"ERROR", "WARNING", "NON_CRITICAL", "FAILURE", "DEGRADED", "OK"},
        "a criticality comes first: NON_CRITICAL, WARNING or ERROR");
  }
  return true;
}

bool RuleReader::policy(Scanner& s, syntax::Policies& policies) {
  const Token clause = s.next();
  if (clause.text == "FOR" && !policies.hold_for) {
    policies.hold_for = read_.positive_duration(s, "how long the trigger must hold");
    return policies.hold_for.has_value();
  }
  if (clause.text == "COOLDOWN" && !policies.cooldown) {
    policies.cooldown = read_.positive_duration(s, "the quiet time after a resolution");
    policies.cooldown_span = clause.span;
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
  if (clause.text == "ERROR" || clause.text == "WARNING" || clause.text == "NON_CRITICAL")
    return read_.fail(Code::kUnknownPolicy, clause.span, "a rule has one criticality",
                      "keep one of them");
  if (read_.is_foreign_word(clause, "POLICIES", Code::kUnknownPolicy)) return false;
  return read_.unexpected_clause(clause,
                                 {"FOR", "HOLD", "COOLDOWN", "ATTEMPTS", "ON_CHANGE", "REPORT"}, "",
                                 Code::kUnknownPolicy);
}

bool RuleReader::trigger(Scanner& s) {
  if (!inside_rule("TRIGGER")) return false;
  if (into_->rules.back().trigger) return duplicate_line("TRIGGER");
  if (s.at_end())
    return read_.fail(Code::kSyntax, s.peek().span, "a condition is missing here",
                      "write when the failure is there, as in TRIGGER age(/scan) > 1s");
  auto expression = read_.expression(s);
  if (!expression || !read_.condition_ends(s)) return false;
  into_->rules.back().trigger = std::move(*expression);
  return true;
}

bool RuleReader::strategy(Scanner& s) {
  if (!inside_rule("STRATEGY")) return false;
  syntax::Rule& rule = into_->rules.back();
  if (rule.strategies.empty()) rule.strategies.reserve(2);  // as most rules have
  rule.strategies.emplace_back();
  rule.strategies.back().has_broken_adaptation = true;  // until the line is understood
  if (is_name_last(s)) return false;
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
  if (const Token& next = s.peek(); is_last_resort && next.kind == Token::Kind::kDuration)
    return read_.fail(Code::kExtraText, next.span, "unexpected duration after LASTRESORT",
                      "write WITHIN in front of it",
                      Edit{{next.span.begin, next.span.begin}, "WITHIN "});
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
    if (s.peek().is(":")) return read_.fail_token(s.next(), "a condition", "");
    if (s.at_end())
      return read_.fail(Code::kSyntax, s.peek().span, "a condition is missing here",
                        "write it behind WHEN, as in WHEN speed < 0.1");
    when = read_.expression(s);
    if (const Token& next = s.peek(); when && (next.text == "LASTRESORT" || next.text == "WITHIN"))
      return read_.fail(Code::kExtraText, next.span,
                        std::string(next.text) + " stands in front of WHEN",
                        "write it behind the two numbers, as in 100 10 LASTRESORT WHEN docked");
    if (!when || !read_.condition_ends(s)) return false;
  }
  if (!when && !strategy_ends(s)) return false;
  rule.strategies.back() = {std::move(*name),
                            *probability,
                            *confidence,
                            std::move(when),
                            {},
                            is_last_resort,
                            within,
                            std::exchange(has_stray_adaptation_, false)};
  return true;
}

// "STRATEGY 80 10 restart": reported.
bool RuleReader::is_name_last(const Scanner& s) {
  Scanner ahead = s.ahead();
  const Token first = ahead.next();
  const Token second = ahead.next();
  const Token name = ahead.next();
  if (first.kind != Token::Kind::kNumber || second.kind != Token::Kind::kNumber ||
      name.kind != Token::Kind::kIdentifier)
    return false;
  const Span span{first.span.begin, name.span.end};
  const std::string meant =
      std::string(name.text) + " " + std::string(source_.text({first.span.begin, second.span.end}));
  return !read_.fail(Code::kSyntax, span, "a strategy's name stands in front of its numbers",
                     "write STRATEGY " + meant, Edit{span, meant});
}

bool RuleReader::strategy_ends(Scanner& s) {
  const Token& token = s.peek();
  if (read_.is_foreign_word(token, "STRATEGY", Code::kExtraText)) return false;
  const std::string upper = upper_case(token.text);
  if (upper == "IF" || upper == "UNLESS")
    return read_.fail(Code::kExtraText, token.span, "a strategy has no " + std::string(token.text),
                      "did you mean WHEN?", Edit{token.span, upper == "IF" ? "WHEN" : "WHEN !"});
  if (upper == "LAST_RESORT" || upper == "LAST")
    return read_.fail(Code::kExtraText, token.span, "a strategy has no " + std::string(token.text),
                      "did you mean LASTRESORT?");
  if (const std::string near = closest(upper, {"WHEN", "LASTRESORT", "WITHIN"});
      !near.empty() && near != upper && upper != "THEN")
    return read_.fail(Code::kExtraText, token.span, "a strategy has no " + std::string(token.text),
                      "did you mean " + near + "?", Edit{token.span, near});
  return read_.line_ends(
      s, "behind the probability and the confidence stand only LASTRESORT, WITHIN and WHEN");
}

bool RuleReader::step(Scanner& s) {
  const Span then = keyword_;
  const Token word = s.peek();
  const std::string remedy =
      s.at_end() ? "write both on one line, as in THEN ADAPTATION camera activate 2" : "";
  if (!inside_rule("THEN") || !read_.expect_word(s, "ADAPTATION", remedy)) return false;
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

bool RuleReader::adaptation(Scanner& s) {
  if (!inside_rule("ADAPTATION")) return false;
  syntax::Rule& rule = into_->rules.back();
  if (rule.strategies.empty()) {
    if (rule.has_broken_part) return false;
    has_stray_adaptation_ = true;
    return read_.fail(Code::kOutOfPlace, keyword_, "an ADAPTATION belongs to a STRATEGY",
                      "put a STRATEGY line before it");
  }
  auto adaptation = read_adaptation(read_, source_, s);
  constexpr std::string_view kEnd =
      "the impact, a number of cycles without a unit, is the last word of the line";
  if (!adaptation || read_.is_foreign_word(s.peek(), "ADAPTATION", Code::kExtraText) ||
      !read_.line_ends(s, kEnd))
    return false;
  adaptation->span.begin = keyword_.begin;
  rule.strategies.back().adaptations.push_back(std::move(*adaptation));
  return true;
}

bool RuleReader::inside_rule(std::string_view keyword) {
  if (is_in_rule_) return true;
  // The line above may be what should begin the rule.
  if (is_below_unknown_line_) return begin_unnamed_rule(), true;
  // One mistake, one message: the rule has more parts.
  if (std::exchange(stray_part_, true)) return false;
  return read_.fail(Code::kOutOfPlace, keyword_, std::string(keyword) + " belongs to a RULE",
                    into_->rules.empty()
                        ? "put a RULE line before it"
                        : "INCLUDE, TEMPLATE and USE end the rule above: move that line out of the "
                          "rule, or put a RULE line before this one");
}

// Where one line is there twice, a RULE line is missing more likely, and the other lines follow.
bool RuleReader::duplicate_line(const std::string& keyword) {
  if (std::exchange(has_duplicate_line_, true)) return false;
  return read_.fail(Code::kOutOfPlace, keyword_, "this rule has a " + keyword + " line already",
                    "keep one, or begin a new RULE before this line");
}

void RuleReader::broken() {
  if (!is_in_rule_) return;
  syntax::Rule& rule = into_->rules.back();
  rule.has_broken_part = true;
  if (!rule.strategies.empty()) rule.strategies.back().has_broken_adaptation = true;
}

}  // namespace culprit
