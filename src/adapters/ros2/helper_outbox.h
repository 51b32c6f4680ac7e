// Holds frames until the helper program reads them. Not thread-safe.
#pragma once

#include <cstddef>
#include <deque>

#include "culprit_link/protocol.h"

namespace culprit::ros2 {

class HelperOutbox {
 public:
  // Begins with a new helper, which is sent `first`, and nothing else before begin().
  void greet(const culprit_link::Frame& first);
  void begin() { is_up_ = true; }
  // Its helper has ended, and what waited is lost.
  void close();

  // False: no helper takes it now.
  bool queue(const culprit_link::Frame& frame);
  // Sends as much as the socket takes without waiting. False: it is broken.
  bool send(int socket);

  bool has_waiting() const { return !waiting_.empty(); }
  // Bytes that it keeps: of whole frames, though the first one may be sent in part.
  std::size_t memory() const { return bytes_; }
  // The helper has left too much unread.
  bool is_stuck() const { return is_stuck_; }

 private:
  std::deque<culprit_link::Bytes> waiting_;  // frames
  std::size_t sent_ = 0;                     // bytes, of the first one
  std::size_t bytes_ = 0;
  bool is_up_ = false;
  bool is_stuck_ = false;
};

}  // namespace culprit::ros2
