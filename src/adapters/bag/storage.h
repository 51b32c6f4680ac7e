// One file of a bag, however it is stored.
//
//     storage.survey(finder);                           // when its messages were recorded
//     storage.follow(straighten(finder.pieces()));      // how to read these times
//     while (storage.next(message)) ...
#pragma once

#include "bag/bag_contents.h"
#include "bag/time_line.h"

namespace culprit::bag {

// No recorder writes such times: they are damage.
inline bool is_time(std::int64_t at) {
  constexpr std::int64_t kYear2100 = 4'102'444'800'000'000'000;
  return at >= 0 && at < kYear2100;
}

class Storage {
 public:
  virtual ~Storage() = default;
  // Once, before all else. Adds the messages in the order of the file.
  virtual void survey(PieceFinder& finder) = 0;
  // Once, before the first message.
  virtual void follow(TimeLine line) = 0;
  // The next message by its time with the offset of the line. False at the end. Losses
  // are reported to the contents. A time that is_time() refuses gets no offset.
  virtual bool next(BagMessage& message) = 0;
  // Messages so far that were written after one of a later time, and that the survey did not count.
  virtual std::uint64_t late() const { return 0; }
};

}  // namespace culprit::bag
