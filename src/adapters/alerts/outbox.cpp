#include "alerts/outbox.h"

#include <algorithm>

#include "base/invariant.h"

namespace culprit::alerts {

void Outbox::put(Alert alert, Time now) {
  const auto same = std::find_if(waiting_.begin(), waiting_.end(),
                                 [&](const Alert& each) { return each.id == alert.id; });
  if (const auto repeated = firing_.find(alert.id); repeated != firing_.end()) {
    repeated->second.alert = alert;
    if (alert.state == Alert::State::kResolved) firing_.erase(repeated);
  }
  if (same != waiting_.end()) {
    *same = std::move(alert);
  } else {
    waiting_.push_back(std::move(alert));
  }
  if (waiting_.size() > limits_.kept) {
    const auto unneeded = std::find_if(waiting_.begin(), waiting_.end(),
                                       [](const Alert& each) { return !each.needs_person; });
    give_up(unneeded == waiting_.end() ? waiting_.begin() : unneeded);
  }
  refill(now);
}

void Outbox::give_up(std::deque<Alert>::iterator which) {
  waiting_.erase(which);
  ++untold_;
  ++given_up_unsaid_;
}

void Outbox::refill(Time now) {
  if (refilled_ == kLongAgo || tokens_ >= limits_.burst) refilled_ = now;
  while (tokens_ < limits_.burst && now - refilled_ >= limits_.refill) {
    ++tokens_;
    refilled_ += limits_.refill;
  }
  if (tokens_ >= limits_.burst) refilled_ = now;
}

std::deque<Alert>::iterator Outbox::first_to_send() {
  const auto needed = std::find_if(waiting_.begin(), waiting_.end(),
                                   [](const Alert& each) { return each.needs_person; });
  return needed == waiting_.end() ? waiting_.begin() : needed;
}

std::optional<Alert> Outbox::next(Time now) {
  if (under_way_) return under_way_;
  refill(now);
  if (now < retry_at_) return std::nullopt;
  if (!waiting_.empty() && tokens_ > 0) {
    const auto first = first_to_send();
    under_way_ = std::move(*first);
    waiting_.erase(first);
    under_way_->untold = untold_;
    return under_way_;
  }
  for (auto& [id, repeated] : firing_) {
    if (repeated.due <= now) return under_way_ = repeated.alert;
  }
  return std::nullopt;
}

Time Outbox::due() const {
  if (under_way_) return kLongAgo;
  Time due = kNever;
  if (!waiting_.empty()) due = tokens_ > 0 ? kLongAgo : later(refilled_, limits_.refill);
  for (const auto& [id, repeated] : firing_) due = std::min(due, repeated.due);
  return due == kNever ? due : std::max(due, retry_at_);
}

void Outbox::sent(Time now) {
  CULPRIT_ASSERT(under_way_);
  Alert alert = *std::exchange(under_way_, std::nullopt);
  failures_ = 0;
  retry_at_ = kLongAgo;
  untold_ -= std::min(untold_, alert.untold);
  const bool is_repeated = firing_.contains(alert.id);
  if (!is_repeated) tokens_ -= std::min<std::size_t>(1, tokens_);
  if (!limits_.repeat) return;
  firing_.erase(alert.id);
  // A newer alert about it waits, which may say that it is over.
  if (alert.state == Alert::State::kResolved) return;
  firing_[alert.id] = {alert, later(now, *limits_.repeat)};
}

void Outbox::failed(Time now, bool is_final) {
  CULPRIT_ASSERT(under_way_);
  Alert alert = *std::exchange(under_way_, std::nullopt);
  if (is_final) {
    firing_.erase(alert.id);
    ++untold_;
    ++given_up_unsaid_;
    return;
  }
  const Duration wait = limits_.first_retry * (std::int64_t{1} << std::min(failures_, 20));
  retry_at_ = later(now, std::min(wait, limits_.longest_retry));
  ++failures_;
  if (const auto repeated = firing_.find(alert.id); repeated != firing_.end()) {
    repeated->second.due = retry_at_;
    return;
  }
  const bool is_superseded = std::any_of(waiting_.begin(), waiting_.end(),
                                         [&](const Alert& each) { return each.id == alert.id; });
  if (!is_superseded) waiting_.push_front(std::move(alert));
}

}  // namespace culprit::alerts
