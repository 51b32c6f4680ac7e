#include "import/file_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "language/diagnostic.h"
#include "language/scanner.h"

namespace culprit::foreign {
namespace {

template <class Number>
bool parse_number(std::string_view text, Number& number) {
  if (text.size() > 1 && text.front() == '+') text.remove_prefix(1);
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && rest == end;
}

}  // namespace

std::vector<Word> split_words(const Source& source, Span line) {
  const std::string_view text = source.text();
  std::vector<Word> words;
  std::uint32_t at = line.begin;
  while (at < line.end) {
    if (is_blank(text[at])) {
      ++at;
      continue;
    }
    const std::uint32_t begin = at;
    while (at < line.end && !is_blank(text[at])) ++at;
    words.push_back({std::string(text.substr(begin, at - begin)), {begin, at}});
  }
  return words;
}

Expected<File> FileReader::read(const Statement& statement) {
  for (line_ = 1; line_ <= source_.line_count(); ++line_) {
    const Span text = without_comment(source_.line(line_));
    const std::vector<Word> words = split_words(source_, text);
    if (!words.empty() && !line(words, statement)) return Error{error_};
    // Behind a marker, or alone in its line.
    if (!comment_behind_.empty()) comments_.push_back(std::move(comment_behind_));
    comment_behind_.clear();
  }
  if (section_ != Section::kEnd) {
    const auto end = static_cast<std::uint32_t>(source_.text().size());
    const char* missing = section_ == Section::kConstants ? "END CONSTS"
                          : section_ == Section::kRules   ? "END RULES"
                                                          : "BEGIN RULES";
    fail({end, end}, std::string("the file ends before ") + missing,
         "is it complete? a rule file is BEGIN CONSTS ... END CONSTS BEGIN RULES ... END RULES");
    return Error{error_};
  }
  file_.comments_at_end = std::move(comments_);
  return std::move(file_);
}

bool FileReader::line(const std::vector<Word>& words, const Statement& statement) {
  const std::string& head = words.front().text;
  if (head == "BEGIN" || head == "END") return marker(words);
  if (section_ == Section::kConstants) return constant(words);
  if (section_ == Section::kRules) {
    if (std::find(keywords_.begin(), keywords_.end(), head) != keywords_.end())
      return statement(words);
    const std::string near = closest(head, keywords_);
    if (near.empty() && is_separator()) {
      comments_.push_back(comment_text({words.front().span.begin, words.back().span.end}));
      return true;
    }
    return fail(words.front().span, "no line of a rule begins with '" + head + "'",
                near.empty() ? "a comment begins with #" : "did you mean " + near + "?");
  }
  return fail(words.front().span, "this stands outside of CONSTS and RULES",
              "put it between BEGIN and END, or begin a comment with #");
}

bool FileReader::marker(const std::vector<Word>& words) {
  const std::string what =
      words[0].text + " " + (words.size() == 2 ? words[1].text : std::string("?"));
  const Section before = section_;
  if (what == "BEGIN CONSTS" && before == Section::kStart) section_ = Section::kConstants;
  if (what == "END CONSTS" && before == Section::kConstants) section_ = Section::kBetween;
  if (what == "BEGIN RULES" && (before == Section::kStart || before == Section::kBetween))
    section_ = Section::kRules;
  if (what == "END RULES" && before == Section::kRules) section_ = Section::kEnd;
  return section_ != before ||
         fail({words.front().span.begin, words.back().span.end}, "this marker is out of place",
              "the order is BEGIN CONSTS, END CONSTS, BEGIN RULES, END RULES, each once");
}

bool FileReader::constant(const std::vector<Word>& words) {
  const auto is_type = [](const std::string& word) {
    return word == "bool" || word == "string" || word == "int" || word == "double";
  };
  if (words.size() == 2 && is_type(words[0].text)) {
    file_.without_value.push_back({remarks(), words[0].text, words[1].text, {}, ""});
    return true;
  }
  if (words.size() != 3) {
    return fail({words.front().span.begin, words.back().span.end},
                "a constant is three words: type, name and value",
                "write for example: double entropy_limit 0.06");
  }
  Constant constant{remarks(), words[0].text, words[1].text, {}, words[2].text};
  auto value = constant_value(words[0], words[2], constant.remarks.notes);
  if (!value) return false;
  constant.value = std::move(*value);
  file_.constants.push_back(std::move(constant));
  return true;
}

std::optional<syntax::Literal> FileReader::constant_value(const Word& type, const Word& value,
                                                          std::vector<std::string>& notes) {
  if (type.text == "string") return value.text;
  if (type.text == "bool") {
    if (value.text == "true" || value.text == "false") return value.text == "true";
    fail(value.span, "'" + value.text + "' is no bool", "write true or false");
    return std::nullopt;
  }
  if (type.text != "int" && type.text != "double") {
    fail(type.span, "there is no type '" + type.text + "'", "known: bool, string, int, double");
    return std::nullopt;
  }
  if (std::int64_t whole = 0; type.text == "int" && parse_number(value.text, whole)) return whole;
  double number = 0;
  if (!parse_number(value.text, number) || !std::isfinite(number)) {
    fail(value.span, "'" + value.text + "' is no number", "write for example 5 or 0.06");
    return std::nullopt;
  }
  if (type.text == "int")
    notes.push_back("the reference reads this int only up to the first character that is no digit");
  return number;
}

// `line` up to the comment behind it, which is remembered. A // inside a text or, in a constant,
// inside a word is none.
Span FileReader::without_comment(Span line) {
  const std::string_view text = source_.text();
  bool is_quoted = false;
  for (std::uint32_t at = line.begin; at < line.end; ++at) {
    if (text[at] == '"') is_quoted = !is_quoted;
    const bool begins_word = at == line.begin || is_blank(text[at - 1]);
    const bool slashes = text[at] == '/' && at + 1 < line.end && text[at + 1] == '/';
    const bool inside_word = section_ == Section::kRules;
    if (is_quoted || !(begins_word ? slashes || text[at] == '#' : slashes && inside_word)) continue;
    comment_behind_ = comment_text({at, line.end});
    return {line.begin, at};
  }
  return line;
}

// A line that is followed by the next rule or the end: the reference skips it, whatever it says.
bool FileReader::is_separator() const {
  for (std::uint32_t next = line_ + 1; next <= source_.line_count(); ++next) {
    const std::vector<Word> words = split_words(source_, source_.line(next));
    if (words.empty()) continue;
    return !file_.rules.empty() && (words[0].text == "RULE" || words[0].text == "END");
  }
  return false;
}

std::string FileReader::comment_text(Span comment) const {
  std::string_view text = source_.text(comment);
  while (!text.empty() && (text.front() == '#' || text.front() == '/' || is_blank(text.front())))
    text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return std::string(text);
}

Remarks FileReader::remarks() {
  Remarks remarks;
  remarks.line = line_;
  remarks.comments.swap(comments_);
  remarks.comment_behind.swap(comment_behind_);
  return remarks;
}

Span FileReader::rest(const std::vector<Word>& words, std::size_t from) const {
  const std::uint32_t end = words.back().span.end;
  return from < words.size() ? Span{words[from].span.begin, end} : Span{end, end};
}

bool FileReader::fail(Span span, const std::string& cause, const std::string& remedy) {
  if (!error_.empty()) return false;
  const Position at = source_.position(span.begin);
  error_ = source_.name() + ":" + std::to_string(at.line) + ":" + std::to_string(at.column) + ": " +
           cause + (remedy.empty() ? "" : "; " + remedy);
  return false;
}

}  // namespace culprit::foreign
