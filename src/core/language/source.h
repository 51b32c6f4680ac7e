// A rule file's text, and places in it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/expected.h"
#include "base/text_file.h"

namespace culprit {

// Bytes [begin, end) of a Source's text.
struct Span {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  bool operator==(const Span&) const = default;
};

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

  // Reads a file. Errors: it cannot be read, or it is larger than kMaxSize.
  static Expected<Source> read(const std::string& path);

  const std::string& name() const { return name_; }
  std::string_view text() const { return text_; }
  std::string_view text(Span span) const;

  std::size_t line_count() const { return line_starts_.size(); }
  Position position(std::uint32_t offset) const;
  // Line `line` (from 1), without its line end.
  Span line(std::uint32_t line) const;

 private:
  std::string name_;
  std::string text_;
  std::vector<std::uint32_t> line_starts_;
};

// How many characters (UTF-8 code points) `text` shows.
std::uint32_t character_count(std::string_view text);

}  // namespace culprit
