#include "rule_test/expectation_reader.h"

#include <algorithm>
#include <array>

#include "knowledge/describe.h"

namespace culprit::rule_test {
namespace {

using syntax::Name;
using Kind = Expectation::Kind;

enum class About : std::uint8_t { kRule, kStrategy, kComponent };

struct Verb {
  std::string_view word;
  Kind kind;
  About about;
};
constexpr std::array kVerbs = {
    Verb{"DETECTED", Kind::kDetected, About::kRule},
    Verb{"RESOLVED", Kind::kResolved, About::kRule},
    Verb{"EXHAUSTED", Kind::kExhausted, About::kRule},
    Verb{"LOST", Kind::kLost, About::kRule},
    Verb{"BLIND", Kind::kBlind, About::kRule},
    Verb{"CHOSEN", Kind::kChosen, About::kStrategy},
    Verb{"EXECUTED", Kind::kExecuted, About::kStrategy},
    Verb{"FAILED", Kind::kFailed, About::kStrategy},
    Verb{"EXCLUDED", Kind::kExcluded, About::kStrategy},
    Verb{"RANKED", Kind::kRanked, About::kStrategy},
    Verb{"BLAMED", Kind::kBlamed, About::kComponent},
};

constexpr std::array kConditions = {
    Condition::kTried,      Condition::kInvalid,  Condition::kAdapting,   Condition::kAffected,
    Condition::kDependency, Condition::kOneEach,  Condition::kDownstream, Condition::kSuspect,
    Condition::kSettling,   Condition::kInTheWay, Condition::kWithheld};

class ExpectationReader {
 public:
  ExpectationReader(Scanner& s, LineReader& read, Names& names)
      : s_(s), read_(read), names_(names) {}

  std::optional<Expectation> read() {
    const bool is_read = took("NO") ? no_strategy() : sentence();
    if (!is_read || !clauses()) return std::nullopt;
    return e_;
  }

 private:
  bool took(std::string_view word) {
    if (s_.peek().text != word || s_.peek().kind != Token::Kind::kIdentifier) return false;
    s_.next();
    return true;
  }

  // "NO STRATEGY"; OF and FOR are clauses.
  bool no_strategy() {
    e_.kind = Kind::kAnyChosen;
    e_.wanted = false;
    const Token& next = s_.peek();
    const std::string name(next.text);
    if (fits(name, About::kRule))
      return read_.fail(Code::kSyntax, next.span, "NO stands only in front of STRATEGY",
                        "write EXPECT NOT " + name + " DETECTED");
    if (fits(name, About::kComponent))
      return read_.fail(Code::kSyntax, next.span, "NO stands only in front of STRATEGY",
                        "write EXPECT NO STRATEGY OF " + name);
    return read_.expect_word(s_, "STRATEGY");
  }

  bool sentence() {
    e_.wanted = !took("NOT");
    if (const Token& next = s_.peek(); !e_.wanted && next.text == "STRATEGY")
      return read_.fail(Code::kSyntax, next.span, "unexpected NOT before STRATEGY",
                        "write EXPECT NO STRATEGY");
    if (took("BLAME")) {
      e_.kind = Kind::kBlamed;
      return names_clause(About::kComponent, "a component");
    }
    if (is_out_of_order()) return false;
    const auto subject = read_.name_or_text(s_, "a rule, a strategy or a component");
    if (!subject) return false;
    // "NOT RGBDead": it is never detected.
    if (!e_.wanted && fits(subject->text, About::kRule) && (s_.at_end() || is_time(s_.peek().text)))
      return resolve(*subject, About::kRule);
    const Token word = s_.next();
    for (const Verb& verb : kVerbs) {
      if (word.text == verb.word) {
        e_.kind = verb.kind;
        if (!fits(subject->text, verb.about) && knows(subject->text))
          return wrong_verb(*subject, word);
        return resolve(*subject, verb.about) && (e_.kind != Kind::kRanked || rank());
      }
    }
    if (std::ranges::find(kVerbs, std::string_view(subject->text), &Verb::word) != kVerbs.end() &&
        knows(std::string(word.text)))
      return read_.fail(Code::kSyntax, subject->span,
                        subject->text + " comes after the name that it is about",
                        "write " + std::string(word.text) + " " + subject->text);
    if (std::ranges::find(kVerbs, std::string_view(subject->text), &Verb::word) != kVerbs.end())
      return read_.fail(Code::kSyntax, subject->span,
                        "a name is missing in front of " + subject->text,
                        "write what it is about, as in CameraDead DETECTED");
    if (!knows(subject->text)) {
      const std::string near = names_.closest_subject(subject->text);
      return read_.fail(Code::kUnknownName, subject->span,
                        "the rules have no rule, strategy or component '" + subject->text + "'",
                        near.empty() ? "" : "did you mean " + near + "?");
    }
    if (upper_case(word.text) == "NOT" && e_.wanted)
      return read_.fail(Code::kSyntax, word.span, "NOT stands behind EXPECT",
                        "write EXPECT NOT " + subject->text + " " + std::string(s_.peek().text));
    const auto fitting = verbs_of(subject->text);
    if (is_foreign_verb(*subject, word)) return false;
    return read_.unexpected_clause(
        word, fitting,
        word.kind == Token::Kind::kEnd ? "add for example " + std::string(fitting.front())
        : fits(subject->text, About::kComponent)
            ? "of a component only blame is expected; a repair is RESOLVED of a rule, or EXECUTED "
              "of a strategy"
            : "");
  }

