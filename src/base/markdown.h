// Reads our documents that are also compiled in, so that a text has one source.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace culprit {

// The text below a heading, up to the next one.
struct MarkdownSection {
  std::string_view heading;
  std::string_view text;
};

// The sections below "## heading", in order.
std::vector<MarkdownSection> markdown_sections(std::string_view page);

// The text after the first `from`, up to the first `to` behind it or the end; empty without `from`.
std::string_view text_between(std::string_view text, std::string_view from, std::string_view to);

// The lines of its code, those that four blanks indent, without these blanks.
std::string indented_code(std::string_view text);

}  // namespace culprit
