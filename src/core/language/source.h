// A rule file's text, and places in it. A text that INCLUDE and USE have put together
// (reuse/expansion.h) knows where each part was written.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/expected.h"
#include "base/text_file.h"
#include "language/text_origins.h"

namespace culprit {

// Lines and columns as people and editors count: from 1, columns in characters (UTF-8 code points).
struct Position {
  std::uint32_t line = 1;
  std::uint32_t column = 1;
};

class Source {
 public:
  // The largest rule file that is read, in bytes. Far above any real one; it bounds what a hostile
  // file can cost.
  static constexpr std::size_t kMaxSize = kMaxTextSize;

  // `name` is what messages call it, usually its path. A UTF-8 byte order mark at the start is
  // dropped.
  Source(std::string name, std::string text);

  // A text that was put together from the texts of `files`, at least one; it is called as the first
  // one. @pre the pieces are ascending, and all that they name is there.
  Source(std::string text, std::vector<Source> files, std::vector<Piece> pieces,
         std::vector<Step> steps);

  // Reads a file. Errors: it cannot be read, or it is larger than kMaxSize.
  static Expected<Source> read(const std::string& path);

  const std::string& name() const { return name_; }
  std::string_view text() const { return text_; }
  std::string_view text(Span span) const;

  // The files that it was put together from, as they are written; else itself.
  std::size_t file_count() const;
  const Source& file(std::uint32_t index) const;
  // Where a part of the text is written.
  Origin origin(Span span) const;
  // The same with `text` behind it, which is in no file.
  Source followed_by(std::string text) const;

  std::size_t line_count() const { return line_starts_.size(); }
  Position position(std::uint32_t offset) const;
  // Line `line` (from 1), without its line end.
  Span line(std::uint32_t line) const;

 private:
  void find_lines();

  std::string name_;
  std::string text_;
  std::vector<std::uint32_t> line_starts_;
  struct Parts;
  std::shared_ptr<const Parts> parts_;  // the same for all copies; null: it is one file's text
};

// How many characters (UTF-8 code points) `text` shows.
std::uint32_t character_count(std::string_view text);

}  // namespace culprit
