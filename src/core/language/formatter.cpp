#include "language/formatter.h"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "language/foreign_files.h"
#include "language/functions.h"
#include "language/parser.h"
#include "language/scanner.h"

namespace culprit {
namespace {

// No column is made wider than this, and no comment is put further to the right. It bounds the
// padding that a hostile file can ask for.
constexpr std::uint32_t kWidestCell = 80;
constexpr std::uint32_t kWidestCommentedLine = 120;

// One line of the text, in pieces that know how they are laid out but not yet where.
struct Line {
  std::string_view keyword;        // of the statement; empty: none
  std::vector<std::string> cells;  // the statement, column by column; columns may be empty
  std::string_view comment;        // without trailing blanks
  std::uint32_t indentation = 0;
  std::string text;  // the statement, laid out

  bool is_blank() const { return keyword.empty() && comment.empty(); }
};

// Statements that stand in columns, and the words that begin a column.
struct Table {
  std::string_view keyword;
  std::string_view separator;
  std::array<std::pair<std::string_view, std::size_t>, 6> columns;
};
constexpr std::array kTables = {
    Table{"COMPONENT",
          "  ",
          {{{"NODE", 1}, {"LAUNCH", 2}, {"UNIT", 2}, {"CONTAINER", 2}, {"IN", 2}}}},
    Table{"SIGNAL",
          "  ",
          {{{"DIAGNOSTIC", 1},
            {"TOPIC", 1},
            {"PARAMETER", 1},
            {"FROM", 2},
            {"STALE", 3},
            {"RANGE", 4}}}},
    Table{"CONST", " ", {{{"=", 1}}}},
};

const Table* find_table(std::string_view keyword) {
  const auto found = std::find_if(kTables.begin(), kTables.end(),
                                  [&](const Table& t) { return t.keyword == keyword; });
  return found == kTables.end() ? nullptr : &*found;
}

std::uint32_t indentation_of(std::string_view keyword) {
  if (keyword == "POLICIES" || keyword == "TRIGGER") return 2;
  if (keyword == "STRATEGY") return 4;
  return keyword == "ADAPTATION" || keyword == "THEN" ? 6 : 0;
}

// ---- One statement: which tokens touch

class Spacing {
 public:
  explicit Spacing(const Source& source) : source_(source) {}

  // Whether a space stands between two tokens of a `keyword` line; `before` is the one in front of
  // both, null at the beginning.
  bool between(std::string_view keyword, const Lexeme* before, const Lexeme& left,
               const Lexeme& right) const {
    if (is(right, ")") || is(right, ",") || is(left, "(")) return false;
    if (is(right, "(") && (has_list(keyword) || is_function(left))) return false;
    if (is_unary(left, before)) return false;
    if (is(left, "..") || is(right, "..")) return !touches_range(left, right);
    const bool is_hold = keyword == "POLICIES" && (is(left, "/") || is(right, "/"));
    return !is_hold;
  }

  // Whether `rest` begins with the parentheses of no argument, which are left out.
  bool is_empty_list(std::string_view keyword, std::span<const Lexeme> rest) const {
    return has_list(keyword) && rest.size() >= 2 && is(rest[0], "(") && is(rest[1], ")");
  }

 private:
  static bool has_list(std::string_view keyword) {
    return keyword == "TEMPLATE" || keyword == "USE";
  }

  std::string_view text(const Lexeme& lexeme) const { return source_.text(lexeme.span); }

  bool is(const Lexeme& lexeme, std::string_view symbol) const {
    return lexeme.kind == Lexeme::Kind::kSymbol && text(lexeme) == symbol;
  }

  bool is_function(const Lexeme& lexeme) const {
    return lexeme.kind == Lexeme::Kind::kWord && find_function(text(lexeme)) != nullptr;
  }

  bool is_unary(const Lexeme& sign, const Lexeme* before) const {
    const bool is_sign = is(sign, "-") || is(sign, "+");
    return is(sign, "!") || (is_sign && (before == nullptr || !ends_operand(*before)));
  }

  bool ends_operand(const Lexeme& lexeme) const {
    switch (lexeme.kind) {
      case Lexeme::Kind::kLiteral:
        return true;
      case Lexeme::Kind::kSymbol:
        return is(lexeme, ")");
      case Lexeme::Kind::kName:  // of a parameter, in front of its value
        return false;
      case Lexeme::Kind::kWord: {
        const std::string_view word = text(lexeme);
        return word != "TRIGGER" && word != "INTERLOCK" && word != "ABORT" && word != "WHEN" &&
               word != "RANGE";
      }
    }
    return false;
  }

  // 0..1, but 0. .. .5, whose points would be read otherwise.
  bool touches_range(const Lexeme& left, const Lexeme& right) const {
    return is(left, "..") ? text(right).front() != '.' : text(left).back() != '.';
  }

