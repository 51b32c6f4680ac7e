#include "rule_json/to_json.h"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "language/parser.h"
#include "language/scanner.h"
#include "rule_json/forms.h"

namespace culprit::rule_json {
namespace {

// Takes the lexemes of one statement, which parses, part by part.
class StatementReader {
 public:
  StatementReader(const Source& source, std::span<const Lexeme> lexemes)
      : source_(source), lexemes_(lexemes) {}

  Json read() {
    if (text(0) == kStep.word) {
      lexemes_ = lexemes_.subspan(1);
      Json statement = read();
      statement[std::string(kStep.member)] = true;
      return statement;
    }
    for (const Form& form : forms()) {
      if (fits(form)) return read(form);
    }
    return {};  // a statement that forms.cpp lacks; the tests would have met it
  }

 private:
  std::string_view text(std::size_t i) const { return source_.text(lexemes_[i].span); }
  std::string_view take() { return text(next_++); }

  bool fits(const Form& form) const {
    if (text(0) != form.keyword) return false;
    if (!form.types.empty()) {
      // If two forms have one type, one has more parts.
      const bool is_fixed = std::none_of(form.fixed.begin(), form.fixed.end(), [](const Clause& c) {
        return c.part == Part::kExpression;
      });
      return (!is_fixed || lexemes_.size() == form.fixed.size() + 1) &&
             std::find(form.types.begin(), form.types.end(), text(2)) != form.types.end();
    }
    // The forms of one keyword each have a word of their own after the first part.
    return form.fixed.size() < 2 || form.fixed[1].word.empty() || text(2) == form.fixed[1].word;
  }

  Json read(const Form& form) {
    Json statement{{"statement", form.keyword}};
    next_ = 1;
    for (std::size_t i = 0; i < form.fixed.size(); ++i) {
      const Clause& clause = form.fixed[i];
      if (!clause.word.empty()) take();
      // All parts after an expression are single lexemes.
      const std::size_t behind = form.fixed.size() - i - 1;
      statement[std::string(clause.member)] = part(clause.part, lexemes_.size() - behind);
    }
    while (next_ < lexemes_.size()) {
      const std::string_view word = take();
      const auto clause = std::find_if(form.free.begin(), form.free.end(),
                                       [&](const Clause& c) { return c.word == word; });
      statement[std::string(clause->member)] = part(clause->part, lexemes_.size());
    }
    return statement;
  }

  // An expression reaches up to the lexeme `end`.
  Json part(Part part, std::size_t end) {
    switch (part) {
      case Part::kWord:
      case Part::kType:
      case Part::kDuration:
        return take();
      case Part::kName:
        return name_to_json(take());
      case Part::kNames: {
        Json names = Json::array();
        while (next_ < lexemes_.size()) names.push_back(name_to_json(take()));
        return names;
      }
      case Part::kNodes: {
        Json nodes = Json::array();
        do {
          nodes.push_back(name_to_json(take()));
        } while (next_ < lexemes_.size() && lexemes_[next_].kind == Lexeme::Kind::kName);
        return nodes.size() == 1 ? nodes[0] : nodes;
      }
      case Part::kNamePair: {
        Json first = name_to_json(take());
        return Json::array({std::move(first), name_to_json(take())});
      }
      case Part::kText:
        return text_to_json(take());
      case Part::kNumber:
        return number_to_json(std::string(take()));
      case Part::kExpression: {
        const Span span{lexemes_[next_].span.begin, lexemes_[end - 1].span.end};
        next_ = end;
        return source_.text(span);
      }
      case Part::kHold:
      case Part::kRange: {
        Json first = signed_number();
        take();  // the / or the ..
        return Json::array({std::move(first), signed_number()});
      }
      case Part::kParameters:
        return parameters();
      case Part::kArguments: {
        Json arguments = Json::array();
        for_each_in_parentheses([&] { arguments.push_back(name_to_json(take())); });
        return arguments;
      }
      case Part::kBraced: {
        Json members = Json::array();
        while (text(next_) != "}") {
          take();  // the brace, or a comma
          members.push_back(take());
        }
        take();
        return members;
      }
      case Part::kFlag:
        return true;
    }
    return {};
  }

  // Does nothing if there are no parentheses.
  template <class TakeOne>
  void for_each_in_parentheses(TakeOne take_one) {
    if (next_ == lexemes_.size() || lexemes_[next_].kind != Lexeme::Kind::kSymbol) return;
    take();
    while (text(next_) != ")" || lexemes_[next_].kind != Lexeme::Kind::kSymbol) {
      take_one();
      if (text(next_) == ",") take();
    }
    take();
  }

  Json parameters() {
    Json all = Json::array();
    for_each_in_parentheses([&] {
      Json name = take();
      if (text(next_) != "=") return all.push_back(std::move(name));
      take();
      all.push_back({{"name", std::move(name)}, {"usual", name_to_json(take())}});
    });
    return all;
  }

  Json signed_number() {
    std::string text(take());
    if (text == "-") text += take();
    return number_to_json(text);
  }

  const Source& source_;
  std::span<const Lexeme> lexemes_;
  std::size_t next_ = 0;
};

Json statements(const Source& source, const std::vector<Lexeme>& lexemes) {
  Json all = Json::array();
  Json above = Json::array();
  auto next = lexemes.begin();
  for (std::uint32_t number = 1; number <= source.line_count(); ++number) {
    const Span line = source.line(number);
    const auto first = next;
    while (next != lexemes.end() && next->span.begin < line.end) ++next;
    const std::uint32_t code_end = next == first ? line.begin : std::prev(next)->span.end;
    const std::string_view comment = trimmed(source.text({code_end, line.end}));
    if (next == first) {
      above.push_back(comment);
      continue;
    }
    Json statement = StatementReader(source, {first, next}).read();
    if (!comment.empty()) statement["comment"] = comment;
    if (!above.empty()) statement["above"] = std::exchange(above, Json::array());
    all.push_back(std::move(statement));
  }
  // The text behind the last line's end is no line of its own.
  if (!above.empty() && above.back() == "") above.erase(above.size() - 1);
  Json document{{"version", kVersion}, {"statements", std::move(all)}};
  if (!above.empty()) document["end"] = std::move(above);
  return document;
}

// 0 if all lines are UTF-8.
std::uint32_t first_line_that_is_not_utf8(const Source& source) {
  for (std::uint32_t number = 1; number <= source.line_count(); ++number) {
    const std::string text(source.text(source.line(number)));
    try {
      static_cast<void>(Json(text).dump());
    } catch (const Json::type_error&) {
      return number;
    }
  }
  return 0;
}

}  // namespace

Expected<Json> to_json(const Source& source, Colour colour) {
  std::vector<Diagnostic> diagnostics;
  std::vector<Lexeme> lexemes;
  parse(source, diagnostics, &lexemes);
  if (!diagnostics.empty()) {
    return Error{render(diagnostics, source, colour)};
  }
  if (const std::uint32_t line = first_line_that_is_not_utf8(source); line != 0) {
    return Error{
        source.name() + ":" + std::to_string(line) +
        ": this line is not UTF-8, and JSON can hold nothing else: save the file as UTF-8\n"};
  }
  return statements(source, lexemes);
}

std::string to_text(const Json& document) { return to_indented(document) + "\n"; }

}  // namespace culprit::rule_json
