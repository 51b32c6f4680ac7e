// One line of time for all messages of a bag, whatever its clock and its files did.
//
// A recorder writes messages as they come, so the order in which they stand in a file says which came
// first, even where the clock was set in between. But a bag may also have been written in another
// order: topic by topic, or with its chunks rearranged. To distinguish them, the messages are cut
// into pieces of steady time, in the order of the file. Sorted by their times, the pieces of a
// rearranged bag fit together without a hole; those before and after a clock was set do not.
//
//     PieceFinder finder;
//     finder.add(ordinal, topic, at);                  // each message, as written
//     const TimeLine line = straighten(finder.pieces());
//     at + line.offset_of(ordinal)                     // its time, as if the clock had not jumped
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

namespace culprit::bag {

// Times are in nanoseconds.
struct TimePiece {
  std::int64_t ordinal = 0;  // of its first message, in the order of the file
  std::int64_t first = 0;    // the earliest time in it
  std::int64_t last = 0;     // the latest
  std::uint64_t messages = 0;
  bool goes_back = false;  // it begins with a topic whose times go back

  // From one message to the next, on average. 0: not known.
  std::int64_t usual_gap() const {
    return messages < 2 ? 0 : (last - first) / static_cast<std::int64_t>(messages - 1);
  }
};

class PieceFinder {
 public:
  // The next message as written. Ordinals ascend; times are at least 0.
  void add(std::int64_t ordinal, std::size_t topic, std::int64_t at);
  // So many messages at once, whose times go back by less than kSlack.
  void add_stretch(std::int64_t ordinal, std::int64_t first, std::int64_t last,
                   std::uint64_t messages);
  const std::vector<TimePiece>& pieces() const { return pieces_; }
  // Messages that were written after one of a later time, of those that were added one by one.
  std::uint64_t late() const { return late_; }

  // Messages that a recorder held at the same time may be written in any order.
  static constexpr std::int64_t kSlack = 1'000'000'000;

 private:
  // From here on all messages are earlier than those before: the clock may have been set.
  struct Turn {
    TimePiece before;
    TimePiece after;
  };

  std::vector<TimePiece> pieces_;
  std::unordered_map<std::size_t, std::int64_t> newest_;  // by topic, in the last piece
  std::optional<Turn> turn_;
  std::uint64_t late_ = 0;
};

// If nothing at all was recorded for longer, the clock was set, or the recorder paused.
inline constexpr std::int64_t kLongestHole = 600'000'000'000;

struct TimeLine {
  struct Stretch {
    std::int64_t ordinal = 0;  // from this message on, in the order of the file
    std::int64_t offset = 0;   // is to be added to times
  };
  struct Jump {
    std::int64_t at = 0;  // of the first message after it, with its offset
    std::int64_t by = 0;  // positive: the clock went forward
    std::int64_t recorded_at = 0;
  };
  std::vector<Stretch> stretches;  // ascending; the first begins with the first message
  std::vector<Jump> jumps;
  // Stretches follow one another in time as in the file. If not, messages are to be sorted by their times.
  bool is_in_file_order = false;
  std::int64_t first = 0;  // with offsets
  std::int64_t last = 0;
  std::uint64_t messages = 0;

  std::int64_t offset_of(std::int64_t ordinal) const;
  // All of it becomes later by so much.
  void move(std::int64_t by);
};

// `pieces` in the order of the file.
TimeLine straighten(const std::vector<TimePiece>& pieces);

}  // namespace culprit::bag
