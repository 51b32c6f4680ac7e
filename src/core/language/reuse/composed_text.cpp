#include "language/reuse/composed_text.h"

#include <algorithm>

namespace culprit {
namespace {

std::vector<Piece>::const_iterator piece_at(const std::vector<Piece>& pieces, std::uint32_t at) {
  const auto after =
      std::upper_bound(pieces.begin(), pieces.end(), at,
                       [](std::uint32_t offset, const Piece& p) { return offset < p.begin; });
  return after == pieces.begin() ? after : std::prev(after);
}

}  // namespace

void ComposedText::add(std::string_view bytes, Piece piece) {
  if (bytes.empty()) return;
  piece.begin = size();
  pieces.push_back(piece);
  text += bytes;
}

void ComposedText::add(const ComposedText& other, Span part) {
  for (auto piece = piece_at(other.pieces, part.begin);
       piece != other.pieces.end() && piece->begin < part.end; ++piece) {
    const auto next = std::next(piece);
    const std::uint32_t piece_end = next == other.pieces.end() ? other.size() : next->begin;
    const Span shared{std::max(piece->begin, part.begin), std::min(piece_end, part.end)};
    Piece copy = *piece;
    if (copy.is_verbatim) {
      copy.written.span.begin += shared.begin - piece->begin;
      copy.written.span.end = copy.written.span.begin + (shared.end - shared.begin);
    }
    if (shared != Span{piece->begin, piece_end}) copy.is_argument_verbatim = false;
    add(std::string_view(other.text).substr(shared.begin, shared.end - shared.begin), copy);
  }
}

void ComposedText::add_instead(std::string_view bytes, const ComposedText& other, Span part) {
  if (other.pieces.empty()) return;
  Piece piece = *piece_at(other.pieces, part.begin);
  if (piece.is_verbatim) {
    Span& written = piece.written.span;
    written.begin = std::min(written.begin + (part.begin - piece.begin), written.end);
    written.end = std::min(written.begin + (part.end - part.begin), written.end);
    piece.is_verbatim = false;
  }
  piece.is_argument_verbatim = false;
  add(bytes, piece);
}

ComposedText replaced(const ComposedText& text, std::vector<Replacement> replacements) {
  std::stable_sort(
      replacements.begin(), replacements.end(),
      [](const Replacement& a, const Replacement& b) { return a.span.begin < b.span.begin; });
  ComposedText out;
  std::uint32_t done = 0;
  for (const Replacement& each : replacements) {
    out.add(text, {done, each.span.begin});
    out.add_instead(each.text, text, each.span);
    done = each.span.end;
  }
  out.add(text, {done, text.size()});
  return out;
}

}  // namespace culprit
