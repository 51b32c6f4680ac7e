#include "language/unknown_line.h"

#include <algorithm>
#include <array>
#include <optional>

#include "base/closest.h"
#include "language/foreign_words.h"
#include "language/functions.h"
#include "language/syntax.h"

namespace culprit {
namespace {

struct Remedy {
  std::string text;
  std::optional<Edit> fix{};
};

// A comment of another language; empty: it is none.
std::optional<Span> foreign_comment(const Token& head, const Token& second) {
  const bool adjoins = second.span.begin == head.span.end;
  const bool is_pair =
      adjoins && ((head.is("-") && second.is("-")) || (head.is("/") && second.is("*")) ||
                  (head.is("<") && second.is("!")));
  if (is_pair) return Span{head.span.begin, second.span.end};
  return std::nullopt;
}

// "---", which divides YAML into documents.
bool is_rule_off(const UnknownLine& line, const Token& head) {
  const Span whole = line.source.line(line.source.position(head.span.begin).line);
  const std::string_view text = trimmed(line.source.text(whole));
  return text.size() >= 3 && text.find_first_not_of('-') == std::string_view::npos;
}

bool is_adaptation(std::string_view word) {
  return syntax::adaptation_type(word).has_value() || !adaptation_of_other_tools(word).empty();
}

// The numbers of a rule have no words.
std::string_view place_of_number(std::string_view upper) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kNumbers = {
      {{"PROBABILITY", "it is the first number of a STRATEGY line: STRATEGY name 80 10"},
       {"CONFIDENCE", "it is the second number of a STRATEGY line: STRATEGY name 80 10"},
       {"IMPACT", "it is the last number of an ADAPTATION line: ADAPTATION camera redeploy 10"},
       {"COST", "it is the last number of an ADAPTATION line: ADAPTATION camera redeploy 10"}}};
  for (const auto& [word, place] : kNumbers) {
    if (word == upper) return place;
  }
  return "";
}

// A line with a condition alone.
Remedy remedy_of_condition(const UnknownLine& line, const Token& head) {
  if (line.has_trigger)
    return {"a rule has one TRIGGER: write && or ||, and this condition, at the end of its line"};
  return {"write TRIGGER in front of it", Edit{{head.span.begin, head.span.begin}, "TRIGGER "}};
}

// A line whose first character is no letter.
std::optional<Remedy> remedy_of_symbol(const UnknownLine& line, const Token& head,
                                       std::string_view written) {
  if (written == "[")
    return Remedy{"a rule file has no sections: a rule begins with RULE and its name"};
  if (written == "<")
    return Remedy{
        "a rule file has no tags: a rule begins with RULE and its name, and INCLUDE "
        "\"common.rules\" reads another file"};
  if (head.kind == Token::Kind::kString)
    return Remedy{"begin a comment with #", Edit{{head.span.begin, head.span.begin}, "# "}};
  if (written == "..") return Remedy{"write the lines that belong here, or remove it"};
  if (written == "`") return Remedy{"remove the line: a rule file has no code fences"};
  if (written == "!" && line.is_in_rule) return remedy_of_condition(line, head);
  constexpr std::string_view kOperators = "&& || & | < <= > >= == != + * / %";
  const bool is_operator =
      head.kind != Token::Kind::kIdentifier && kOperators.find(written) != std::string_view::npos;
  if (is_operator && line.is_in_rule)
    return Remedy{"write it at the end of the line above: a statement is one line"};
  return std::nullopt;
}

// "for c in [camera, lidar]:"
bool is_loop(std::string_view upper, const Scanner& behind) {
  if (upper == "WHILE" || upper == "FOREACH" || upper == "REPEAT" || upper == "LOOP") return true;
  Scanner ahead = behind.ahead();
  ahead.next();
  return upper == "FOR" && upper_case(ahead.peek().text) == "IN";
}

std::string list_of(std::span<const std::string_view> keywords) {
  std::string list;
  for (const std::string_view word : keywords) list += " " + std::string(word);
  return list;
}

// "limit = 0.5", "limit := 0.5", "def limit = 0.5": with the word CONST; nothing: it is no such line. `behind` the head.
std::optional<Remedy> remedy_of_assignment(const UnknownLine& line, const Token& head,
                                           const Scanner& behind) {
  Scanner ahead = behind.ahead();
  const bool has_word_in_front = ahead.peek().kind == Token::Kind::kIdentifier;
  const Token name = has_word_in_front ? ahead.next() : head;
  if (ahead.peek().is(":")) ahead.next();
  if (name.kind != Token::Kind::kIdentifier || !ahead.next().is("=")) return std::nullopt;
  const std::string constant = "CONST " + std::string(name.text) + " = ";
  const Span sign{head.span.begin, ahead.position()};
  return Remedy{"a constant begins with CONST: write " + constant +
                    std::string(line.source.text(ahead.rest())),
                Edit{sign, constant}};
}

Remedy remedy_of_word(const UnknownLine& line, const Token& head, const Scanner& s,
                      const std::string& near) {
  const std::string upper = upper_case(head.text);
  if (const auto place = place_of_number(upper); !place.empty()) return {std::string(place)};
  const Token& second = s.peek();
  const Span in_front{head.span.begin, head.span.begin};
  const bool is_call = second.is("(") && second.span.begin == head.span.end;
  if (is_call && near.empty() && find_function(head.text) != nullptr)
    return remedy_of_condition(line, head);
  const std::string_view rest = line.source.text(s.rest());
  if (is_call && near.empty() && rest.find_first_of("=\"'") != std::string_view::npos)
    return {
        "a rule file is no program: a component is COMPONENT camera NODE /camera LAUNCH \"...\""};
  if (is_call && near.empty())
    return {"to use a TEMPLATE, write USE " + std::string(head.text) + std::string(rest),
            Edit{in_front, "USE "}};
  if (is_loop(upper, s))
    return {"a rule file has no loops: write a TEMPLATE, and a USE line for each component"};
  if (upper == "WAIT" || upper == "SLEEP")
    return {"no strategy waits for a time: THEN ADAPTATION begins once the one above took effect"};
  if (upper == "AND" || upper == "OR")
    return {"write " + std::string(upper == "OR" ? "||" : "&&") +
            " and the condition at the end of the TRIGGER line"};
  if (upper == "ELSE" || upper == "OTHERWISE")
    return {"remove the line: the strategies of a rule are alternatives"};
  if (const auto remedy = remedy_of_foreign_word(upper, ""); !remedy.empty() && near.empty())
    return {std::string(remedy)};
  if (const auto statement = statement_of_clause(upper); !statement.empty() && near.empty())
    return {"write it on the line of its " + std::string(statement) + ": a statement is one line"};
  if (near == "TRIGGER" && !line.is_in_rule)
    return {"write RULE and its name, then lines with POLICIES, TRIGGER, STRATEGY and ADAPTATION"};
  if (!near.empty()) return {"did you mean " + near + "?", Edit{head.span, near}};
  if (auto remedy = remedy_of_assignment(line, head, s)) return *std::move(remedy);
  constexpr std::string_view kComparisons = "< <= > >= == !=";
  const bool is_condition = second.kind == Token::Kind::kSymbol &&
                            kComparisons.find(second.text) != std::string_view::npos;
  if (is_condition && line.is_in_rule && head.kind == Token::Kind::kIdentifier)
    return remedy_of_condition(line, head);
  if (upper == "VERSION") return {"remove the line: a rule file has no version"};
  if (is_adaptation(second.text))
    return {
        "did you mean ADAPTATION " + std::string(head.text) + " " + std::string(second.text) + "?",
        Edit{in_front, "ADAPTATION "}};
  if (is_adaptation(head.text) && second.kind == Token::Kind::kIdentifier)
    return {"did you mean ADAPTATION " + std::string(second.text) + " " + std::string(head.text) +
            "?"};
  return {"a line begins with one of" + list_of(line.keywords)};
}

// The keyword that `head` stands for; empty: none.
std::string meant_keyword(const UnknownLine& line, const Token& head) {
  const std::string upper = upper_case(head.text);
  if (std::ranges::find(line.keywords, upper) != line.keywords.end()) return upper;
  const std::string_view foreign = statement_of_other_tools(upper);
  if (!foreign.empty()) return std::string(foreign);
  const bool has_remedy = !statement_of_clause(upper).empty() || !place_of_number(upper).empty() ||
                          !remedy_of_foreign_word(upper, "").empty();
  if (has_remedy) return "";
  return closest(upper, {line.keywords.begin(), line.keywords.end()});
}

}  // namespace

