#include "recorder/message_ring.h"

#include <algorithm>

namespace culprit::recorder {

void MessageRing::drop_front(Part& part) {
  const RingMessage& oldest = *part.messages.front();
  if (oldest.at >= counts_since_ && oldest.number > taken_) ++lost_;
  part.bytes -= size_of(oldest);
  part.messages.pop_front();
}

void MessageRing::push(RingMessage message, Share share) {
  const std::size_t size = size_of(message);
  const std::size_t room = share == Share::kSmall ? limits_.small_bytes : limits_.large_bytes;
  const Time oldest = message.at - limits_.keep;
  auto shared = std::make_shared<RingMessage>(std::move(message));
  const MutexLock lock(mutex_);
  shared->number = ++last_;
  // Old messages go from both parts: one of them may get none for long.
  for (Part& part : parts_) {
    while (!part.messages.empty() && part.messages.front()->at < oldest) drop_front(part);
  }
  Part& part = parts_[static_cast<std::size_t>(share)];
  if (size > room) {
    if (shared->at >= counts_since_) ++lost_;
    return;
  }
  while (part.bytes + size > room) drop_front(part);
  part.bytes += size;
  part.messages.push_back(std::move(shared));
}

void MessageRing::latch(RingMessage message, const rtps::Guid& publisher) {
  const std::size_t size = size_of(message);
  const std::pair key(message.topic, publisher);
  auto shared = std::make_shared<const RingMessage>(std::move(message));
  const MutexLock lock(mutex_);
  const auto before = latched_.find(key);
  const std::size_t freed = before == latched_.end() ? 0 : size_of(*before->second);
  if (latched_bytes_ - freed + size > limits_.latched_bytes) return;
  latched_bytes_ += size - freed;
  latched_.insert_or_assign(key, std::move(shared));
}

std::vector<SharedMessage> MessageRing::after(std::uint64_t number, Time since,
                                              std::size_t most_bytes) {
  const auto begin_in = [number](const Part& part) {
    return std::upper_bound(
        part.messages.begin(), part.messages.end(), number,
        [](std::uint64_t wanted, const SharedMessage& m) { return wanted < m->number; });
  };
  std::vector<SharedMessage> all;
  std::size_t bytes = 0;
  const MutexLock lock(mutex_);
  auto small = begin_in(parts_[0]);
  auto large = begin_in(parts_[1]);
  const auto small_end = parts_[0].messages.end();
  const auto large_end = parts_[1].messages.end();
  while (bytes < most_bytes && (small != small_end || large != large_end)) {
    const bool is_small =
        large == large_end || (small != small_end && (*small)->number < (*large)->number);
    const SharedMessage& next = is_small ? *small++ : *large++;
    taken_ = next->number;
    if (next->at < since) continue;
    bytes += size_of(*next);
    all.push_back(next);
  }
  return all;
}

std::vector<SharedMessage> MessageRing::latched(Time since) const {
  std::vector<SharedMessage> all;
  const MutexLock lock(mutex_);
  for (const auto& [key, message] : latched_) {
    if (message->at < since) all.push_back(message);
  }
  std::ranges::sort(all, {}, [](const SharedMessage& m) { return m->at; });
  return all;
}

void MessageRing::count_lost(Time since) {
  const MutexLock lock(mutex_);
  counts_since_ = since;
  taken_ = 0;
  lost_ = 0;
}

std::uint64_t MessageRing::stop_counting() {
  const MutexLock lock(mutex_);
  counts_since_ = kNever;
  return lost_;
}

std::size_t MessageRing::bytes(Share share) const {
  const MutexLock lock(mutex_);
  return parts_[static_cast<std::size_t>(share)].bytes;
}

std::size_t MessageRing::latched_bytes() const {
  const MutexLock lock(mutex_);
  return latched_bytes_;
}

}  // namespace culprit::recorder
