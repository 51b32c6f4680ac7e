#include "language/text_origins.h"

#include <algorithm>

#include "base/invariant.h"

namespace culprit {
namespace {

std::size_t piece_at(std::uint32_t offset, const std::vector<Piece>& pieces) {
  const auto after =
      std::upper_bound(pieces.begin(), pieces.end(), offset,
                       [](std::uint32_t at, const Piece& piece) { return at < piece.begin; });
  return after == pieces.begin() ? 0 : static_cast<std::size_t>(after - pieces.begin()) - 1;
}

// Where the byte at `offset` of `piece` was written, as the begin or as the end of something.
std::uint32_t begin_in(const Piece& piece, std::uint32_t offset) {
  const Span& span = piece.written.span;
  return piece.is_verbatim ? std::min(span.begin + (offset - piece.begin), span.end) : span.begin;
}
std::uint32_t end_in(const Piece& piece, std::uint32_t offset) {
  const Span& span = piece.written.span;
  return piece.is_verbatim ? std::min(span.begin + (offset - piece.begin), span.end) : span.end;
}

std::vector<Step> up_from(std::uint32_t step, const std::vector<Step>& steps) {
  std::vector<Step> all;
  for (; step != Step::kNone; step = steps[step].by) all.push_back(steps[step]);
  return all;
}

}  // namespace

Origin origin_of(Span span, const std::vector<Piece>& pieces, const std::vector<Step>& steps,
                 std::uint32_t size) {
  CULPRIT_ASSERT(!pieces.empty() && span.begin <= span.end && span.end <= size);
  const std::size_t first = piece_at(span.begin, pieces);
  const std::size_t last = piece_at(span.end > span.begin ? span.end - 1 : span.begin, pieces);
  const Piece& begin = pieces[first];
  const Piece& end = pieces[last];
  if (first == last && begin.argument) {
    const std::uint32_t piece_end = first + 1 < pieces.size() ? pieces[first + 1].begin : size;
    const bool is_all = span == Span{begin.begin, piece_end};
    return {*begin.argument, is_all && begin.is_argument_verbatim, begin.written,
            up_from(begin.argument_step, steps)};
  }
  Origin out;
  out.place = {begin.written.file, {begin_in(begin, span.begin), 0}};
  out.steps = up_from(begin.step, steps);
  // A span over several files gets the place where it begins.
  const bool is_one = end.written.file == begin.written.file && end.step == begin.step;
  const Piece& closing = is_one ? end : begin;
  out.place.span.end = std::max(out.place.span.begin, end_in(closing, is_one ? span.end : size));
  out.is_exact = first == last && begin.is_verbatim;
  return out;
}

}  // namespace culprit