  // "CameraDead BLAMES camera", "CameraDead NEVER DETECTED", "again WAS EXECUTED": reported.
  bool is_foreign_verb(const Name& subject, const Token& word) {
    Scanner ahead = s_.ahead();
    const Name next = ahead.next_name();
    const std::string upper = upper_case(word.text);
    if (const Span span{subject.span.begin, next.span.end};
        upper.starts_with("BLAME") && fits(next.text, About::kComponent))
      return !read_.fail(Code::kSyntax, span, "the component stands in front of BLAMED",
                         "write " + next.text + " BLAMED FOR " + subject.text,
                         Edit{span, next.text + " BLAMED FOR " + subject.text});
    if (upper == "NEVER")
      return !read_.fail(Code::kSyntax, word.span, "unexpected 'NEVER'",
                         "write EXPECT NOT " + subject.text + " " + next.text);
    const bool is_filler = upper == "WAS" || upper == "IS" || upper == "BE" || word.is("==");
    return is_filler &&
           !read_.fail(Code::kSyntax, word.span, "unexpected '" + std::string(word.text) + "'",
                       "remove it: write EXPECT " + subject.text + " " + next.text,
                       Edit{{word.span.begin, next.span.begin}, ""});
  }

  // "NOT NO STRATEGY", "BY 5s CameraDead DETECTED": reported.
  bool is_out_of_order() {
    const Token& first = s_.peek();
    if (knows(std::string(first.text))) return false;
    if (first.text == "NO")
      return !read_.fail(Code::kSyntax, first.span, "NOT and NO stand for the same",
                         "write NO STRATEGY without NOT, or name the strategy that is CHOSEN");
    const bool is_time_first = first.text == "BY" || first.text == "AFTER";
    return is_time_first &&
           !read_.fail(Code::kSyntax, first.span, "a time stands behind what is expected",
                       "write it at the end, as in EXPECT Rule DETECTED " +
                           std::string(first.text) + " 5s");
  }

  std::vector<std::string_view> verbs_of(const std::string& name) const {
    std::vector<std::string_view> fitting;
    for (const Verb& verb : kVerbs) {
      if (fits(name, verb.about)) fitting.push_back(verb.word);
    }
    return fitting;
  }

  std::string_view kind_of(const std::string& name) const {
    return fits(name, About::kRule)       ? "a rule"
           : fits(name, About::kStrategy) ? "a strategy"
                                          : "a component";
  }

  // "camera DETECTED", "CameraDead BLAMED FOR camera"
  bool wrong_verb(const Name& subject, const Token& verb) {
    std::string list;
    for (const std::string_view word : verbs_of(subject.text))
      list += (list.empty() ? "" : ", ") + std::string(word);
    const std::string cause = "'" + subject.text + "' is " + std::string(kind_of(subject.text)) +
                              ", which is never " + std::string(verb.text);
    Scanner ahead = s_.ahead();
    const bool has_other = ahead.next().text == "FOR";
    const Name other = has_other ? ahead.next_name() : Name{};
    if (e_.kind == Kind::kBlamed && names_.is_component(other.text))
      return read_.fail(Code::kUnknownName, subject.span, cause,
                        "write " + other.text + " BLAMED FOR " + subject.text);
    return read_.fail(Code::kUnknownName, subject.span, cause, "it may be " + list);
  }

  static bool is_time(std::string_view word) { return word == "BY" || word == "AFTER"; }

  bool knows(const std::string& name) const {
    return fits(name, About::kRule) || fits(name, About::kStrategy) ||
           fits(name, About::kComponent);
  }
  bool fits(const std::string& name, About about) const {
    switch (about) {
      case About::kRule:
        return names_.is_rule(name);
      case About::kStrategy:
        return names_.is_strategy(name);
      case About::kComponent:
        return names_.is_component(name);
    }
    return false;
  }

  bool resolve(const Name& name, About about) {
    switch (about) {
      case About::kRule:
        e_.rule = names_.rule(name);
        return e_.rule.has_value();
      case About::kStrategy:
        e_.strategy = names_.strategy(name);
        return e_.strategy.has_value();
      case About::kComponent:
        e_.component = names_.component(name);
        return e_.component.has_value();
    }
    return false;
  }

  bool rank() {
    const Span span = s_.peek().span;
    const auto rank = read_.whole_number(s_, "its place by cost, 1 for the cheapest");
    if (!rank) return false;
    if (*rank < 1)
      return read_.fail(Code::kPolicyRange, span, "places by cost count from 1, the cheapest", "");
    e_.rank = static_cast<std::size_t>(*rank);
    return true;
  }

