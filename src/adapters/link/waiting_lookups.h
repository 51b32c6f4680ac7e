// Messages that wait until their writer is looked up.
//
// They wait by bytes, for the network decides how many come. A writer whose message has no room is looked up all the same,
// without the message: otherwise a flood of one writer would keep each other one unknown.
#pragma once

#include <cstddef>
#include <cstdint>
#include <set>

#include "rtps/guid.h"

namespace culprit::link {

class WaitingLookups {
 public:
  enum class Room : std::uint8_t { kNone, kWriterOnly, kMessage };
  static constexpr std::size_t kMostWriters = 1000;

  explicit WaitingLookups(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  // A message of this size has come. Unless kNone, the caller looks up its writer and then calls done().
  Room admit(const rtps::Guid& writer, std::size_t size) {
    if (bytes_ + size <= most_bytes_) {
      bytes_ += size;
      return Room::kMessage;
    }
    const bool has_room = alone_.size() < kMostWriters && alone_.insert(writer).second;
    return has_room ? Room::kWriterOnly : Room::kNone;
  }
  void done(const rtps::Guid& writer, std::size_t size, Room room) {
    if (room == Room::kMessage) bytes_ -= size;
    if (room == Room::kWriterOnly) alone_.erase(writer);
  }

 private:
  const std::size_t most_bytes_;
  std::size_t bytes_ = 0;
  std::set<rtps::Guid> alone_;  // writers without their message
};

}  // namespace culprit::link
