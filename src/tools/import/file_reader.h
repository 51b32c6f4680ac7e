// The frame that both dialects of the reference share: BEGIN CONSTS ... END CONSTS, BEGIN RULES ...
// END RULES, one statement a line.
//
// The reference wants its section markers unindented, tabs nowhere, and exactly one line between
// two rules; this reader is more tolerant. Lines that begin with # or //, and the line between two
// rules, are comments.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/expected.h"
#include "import/foreign_rules.h"
#include "language/source.h"

namespace culprit::foreign {

// The blank-separated words of `line`.
std::vector<Word> split_words(const Source& source, Span line);

class FileReader {
 public:
  // `keywords`: the words that begin the lines of a rule, RULE first.
  FileReader(const Source& source, std::vector<std::string_view> keywords)
      : source_(source), keywords_(std::move(keywords)) {}

  // Reads the file; calls `statement` for each line of a rule. It is false if the line is wrong,
  // and has called fail() then.
  using Statement = std::function<bool(const std::vector<Word>& words)>;
  Expected<File> read(const Statement& statement);

  const Source& source() const { return source_; }
  File& file() { return file_; }

  // For a part that begins in the present line: takes the comments that stand above and behind.
  Remarks remarks();
  // The words behind `from`, to the end of the line.
  Span rest(const std::vector<Word>& words, std::size_t from) const;

  // Remembers the first complaint, with its place. Gives false, for `return fail(...)`.
  bool fail(Span span, const std::string& cause, const std::string& remedy);
  const std::string& error() const { return error_; }

 private:
  enum class Section { kStart, kConstants, kBetween, kRules, kEnd };

  bool line(const std::vector<Word>& words, const Statement& statement);
  Span without_comment(Span line);
  bool marker(const std::vector<Word>& words);
  bool constant(const std::vector<Word>& words);
  std::optional<syntax::Literal> constant_value(const Word& type, const Word& value,
                                                std::vector<std::string>& notes);
  bool is_separator() const;
  std::string comment_text(Span comment) const;

  const Source& source_;
  std::vector<std::string_view> keywords_;
  File file_;
  Section section_ = Section::kStart;
  std::uint32_t line_ = 0;
  std::vector<std::string> comments_;  // that no part has taken yet
  std::string comment_behind_;
  std::string error_;
};

}  // namespace culprit::foreign
