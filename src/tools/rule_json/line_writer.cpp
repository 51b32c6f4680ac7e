#include "rule_json/line_writer.h"

#include <algorithm>
#include <cstdint>
#include <optional>

#include "base/joined.h"
#include "language/diagnostic.h"
#include "language/expression_parser.h"
#include "language/syntax.h"

namespace culprit::rule_json {
namespace {

const char* describe(Part part) {
  switch (part) {
    case Part::kWord:
    case Part::kType:
      return "a text of letters, digits and '_' that begins with no digit";
    case Part::kName:
      return "a name: a text that is not empty";
    case Part::kNames:
      return "names: an array of texts that are not empty";
    case Part::kNodes:
      return "a name, or an array of names";
    case Part::kNamePair:
      return "two names: an array of two texts that are not empty";
    case Part::kText:
      return "a text";
    case Part::kNumber:
      return "a number that is not negative";
    case Part::kDuration:
      return "a duration: a text such as \"500ms\" or \"2s\"";
    case Part::kExpression:
      return "a text with one expression";
    case Part::kHold:
      return "two whole numbers: [3, 5] for 3 of the last 5";
    case Part::kRange:
      return "two numbers: [low, high]";
    case Part::kParameters:
      return "an array of names, or of objects with a \"name\" and its \"usual\" value";
    case Part::kArguments:
      return "an array of names, numbers as texts, and quoted texts";
    case Part::kBraced:
      return "an array of the names of components";
    case Part::kFlag:
      return "true or false";
  }
  return "";
}

// Among the clauses that may be left out: the publisher belongs to its source, and an expression
// reaches to the end of the line.
enum class Place : std::uint8_t { kFirst, kAnywhere, kLast };
Place place_of(const Clause& clause) {
  if (clause.part == Part::kExpression) return Place::kLast;
  return clause.word == "FROM" ? Place::kFirst : Place::kAnywhere;
}

using Words = std::optional<std::string>;  // of a line; nothing: the value is no such part

Words number_words(const Json& value) {
  std::string text = value.is_number() ? to_line(value) : "";
  if (value.is_string()) text = value.get<std::string>();
  return is_number(text) ? Words(text) : std::nullopt;
}

Words signed_words(const Json& value) {
  std::string text = value.is_number() ? to_line(value) : "";
  if (value.is_string()) text = value.get<std::string>();
  return is_number(text.starts_with('-') ? text.substr(1) : text) ? Words(text) : std::nullopt;
}

Words pair_words(const Json& value, Words (*part)(const Json&), const char* between) {
  if (!value.is_array() || value.size() != 2) return std::nullopt;
  const Words first = part(value[0]);
  const Words second = part(value[1]);
  return first && second ? Words(*first + between + *second) : std::nullopt;
}

Words name_words(const Json& value) {
  if (!value.is_string() || value == "") return std::nullopt;
  const auto& text = value.get_ref<const std::string&>();
  if (!text.starts_with('"')) return spelled(text);
  return is_name(text) ? Words(text) : std::nullopt;
}

Words names_words(const Json& value) {
  if (!value.is_array() || value.empty()) return std::nullopt;
  std::string all;
  for (const Json& name : value) {
    const Words words = name_words(name);
    if (!words) return std::nullopt;
    all += (all.empty() ? "" : " ") + *words;
  }
  return all;
}

// "(a, b)"; nothing in between is no parentheses either.
Words list_words(const Json& value, Words (*part)(const Json&)) {
  if (!value.is_array()) return std::nullopt;
  std::string all;
  for (const Json& each : value) {
    const Words words = part(each);
    if (!words) return std::nullopt;
    all += (all.empty() ? "(" : ", ") + *words;
  }
  return all.empty() ? all : all + ")";
}

Words text_words(const Json& value) {
  if (!value.is_string()) return std::nullopt;
  const auto& text = value.get_ref<const std::string&>();
  if (!text.starts_with('"')) return in_quotes(text);
  return is_text(text) ? Words(text) : std::nullopt;
}

Words string_words(const Json& value, bool (*is_good)(std::string_view)) {
  if (!value.is_string()) return std::nullopt;
  const auto& text = value.get_ref<const std::string&>();
  return is_good(text) ? Words(text) : std::nullopt;
}

Words parameter_words(const Json& value) {
  if (!value.is_object()) return string_words(value, is_word);
  if (value.size() != 2 || !value.contains("name") || !value.contains("usual")) return std::nullopt;
  const Words name = string_words(value["name"], is_word);
  const Words usual = name_words(value["usual"]);
  return name && usual ? Words(*name + " = " + *usual) : std::nullopt;
}

// "{ a, b }"
Words braced_words(const Json& value) {
  if (!value.is_array() || value.empty()) return std::nullopt;
  std::string all;
  for (const Json& each : value) {
    const Words words = string_words(each, is_word);
    if (!words) return std::nullopt;
    all += (all.empty() ? "{ " : ", ") + *words;
  }
  return all + " }";
}

Words words(Part part, const Json& value) {
  switch (part) {
    case Part::kWord:
    case Part::kType:
      return string_words(value, is_word);
    case Part::kName:
      return name_words(value);
    case Part::kNames:
      return names_words(value);
    case Part::kNodes:
      return value.is_array() ? names_words(value) : name_words(value);
    case Part::kNamePair:
      return pair_words(value, name_words, " ");
    case Part::kText:
      return text_words(value);
    case Part::kNumber:
      return number_words(value);
    case Part::kDuration:
      return string_words(value, is_duration);
    case Part::kExpression:
      return value.is_string() ? Words(value.get<std::string>()) : std::nullopt;
    case Part::kHold:
      return pair_words(value, number_words, "/");
    case Part::kRange:
      return pair_words(value, signed_words, " .. ");  // apart, for "0." and ".5"
    case Part::kParameters:
      return list_words(value, parameter_words);
    case Part::kArguments:
      return list_words(value, name_words);
    case Part::kBraced:
      return braced_words(value);
    case Part::kFlag:
      return value == true ? Words("") : std::nullopt;
  }
  return std::nullopt;
}

// Why `text` is not one expression, whole, and nothing else; nothing if it is.
std::optional<Diagnostic> mistake_in(const std::string& text) {
  if (text.find('\n') != std::string::npos)
    return Diagnostic{Code::kSyntax, Severity::kError, {}, "an expression is one line", ""};
  std::vector<Diagnostic> diagnostics;
  const auto end = static_cast<std::uint32_t>(text.size());
  Scanner scanner(text, {0, end}, nullptr, Holes::kAllowed);
  const auto expression = parse_expression(scanner, diagnostics);
  if (!expression) return diagnostics.front();
  if (expression->span.end == end) return std::nullopt;
  return Diagnostic{Code::kExtraText,
                    Severity::kError,
                    {},
                    "the expression ends before '" + text.substr(expression->span.end) + "'",
                    "give nothing but the expression; comments have a member of their own"};
}

}  // namespace

std::string pointer(const std::string& at, std::string_view name) {
  std::string out = at + "/";
  for (const char c : name) {
    if (c == '~') {
      out += "~0";
    } else if (c == '/') {
      out += "~1";
    } else {
      out += c;
    }
  }
  return out;
}

std::string nearest(std::string_view word, const std::vector<std::string_view>& known) {
  const std::string near = closest(word, known);
  if (!near.empty()) return "did you mean '" + near + "'?";
  return "known: " + joined(known);
}

bool is_comment(const Json& value) {
  if (!value.is_string()) return false;
  const auto& text = value.get_ref<const std::string&>();
  return (text.starts_with('#') || text.starts_with("//")) && text.find('\n') == std::string::npos;
}

std::string LineWriter::write() {
  const Form* form = choose_form();
  if (form == nullptr) {
    complain_of_kind();
    return "";
  }
  refuse_other_members(*form);
  line_ = step_word(*form) + std::string(form->keyword);
  for (const Clause& clause : form->fixed) {
    if (statement_.contains(clause.member)) {
      add(clause);
    } else {
      complain_(std::string(clause.member), "this member is missing",
                std::string("it is ") + describe(clause.part));
    }
  }
  // An expression goes on to the end of its line.
  for (const Place place : {Place::kFirst, Place::kAnywhere, Place::kLast}) {
    for (const auto& [member, value] : statement_.items()) {
      const bool is_off = value == false;
      for (const Clause& clause : form->free) {
        const bool is_wanted = clause.member == member && place_of(clause) == place;
        if (is_wanted && !(is_off && clause.part == Part::kFlag)) add(clause);
      }
    }
  }
  if (!statement_.contains("comment")) return line_;
  const Json& comment = statement_["comment"];
  if (is_comment(comment)) return line_ + "  " + comment.get<std::string>();
  complain_("comment", "this is no comment", "it is a text that begins with # or //");
  return line_;
}

// Among the forms of the statement's keyword, the one with most members present.
const Form* LineWriter::choose_form() const {
  const auto keyword = statement_.find("statement");
  const Form* best = nullptr;
  std::size_t best_count = 0;
  for (const Form& form : forms()) {
    if (keyword == statement_.end() || *keyword != form.keyword || !has_type_of(form)) continue;
    const auto count = static_cast<std::size_t>(
        std::count_if(form.fixed.begin(), form.fixed.end(),
                      [&](const Clause& clause) { return statement_.contains(clause.member); }));
    if (best != nullptr && count <= best_count) continue;
    best = &form;
    best_count = count;
  }
  return best;
}

bool LineWriter::has_type_of(const Form& form) const {
  if (form.types.empty()) return true;
  const auto type = statement_.find("type");
  return type != statement_.end() &&
         std::any_of(form.types.begin(), form.types.end(),
                     [&](std::string_view known) { return *type == known; });
}

// "THEN " if the statement begins a step; empty if not.
std::string LineWriter::step_word(const Form& form) const {
  const auto step = statement_.find(kStep.member);
  if (form.keyword != kStepKeyword || step == statement_.end() || *step == false) return "";
  if (*step == true) return std::string(kStep.word) + " ";
  complain_(std::string(kStep.member), std::string("this must be ") + describe(kStep.part), "");
  return "";
}

void LineWriter::complain_of_kind() const {
  const auto text_of = [&](const char* member) {
    const auto value = statement_.find(member);
    return value != statement_.end() && value->is_string() ? value->get<std::string>() : "";
  };
  const std::string keyword = text_of("statement");
  std::vector<std::string_view> keywords;
  for (const Form& form : forms()) {
    if (keywords.empty() || keywords.back() != form.keyword) keywords.push_back(form.keyword);
  }
  if (std::find(keywords.begin(), keywords.end(), keyword) == keywords.end()) {
    complain_("statement", "there is no statement '" + keyword + "'", nearest(keyword, keywords));
    return;
  }
  const std::string type = text_of("type");
  complain_("type", "there is no adaptation '" + type + "'",
            nearest(type, syntax::adaptation_keywords()));
}

void LineWriter::refuse_other_members(const Form& form) const {
  std::vector<std::string_view> known = {"statement", "above", "comment"};
  for (const Clause& clause : form.fixed) known.push_back(clause.member);
  for (const Clause& clause : form.free) known.push_back(clause.member);
  if (form.keyword == kStepKeyword) known.push_back(kStep.member);
  for (const auto& [member, value] : statement_.items()) {
    if (std::find(known.begin(), known.end(), member) == known.end())
      complain_(member, "this statement has no such member", nearest(member, known));
  }
}

void LineWriter::add(const Clause& clause) {
  const std::string member(clause.member);
  const Json& value = statement_[member];
  const Words written = words(clause.part, value);
  if (!written) return complain_(member, std::string("this must be ") + describe(clause.part), "");
  if (clause.part == Part::kExpression) {
    if (const auto mistake = mistake_in(*written))
      return complain_(member, mistake->cause, mistake->remedy);
  }
  for (const std::string_view piece : {clause.word, std::string_view(*written)}) {
    if (!piece.empty()) line_.append(" ").append(piece);
  }
}

}  // namespace culprit::rule_json
