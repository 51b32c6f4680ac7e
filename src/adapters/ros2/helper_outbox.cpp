#include "ros2/helper_outbox.h"

#include <cerrno>
#include <sys/socket.h>
#include <sys/types.h>

namespace culprit::ros2 {
namespace {

namespace link = culprit_link;

}  // namespace

void HelperOutbox::greet(const link::Frame& first) {
  waiting_ = link::encode(first);
  sent_ = 0;
  is_up_ = false;
  is_stuck_ = false;
}

void HelperOutbox::close() {
  is_up_ = false;
  waiting_.clear();
  sent_ = 0;
}

bool HelperOutbox::queue(const link::Frame& frame) {
  if (!is_up_ || is_stuck_) return false;
  const link::Bytes bytes = link::encode(frame);
  if (bytes.size() > link::kLargestFrame + link::kLengthSize) return true;
  waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
  is_stuck_ = waiting_.size() - sent_ > link::kLongestQueue;
  return true;
}

bool HelperOutbox::send(int socket) {
  while (sent_ < waiting_.size()) {
    const ssize_t count =
        ::send(socket, waiting_.data() + sent_, waiting_.size() - sent_, MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return true;
    if (count <= 0) return false;
    sent_ += static_cast<std::size_t>(count);
  }
  waiting_.clear();
  sent_ = 0;
  return true;
}

}  // namespace culprit::ros2
