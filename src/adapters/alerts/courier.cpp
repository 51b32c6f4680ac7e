#include "alerts/courier.h"

#include <algorithm>
#include <atomic>
#include <system_error>
#include <thread>

#include <fmt/core.h>

#include "alerts/sender.h"
#include "base/live_clock.h"
#include "base/mutex.h"

namespace culprit::alerts {
namespace {

using namespace std::chrono_literals;

constexpr Duration kPatience = 10s;
// Both together end before culprit is ended the hard way (cli/run_command.cpp).
constexpr Duration kLastMoment = 1500ms;
constexpr Duration kAfterThat = 500ms;

Outbox::Limits limits_for(const Destination& destination) {
  Outbox::Limits limits;
  // Alertmanager resolves an alert that is not repeated within five minutes (resolve_timeout).
  if (destination.kind == Destination::Kind::kAlertmanager) limits.repeat = 1min;
  return limits;
}

}  // namespace

// One destination. Its thread holds on to it, for it may hang in the resolver beyond the end of the courier.
class Courier::Route : public std::enable_shared_from_this<Route> {
 public:
  Route(Destination destination, std::function<void(const std::string&)> tell)
      : destination_(std::move(destination)),
        tell_(std::move(tell)),
        outbox_(limits_for(destination_)) {}

  void begin() {
    try {
      std::thread([self = shared_from_this()] { self->deliver(); }).detach();
    } catch (const std::system_error& no_thread) {
      tell_("no alert can be sent to " + destination_.name() + ": " + no_thread.what());
      const MutexLock lock(mutex_);
      is_over_ = true;
    }
  }

  void post(const Alert& alert) {
    if (destination_.only_for_person && !alert.needs_person) return;
    {
      const MutexLock lock(mutex_);
      outbox_.put(alert, live_now());
    }
    something_came_.notify_all();
  }

  void end() {
    const MutexLock lock(mutex_);
    end_ = live_now() + kLastMoment;
    something_came_.notify_all();
  }
  void await_end() {
    MutexLock lock(mutex_);
    const auto is_over = [this]() CULPRIT_REQUIRES(mutex_) { return is_over_; };
    if (something_came_.wait_for(lock, kLastMoment, is_over)) return;
    stop_ = true;
    something_came_.wait_for(lock, kAfterThat, is_over);
  }

 private:
  void deliver() {
    MutexLock lock(mutex_);
    while (true) {
      const auto alert = outbox_.next(live_now());
      if (is_to_end(alert.has_value())) break;
      if (!alert) {
        wait(lock);
        continue;
      }
      lock.unlock();
      const Sent sent = send(destination_, *alert, kPatience, stop_);
      lock.lock();
      say(note(sent), lock);
    }
    if (const std::size_t left = outbox_.waiting(); left > 0)
      say({fmt::format("{} alerts were not sent to {}", left, destination_.name())}, lock);
    is_over_ = true;
    something_came_.notify_all();
  }

  bool is_to_end(bool has_more) CULPRIT_REQUIRES(mutex_) {
    return end_ != kNever && (!has_more || live_now() >= end_);
  }

  void wait(MutexLock& lock) CULPRIT_REQUIRES(mutex_) {
    if (outbox_.due() == kNever) return something_came_.wait(lock);
    // Also of a time that is far: it is looked again.
    const Duration left = std::clamp<Duration>(outbox_.due() - live_now(), 1ms, 1min);
    something_came_.wait_for(lock, left);
  }

  // Returns the messages about it.
  std::vector<std::string> note(const Sent& sent) CULPRIT_REQUIRES(mutex_) {
    using How = Sent::How;
    std::vector<std::string> news;
    const bool was_in_trouble = std::exchange(is_in_trouble_, sent.how == How::kNotNow);
    if (sent.how == How::kSent) {
      outbox_.sent(live_now());
      if (was_in_trouble) news.push_back("alerts reach " + destination_.name() + " again");
    } else {
      outbox_.failed(live_now(), sent.how == How::kNever);
      if (sent.how == How::kNever || !was_in_trouble)
        news.push_back(fmt::format("an alert is not sent to {}: {}{}", destination_.name(),
                                   sent.why, sent.how == How::kNever ? "" : "; it is tried again"));
    }
    const auto given_up = outbox_.take_given_up();
    if (given_up > 0 && sent.how != How::kNever)
      news.push_back(fmt::format("{} alerts for {} were given up: too many wait", given_up,
                                 destination_.name()));
    return news;
  }

  // Without the lock: the callback may take its time.
  void say(const std::vector<std::string>& news, MutexLock& lock) CULPRIT_NOT_ANALYZED {
    lock.unlock();
    for (const std::string& each : news) tell_(each);
    lock.lock();
  }

  const Destination destination_;
  const std::function<void(const std::string&)> tell_;
  std::atomic<bool> stop_ = false;
  Mutex mutex_;
  ConditionVariable something_came_;
  Outbox outbox_ CULPRIT_GUARDED_BY(mutex_);
  Time end_ CULPRIT_GUARDED_BY(mutex_) = kNever;
  bool is_over_ CULPRIT_GUARDED_BY(mutex_) = false;
  bool is_in_trouble_ CULPRIT_GUARDED_BY(mutex_) = false;
};

Courier::Courier(std::vector<Destination> destinations,
                 std::function<void(const std::string&)> tell) {
  for (Destination& each : destinations) {
    routes_.push_back(std::make_shared<Route>(std::move(each), tell));
    routes_.back()->begin();
  }
}

Courier::~Courier() {
  for (const auto& route : routes_) route->end();
  for (const auto& route : routes_) route->await_end();
}

void Courier::post(const Alert& alert) {
  for (const auto& route : routes_) route->post(alert);
}

}  // namespace culprit::alerts