  bool clauses() {
    if (e_.kind == Kind::kRanked) return true;
    while (!s_.at_end()) {
      if (!clause()) return false;
    }
    const Duration by = e_.by.value_or(Duration::max());
    return by >= e_.after || read_.fail(Code::kEmptyRange, by_span_, "BY is before AFTER",
                                        "write the later time behind BY");
  }

  bool clause() {
    const Token word = s_.next();
    std::vector<std::string_view> known;
    const auto is = [&](std::string_view clause, bool makes_sense, bool is_free) {
      if (!makes_sense) return false;
      known.push_back(clause);
      return word.text == clause && is_free;
    };
    const bool has_rule = e_.kind == Kind::kBlamed || e_.kind == Kind::kAnyChosen;
    if (is("BY", true, !e_.by)) {
      by_span_ = s_.peek().span;
      if (const std::string name(s_.peek().text); names_.is_strategy(name))
        return read_.fail(Code::kSyntax, by_span_, "'" + name + "' is a strategy, and no time",
                          "write WITH in front of a strategy, and BY in front of a time");
      e_.by = read_.duration(s_, "a time");
      return e_.by.has_value();
    }
    if (is("AFTER", true, e_.after == Duration::zero())) {
      const auto after = read_.positive_duration(s_, "a time");
      e_.after = after.value_or(Duration::zero());
      return after.has_value();
    }
    if (is("FOR", has_rule, !e_.rule)) return names_clause(About::kRule, "a rule");
    if (is("OF", e_.kind == Kind::kAnyChosen, !e_.component))
      return names_clause(About::kComponent, "a component");
    if (is("WITH", e_.kind == Kind::kResolved, !e_.strategy)) return resolving_strategy();
    if (is("BECAUSE", e_.kind == Kind::kExcluded, !e_.condition)) return because();
    const std::string_view missing = clause_of(word);
    if (!missing.empty() && std::ranges::find(known, missing) != known.end())
      return read_.fail(Code::kSyntax, word.span,
                        "'" + std::string(missing) + "' is missing before this",
                        "write " + std::string(missing) + " in front of it",
                        Edit{{word.span.begin, word.span.begin}, std::string(missing) + " "});
    const std::string upper = upper_case(word.text);
    if (upper == "BETWEEN")
      return read_.fail(Code::kSyntax, word.span, "unexpected '" + std::string(word.text) + "'",
                        "write the two times as AFTER 1s BY 5s");
    if (upper == "EVENTUALLY" || upper == "ALWAYS")
      return read_.fail(Code::kSyntax, word.span, "unexpected '" + std::string(word.text) + "'",
                        "remove it: without BY and AFTER, any time of the test counts");
    if (upper == "ONCE" || upper == "TWICE" || word.kind == Token::Kind::kNumber)
      return read_.fail(Code::kSyntax, word.span, "no test counts how often",
                        "write an EXPECT line for each time, with AFTER and BY");
    if (upper == "AND")
      return read_.fail(Code::kSyntax, word.span, "one line expects one thing",
                        "write an EXPECT line for each");
    return read_.unexpected_clause(word, known);
  }

  // The clause that names what `word` names; empty: none does.
  std::string_view clause_of(const Token& word) const {
    const std::string name(word.text);
    return word.kind == Token::Kind::kDuration ? "BY"
           : fits(name, About::kRule)          ? "FOR"
           : fits(name, About::kStrategy)      ? "WITH"
           : fits(name, About::kComponent)     ? "OF"
                                               : "";
  }

  // Only a strategy of the rule can resolve it.
  bool resolving_strategy() {
    const auto name = read_.name_or_text(s_, "a strategy");
    if (!name) return false;
    const std::string own = names_.label(*e_.rule) + "." + name->text;
    const bool is_own = names_.is_strategy(own);
    if (!resolve(is_own ? Name{own, name->span} : *name, About::kStrategy)) return false;
    const std::string owner = names_.rule_of(*e_.strategy);
    return owner == names_.label(*e_.rule) ||
           read_.fail(Code::kUnknownName, name->span,
                      "'" + name->text + "' is a strategy of " + owner + ", so it cannot resolve " +
                          names_.label(*e_.rule),
                      "name a strategy of " + names_.label(*e_.rule));
  }

  bool names_clause(About about, std::string_view what) {
    const auto name = read_.name_or_text(s_, what);
    return name && resolve(*name, about);
  }

  // "BECAUSE dependency ON camera"
  bool because() {
    const Token word = s_.next();
    std::vector<std::string_view> known;
    for (const Condition condition : kConditions) {
      known.push_back(to_string(condition));
      if (word.text == to_string(condition)) e_.condition = condition;
    }
    if (!e_.condition) return read_.unexpected_clause(word, known);
    return !took("ON") || names_clause(About::kComponent, "a component");
  }

  Scanner& s_;
  LineReader& read_;
  Names& names_;
  Expectation e_;
  Span by_span_;
};

}  // namespace

std::optional<Expectation> read_expectation(Scanner& scanner, LineReader& read, Names& names) {
  return ExpectationReader(scanner, read, names).read();
}

}  // namespace culprit::rule_test