  const Source& source_;
};

std::vector<std::string> cells_of(const Source& source, std::span<const Lexeme> statement) {
  const Spacing spacing(source);
  const std::string_view keyword = source.text(statement.front().span);
  const Table* table = find_table(keyword);
  std::vector<std::string> cells = {std::string(keyword)};
  for (std::size_t i = 1; i < statement.size(); ++i) {
    if (spacing.is_empty_list(keyword, statement.subspan(i))) {
      ++i;
      continue;
    }
    const std::string_view text = source.text(statement[i].span);
    std::size_t column = 0;
    // The declared name is never a clause, and a clause is never a name.
    if (table != nullptr && i >= 2 && statement[i].kind != Lexeme::Kind::kName) {
      for (const auto& [word, index] : table->columns) {
        if (word == text) column = index;
      }
    }
    if (column > 0) {
      // As written, also in an unusual order.
      cells.resize(std::max(column, cells.size()) + 1);
    } else if (spacing.between(keyword, i >= 2 ? &statement[i - 2] : nullptr, statement[i - 1],
                               statement[i])) {
      cells.back() += ' ';
    }
    cells.back() += text;
  }
  return cells;
}

// ---- All lines

std::vector<Line> lines_of(const Source& source, const std::vector<Lexeme>& lexemes) {
  std::vector<Line> lines;
  std::uint32_t margin = 0;  // of the statements of a template
  auto next = lexemes.begin();
  for (std::uint32_t number = 1; number <= source.line_count(); ++number) {
    const Span span = source.line(number);
    const auto first = next;
    while (next != lexemes.end() && next->span.begin < span.end) ++next;
    Line line;
    std::uint32_t end = span.begin;
    if (next != first) {
      line.keyword = source.text(first->span);
      line.cells = cells_of(source, {first, next});
      if (line.keyword == "END") margin = 0;
      line.indentation = margin + indentation_of(line.keyword);
      if (line.keyword == "TEMPLATE") margin = 2;
      end = std::prev(next)->span.end;
    }
    line.comment = trimmed(source.text({end, span.end}));
    const bool is_second_blank = line.is_blank() && (lines.empty() || lines.back().is_blank());
    if (!is_second_blank) lines.push_back(std::move(line));
  }
  while (!lines.empty() && lines.back().is_blank()) lines.pop_back();
  return lines;
}

void append_padded(std::string& out, std::string_view text, std::uint32_t width) {
  out += text;
  const std::uint32_t shown = character_count(text);
  if (shown < width) out.append(width - shown, ' ');
}

// Statements of one kind that follow each other: their cells below each other.
void lay_out(std::span<Line> block) {
  const Table* table = find_table(block.front().keyword);
  std::vector<std::uint32_t> widths;
  for (const Line& line : block) {
    widths.resize(std::max(widths.size(), line.cells.size()));
    for (std::size_t i = 0; i < line.cells.size(); ++i) {
      widths[i] = std::max(widths[i], std::min(character_count(line.cells[i]), kWidestCell));
    }
  }
  for (Line& line : block) {
    line.text.assign(line.indentation, ' ');
    for (std::size_t i = 0; i + 1 < line.cells.size(); ++i) {
      if (widths[i] == 0) continue;
      append_padded(line.text, line.cells[i], widths[i]);
      line.text += table->separator;
    }
    line.text += line.cells.back();
  }
}

// Calls `visit` with each longest run of lines that `belongs` says to go on from the one before.
template <class Belongs, class Visit>
void for_each_run(std::vector<Line>& lines, Belongs belongs, Visit visit) {
  for (std::size_t begin = 0; begin < lines.size();) {
    std::size_t end = begin + 1;
    while (end < lines.size() && belongs(lines[end - 1], lines[end])) ++end;
    visit(std::span(lines).subspan(begin, end - begin));
    begin = end;
  }
}

void lay_out_statements(std::vector<Line>& lines) {
  for_each_run(
      lines,
      [](const Line& a, const Line& b) {
        return a.keyword == b.keyword && find_table(a.keyword) != nullptr;
      },
      [](std::span<Line> block) {
        if (!block.front().keyword.empty()) lay_out(block);
      });
}

void lay_out_trailing_comments(std::vector<Line>& lines) {
  const auto has_both = [](const Line& l) { return !l.keyword.empty() && !l.comment.empty(); };
  for_each_run(
      lines, [&](const Line& a, const Line& b) { return has_both(a) && has_both(b); },
      [&](std::span<Line> block) {
        if (!has_both(block.front())) return;
        std::uint32_t column = 0;
        for (const Line& line : block) {
          column = std::max(column, std::min(character_count(line.text), kWidestCommentedLine));
        }
        for (Line& line : block) {
          std::string text;
          append_padded(text, line.text, column);
          line.text = text.append("  ").append(line.comment);
        }
      });
}

// Comments are indented as the statement that they touch, below or else above; else as the next.
void lay_out_comment_lines(std::vector<Line>& lines) {
  std::vector<std::uint32_t> next_indentation(lines.size() + 1);
  for (std::size_t i = lines.size(); i-- > 0;) {
    next_indentation[i] = lines[i].keyword.empty() ? next_indentation[i + 1] : lines[i].indentation;
  }
  const auto is_comment = [](const Line& l) { return l.keyword.empty() && !l.comment.empty(); };
  for_each_run(
      lines, [&](const Line& a, const Line& b) { return is_comment(a) && is_comment(b); },
      [&](std::span<Line> block) {
        if (!is_comment(block.front())) return;
        const auto begin = static_cast<std::size_t>(block.data() - lines.data());
        const std::size_t end = begin + block.size();
        const bool touches_below = end < lines.size() && !lines[end].keyword.empty();
        const bool touches_above = begin > 0 && !lines[begin - 1].keyword.empty();
        const std::uint32_t indentation =
            touches_above && !touches_below ? lines[begin - 1].indentation : next_indentation[end];
        for (Line& line : block) line.text.assign(indentation, ' ').append(line.comment);
      });
}

}  // namespace

Expected<std::string> format(const Source& source, Colour colour) {
  std::vector<Diagnostic> diagnostics;
  std::vector<Lexeme> lexemes;
  parse(source, diagnostics, &lexemes);
  if (!diagnostics.empty()) {
    condense(source, diagnostics);
    return Error{render(diagnostics, source, colour)};
  }
  std::vector<Line> lines = lines_of(source, lexemes);
  lay_out_statements(lines);
  lay_out_trailing_comments(lines);
  lay_out_comment_lines(lines);
  std::string out;
  for (const Line& line : lines) out.append(line.text).append("\n");
  return out;
}

}  // namespace culprit
