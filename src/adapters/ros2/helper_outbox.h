// Holds frames until the helper program reads them. Not thread-safe.
#pragma once

#include <cstddef>

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
  // The helper has left too much unread.
  bool is_stuck() const { return is_stuck_; }

 private:
  culprit_link::Bytes waiting_;
  std::size_t sent_ = 0;  // of waiting_
  bool is_up_ = false;
  bool is_stuck_ = false;
};

}  // namespace culprit::ros2
