#include "language/source.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace culprit {

struct Source::Parts {
  std::vector<Source> files;
  std::vector<Piece> pieces;
  std::vector<Step> steps;
};

Source::Source(std::string name, std::string text)
    : name_(std::move(name)), text_(std::move(text)) {
  if (text_.starts_with("\xEF\xBB\xBF")) text_.erase(0, 3);
  find_lines();
}

Source::Source(std::string text, std::vector<Source> files, std::vector<Piece> pieces,
               std::vector<Step> steps)
    : name_(files.front().name()), text_(std::move(text)) {
  find_lines();
  parts_ =
      std::make_shared<const Parts>(Parts{std::move(files), std::move(pieces), std::move(steps)});
}

void Source::find_lines() {
  line_starts_.push_back(0);
  for (auto end = text_.find('\n'); end != std::string::npos; end = text_.find('\n', end + 1))
    line_starts_.push_back(static_cast<std::uint32_t>(end + 1));
}

std::size_t Source::file_count() const { return parts_ ? parts_->files.size() : 1; }

const Source& Source::file(std::uint32_t index) const {
  return parts_ ? parts_->files[index] : *this;
}

Origin Source::origin(Span span) const {
  if (!parts_) return {{0, span}, true, {}, {}};
  return origin_of(span, parts_->pieces, parts_->steps, static_cast<std::uint32_t>(text_.size()));
}

Source Source::followed_by(std::string text) const {
  if (!parts_) return Source(name_, text_ + text);
  Parts parts = *parts_;
  const auto size = static_cast<std::uint32_t>(text.size());
  parts.pieces.push_back({static_cast<std::uint32_t>(text_.size()),
                          {static_cast<std::uint32_t>(parts.files.size()), {0, size}}});
  std::string all = text_ + text;
  parts.files.emplace_back(name_, std::move(text));
  return Source(std::move(all), std::move(parts.files), std::move(parts.pieces),
                std::move(parts.steps));
}

Expected<Source> Source::read(const std::string& path) {
  std::error_code unseen;
  const auto kind = std::filesystem::status(path, unseen).type();
  // Reading one could wait for ever, and give something else each time.
  if (kind == std::filesystem::file_type::fifo || kind == std::filesystem::file_type::socket ||
      kind == std::filesystem::file_type::character || kind == std::filesystem::file_type::block)
    return Error{"'" + path + "' is a pipe, a socket or a device; a rule file is a regular file"};
  if (kind == std::filesystem::file_type::directory)
    return Error{"'" + path + "' is a folder; name a rule file in it"};
  std::ifstream file(path, std::ios::binary);
  if (!file) return Error{"cannot read '" + path + "': " + std::strerror(errno)};
  std::string text;
  std::error_code error;
  if (const auto size = std::filesystem::file_size(path, error); !error && size <= kMaxSize)
    text.reserve(size);
  char block[1 << 16];
  while (file.read(block, sizeof block) || file.gcount() > 0) {
    text.append(block, static_cast<std::size_t>(file.gcount()));
    if (text.size() > kMaxSize)
      return Error{"'" + path + "' is larger than 64 MiB; is it a rule file?"};
  }
  if (file.bad() || !file.eof()) return Error{"cannot read '" + path + "' to its end"};
  return Source(path, std::move(text));
}

std::string_view Source::text(Span span) const {
  return std::string_view(text_).substr(span.begin, span.end - span.begin);
}

Position Source::position(std::uint32_t offset) const {
  const auto after = std::upper_bound(line_starts_.begin(), line_starts_.end(), offset);
  const auto line = static_cast<std::uint32_t>(after - line_starts_.begin());
  const std::uint32_t start = line_starts_[line - 1];
  return {line, character_count(text({start, offset})) + 1};
}

Span Source::line(std::uint32_t line) const {
  const std::uint32_t begin = line_starts_[line - 1];
  auto end = line < line_starts_.size() ? line_starts_[line] - 1
                                        : static_cast<std::uint32_t>(text_.size());
  if (end > begin && text_[end - 1] == '\r') --end;
  return {begin, end};
}

std::uint32_t character_count(std::string_view text) {
  const auto starts_character = [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  };
  return static_cast<std::uint32_t>(std::count_if(text.begin(), text.end(), starts_character));
}

}  // namespace culprit
