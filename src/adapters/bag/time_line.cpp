#include "bag/time_line.h"

#include <algorithm>
#include <numeric>

namespace culprit::bag {
namespace {

// Of usual gaps: a longer step is a hole, behind which another piece begins.
constexpr std::int64_t kUsualGaps = 10;

// Holes that a gap may be without being one.
std::int64_t tolerance(const TimePiece& a, const TimePiece& b) {
  return std::max(PieceFinder::kSlack, kUsualGaps * std::max(a.usual_gap(), b.usual_gap()));
}

// From the last message of `before` to the first of `after`, had the clock run on.
std::int64_t gap_between(const TimePiece& before, const TimePiece& after) {
  constexpr std::int64_t kUnknown = 1'000'000;
  const std::int64_t gap = std::min(before.usual_gap() > 0 ? before.usual_gap() : after.usual_gap(),
                                    PieceFinder::kSlack);
  return gap > 0 ? gap : kUnknown;
}

// How often the pieces do not fit together when they are sorted: they overlap, or leave a hole where
// others stand between them in the file.
std::size_t misfits(const std::vector<TimePiece>& pieces, const std::vector<std::size_t>& sorted) {
  std::size_t count = 0;
  std::int64_t end = pieces[sorted[0]].last;
  for (std::size_t k = 1; k < sorted.size(); ++k) {
    const TimePiece& before = pieces[sorted[k - 1]];
    const TimePiece& piece = pieces[sorted[k]];
    const std::int64_t hole = piece.first - end;
    const bool is_neighbour = sorted[k - 1] + 1 == sorted[k];
    if (hole < -PieceFinder::kSlack || (!is_neighbour && hole > tolerance(before, piece))) ++count;
    end = std::max(end, piece.last);
  }
  return count;
}

void extend(TimePiece& piece, std::int64_t at) {
  piece.first = std::min(piece.first, at);
  piece.last = std::max(piece.last, at);
  ++piece.messages;
}

}  // namespace

void PieceFinder::add(std::int64_t ordinal, std::size_t topic, std::int64_t at) {
  constexpr std::size_t kMostPieces = 10'000;  // the file decides how many there are
  if (pieces_.empty()) pieces_.push_back({ordinal, at, at, 0, false});
  TimePiece& piece = pieces_.back();
  const std::int64_t step = at - piece.last;
  if (step > kSlack && step > kUsualGaps * piece.usual_gap() && pieces_.size() < kMostPieces) {
    pieces_.push_back({ordinal, at, at, 1, false});
    turn_.reset();
    newest_.clear();
    newest_[topic] = at;
    return;
  }
  if (step >= -kSlack) {
    turn_.reset();
  } else if (turn_) {
    extend(turn_->after, at);
  } else {
    turn_ = Turn{piece, {ordinal, at, at, 1, true}};
  }
  const auto [newest, is_first] = newest_.try_emplace(topic, at);
  const bool goes_back = !is_first && turn_ && at < newest->second - kSlack;
  if (goes_back && pieces_.size() < kMostPieces) {
    const Turn turn = *turn_;
    pieces_.back() = turn.before;
    pieces_.push_back(turn.after);
    turn_.reset();
    newest_.clear();
    newest_[topic] = at;
    return;
  }
  if (step < 0) ++late_;
  newest->second = std::max(newest->second, at);
  extend(piece, at);
}

void PieceFinder::add_stretch(std::int64_t ordinal, std::int64_t first, std::int64_t last,
                              std::uint64_t messages) {
  const bool continues = !pieces_.empty() && first <= pieces_.back().last + kLongestHole;
  if (!continues) return pieces_.push_back({ordinal, first, last, messages, false});
  TimePiece& piece = pieces_.back();
  piece.first = std::min(piece.first, first);
  piece.last = std::max(piece.last, last);
  piece.messages += messages;
}

TimeLine straighten(const std::vector<TimePiece>& pieces) {
  TimeLine line;
  if (pieces.empty()) return line;
  std::vector<std::size_t> order(pieces.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::vector<std::size_t> sorted = order;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](std::size_t a, std::size_t b) { return pieces[a].first < pieces[b].first; });
  const auto turns = static_cast<std::size_t>(
      std::ranges::count_if(pieces, [](const TimePiece& each) { return each.goes_back; }));
  line.is_in_file_order = turns > 0 && misfits(pieces, sorted) >= turns;
  if (!line.is_in_file_order) order = sorted;

  std::vector<std::int64_t> offsets(pieces.size());
  std::int64_t offset = 0;
  line.first = pieces[order[0]].first;
  line.last = pieces[order[0]].last;
  line.messages = pieces[order[0]].messages;
  for (std::size_t k = 1; k < order.size(); ++k) {
    const TimePiece& piece = pieces[order[k]];
    const std::int64_t hole = piece.first + offset - line.last;
    if (hole > kLongestHole || (line.is_in_file_order && hole < -PieceFinder::kSlack)) {
      const std::int64_t by = hole - gap_between(pieces[order[k - 1]], piece);
      offset -= by;
      line.jumps.push_back({piece.first + offset, by, piece.first});
    }
    offsets[order[k]] = offset;
    line.first = std::min(line.first, piece.first + offset);
    line.last = std::max(line.last, piece.last + offset);
    line.messages += piece.messages;
  }
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    if (p == 0 || offsets[p] != offsets[p - 1])
      line.stretches.push_back({pieces[p].ordinal, offsets[p]});
  }
  return line;
}

std::int64_t TimeLine::offset_of(std::int64_t ordinal) const {
  const auto after =
      std::upper_bound(stretches.begin(), stretches.end(), ordinal,
                       [](std::int64_t o, const Stretch& each) { return o < each.ordinal; });
  return after == stretches.begin() ? 0 : (after - 1)->offset;
}

void TimeLine::move(std::int64_t by) {
  for (Stretch& each : stretches) each.offset += by;
  for (Jump& each : jumps) each.at += by;
  first += by;
  last += by;
}

}  // namespace culprit::bag
