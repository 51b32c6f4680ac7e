#include "ros2/helper_outbox.h"

#include <cerrno>
#include <sys/socket.h>
#include <sys/types.h>
#include <utility>

namespace culprit::ros2 {
namespace {

std::size_t kept_for(const culprit_link::Bytes& frame) { return sizeof frame + frame.capacity(); }

}  // namespace

void HelperOutbox::greet(const culprit_link::Frame& first) {
  close();
  waiting_.push_back(culprit_link::encode(first));
  bytes_ = kept_for(waiting_.back());
  is_stuck_ = false;
}

void HelperOutbox::close() {
  is_up_ = false;
  waiting_.clear();
  sent_ = bytes_ = 0;
}

bool HelperOutbox::queue(const culprit_link::Frame& frame) {
  if (!is_up_ || is_stuck_) return false;
  culprit_link::Bytes bytes = culprit_link::encode(frame);
  if (bytes.size() > culprit_link::kLargestFrame + culprit_link::kLengthSize) return true;
  bytes_ += kept_for(bytes);
  waiting_.push_back(std::move(bytes));
  is_stuck_ = bytes_ > culprit_link::kLongestQueue;
  return true;
}

bool HelperOutbox::send(int socket) {
  while (!waiting_.empty()) {
    const culprit_link::Bytes& first = waiting_.front();
    const ssize_t count = ::send(socket, first.data() + sent_, first.size() - sent_, MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return true;
    if (count <= 0) return false;
    sent_ += static_cast<std::size_t>(count);
    if (sent_ < first.size()) continue;
    bytes_ -= kept_for(first);
    waiting_.pop_front();
    sent_ = 0;
  }
  return true;
}

}  // namespace culprit::ros2
