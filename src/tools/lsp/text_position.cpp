#include "lsp/text_position.h"

namespace culprit::lsp {
namespace {

// The UTF-16 units of the UTF-8 character that begins with `lead`. Four bytes are two units (a
// surrogate pair); a continuation byte is none.
std::uint32_t units(unsigned char lead) {
  if ((lead & 0xC0) == 0x80) return 0;
  return lead >= 0xF0 ? 2 : 1;
}

}  // namespace

TextPosition text_position(const Source& source, std::uint32_t offset) {
  const std::uint32_t line = source.position(offset).line;
  TextPosition out{line - 1, 0};
  for (const char c : source.text({source.line(line).begin, offset}))
    out.character += units(static_cast<unsigned char>(c));
  return out;
}

std::uint32_t offset_of(const Source& source, TextPosition position) {
  if (position.line >= source.line_count()) return static_cast<std::uint32_t>(source.text().size());
  const Span line = source.line(position.line + 1);
  std::uint32_t seen = 0;
  for (std::uint32_t at = line.begin; at < line.end; ++at) {
    const std::uint32_t width = units(static_cast<unsigned char>(source.text()[at]));
    if (width > 0 && seen >= position.character) return at;
    seen += width;
  }
  return line.end;
}

}  // namespace culprit::lsp
