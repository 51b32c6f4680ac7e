// Which alert is sent when, to one destination: the newest of each fault, those that need a person first; again
// after a while if it could not be sent; not too many in a time, and not more than are kept.
//
// Pure: the sender gives it the time, and the result of each attempt.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include "alerts/alert.h"
#include "base/time.h"
#include "base/units.h"

namespace culprit::alerts {

class Outbox {
 public:
  struct Limits {
    std::size_t kept = 64;                       // alerts that wait; beyond, the oldest is given up
    std::size_t burst = 10;                      // so many at once
    Duration refill = std::chrono::seconds(30);  // and then one each time this has passed
    Duration first_retry = std::chrono::seconds(1);  // doubled with each failure
    Duration longest_retry = std::chrono::minutes(5);
    std::optional<Duration> repeat{};  // what is not over is sent again; nothing: it is not
  };
  explicit Outbox(Limits limits) : limits_(limits), tokens_(limits.burst) {}

  // It replaces what waits about the same fault.
  void put(Alert alert, Time now);

  // The alert to be sent now; nothing: none. Until sent() or failed(), the same is given.
  std::optional<Alert> next(Time now);
  // When to look again; kNever: not before something is put.
  Time due() const;

  // The alert that next() returned last was sent. @pre it gave one
  void sent(Time now);
  // It was not. `is_final`: nor would it be at another try, and is given up. @pre likewise
  void failed(Time now, bool is_final);

  std::size_t waiting() const { return waiting_.size(); }
  // How many were given up, since it was asked last.
  std::uint64_t take_given_up() { return std::exchange(given_up_unsaid_, 0); }

 private:
  struct Repeated {
    Alert alert;
    Time due;
  };
  void refill(Time now);
  void give_up(std::deque<Alert>::iterator which);
  std::deque<Alert>::iterator first_to_send();

  const Limits limits_;
  std::deque<Alert> waiting_;
  std::map<std::string, Repeated> firing_;  // by fault: what was sent, if it is to be repeated
  std::optional<Alert> under_way_;
  Time retry_at_ = kLongAgo;
  int failures_ = 0;  // in a row
  std::size_t tokens_;
  Time refilled_ = kLongAgo;
  std::uint64_t untold_ = 0;  // given up since one was sent
  std::uint64_t given_up_unsaid_ = 0;
};

}  // namespace culprit::alerts
