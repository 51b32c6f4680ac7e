#include "http/hub.h"

#include <algorithm>
#include <random>

namespace culprit::http {

std::string_view to_string(Kind kind) {
  constexpr std::array<std::string_view, kKinds> kNames = {"robot",   "graph",   "state",
                                                           "control", "learned", "event"};
  return kNames[static_cast<std::size_t>(kind)];
}

Hub::Hub(std::function<void()> wake)
    : name_(std::to_string(std::random_device()())), wake_(std::move(wake)) {}

Hub::Reader::Reader(Hub& hub) : hub_(hub) {
  if (hub_.readers_++ == 0) hub_.wake();
}

void Hub::publish(Kind kind, std::string data) {
  const auto shared = std::make_shared<const std::string>(std::move(data));
  {
    const MutexLock lock(mutex_);
    const Message message{++last_, kind, shared};
    if (kind == Kind::kEvent) {
      events_.push_back(message);
      bytes_ += shared->size();
      while (events_.size() > kMostEvents || (bytes_ > kMostBytes && events_.size() > 1)) {
        forgotten_ = events_.front().number;
        bytes_ -= events_.front().data->size();
        events_.pop_front();
      }
    } else {
      latest_[static_cast<std::size_t>(kind)] = message;
    }
  }
  something_came_.notify_all();
}

Hub::Batch Hub::wait(std::uint64_t after, std::chrono::milliseconds patience) {
  MutexLock lock(mutex_);
  something_came_.wait_for(lock, patience,
                           [&]() CULPRIT_REQUIRES(mutex_) { return is_closed_ || last_ > after; });
  return is_closed_ ? Batch{} : collect(after);
}

Hub::Batch Hub::collect(std::uint64_t after) const {
  Batch batch{after < forgotten_, {}};
  auto next = std::partition_point(events_.begin(), events_.end(),
                                   [&](const Message& m) { return m.number <= after; });
  for (; next != events_.end() && batch.messages.size() < kBatch; ++next)
    batch.messages.push_back(*next);
  // Where the batch had to stop, newer messages wait for the next: none may overtake an event.
  const std::uint64_t end = next == events_.end() ? last_ : batch.messages.back().number;
  for (const Message& message : latest_) {
    if (message.kind == Kind::kLearned) continue;
    if (message.number > after && message.number <= end) batch.messages.push_back(message);
  }
  std::sort(batch.messages.begin(), batch.messages.end(),
            [](const Message& a, const Message& b) { return a.number < b.number; });
  return batch;
}

std::shared_ptr<const std::string> Hub::latest(Kind kind) const {
  const MutexLock lock(mutex_);
  return latest_[static_cast<std::size_t>(kind)].data;
}

std::uint64_t Hub::last() const {
  const MutexLock lock(mutex_);
  return last_;
}

void Hub::close() {
  {
    const MutexLock lock(mutex_);
    is_closed_ = true;
  }
  something_came_.notify_all();
}

}  // namespace culprit::http