std::string report_unknown_line(const UnknownLine& line, const Token& head, const Scanner& s) {
  const std::string written(line.source.text(head.span));
  const bool is_percent = head.is("%") && !line.is_in_rule;
  const auto comment =
      written == ";" || is_percent ? std::optional(head.span) : foreign_comment(head, s.peek());
  if (comment && is_rule_off(line, head)) {
    line.read.fail(Code::kUnknownStatement, *comment, "a rule file has no documents",
                   "remove the line");
    return "";
  }
  if (comment) {
    line.read.fail(Code::kUnknownStatement, *comment,
                   "no comment begins with '" + std::string(line.source.text(*comment)) + "'",
                   "begin each line of a comment with #", Edit{*comment, "#"});
    return "";
  }
  const std::string near = meant_keyword(line, head);
  if (line.is_below_unfinished && near.empty()) return "";
  const std::string cause = "no statement begins with '" + written + "'";
  if (const auto remedy = remedy_of_symbol(line, head, written)) {
    line.read.fail(Code::kUnknownStatement, head.span, cause, remedy->text, remedy->fix);
    return "";
  }
  if (head.kind == Token::Kind::kBad) {
    line.read.fail_token(head, "a statement", "");
    return "";
  }
  const Remedy remedy = remedy_of_word(line, head, s, near);
  line.read.fail(Code::kUnknownStatement, head.span, cause, remedy.text, remedy.fix);
  // A word of another tool may stand for a line that the rule has as well.
  const bool is_foreign =
      near != "RULE" && near != "END" && near == statement_of_other_tools(upper_case(head.text));
  return is_foreign ? "" : near;
}

bool is_unfinished(std::string_view line) {
  line = trimmed(line);
  constexpr std::array<std::string_view, 12> kEnds = {"&&", "||", "<", ">", "=",  "+",
                                                      "-",  "*",  "(", ",", "\\", "&"};
  return std::ranges::any_of(kEnds, [&](std::string_view end) { return line.ends_with(end); });
}

}  // namespace culprit
