// The share of a topic's messages that was lost on the way here, over the last seconds.
//
// RTPS sequence numbers show how many messages the publisher sent since the previous one:
//
//     loss = 1 - received / sent
//
// Both are counted in two spans of kSpan, the present one and the one before: the share covers the last kSpan
// to 2 kSpan. A share of few messages says little: it is unknown until kLeast were sent. It is unknown, too, while culprit
// itself may have dropped some of those that are missing.
#pragma once

#include <cstdint>
#include <optional>

#include "base/time.h"

namespace culprit::monitor {

class LossMeter {
 public:
  static constexpr Duration kSpan = std::chrono::seconds(5);
  static constexpr std::uint64_t kLeast = 10;

  // A message came; `sent`: since the one before, this one included, at least 1. `lost_here`: we may have dropped some.
  void add(Time at, std::uint32_t sent, bool lost_here = false) {
    turn(at);
    present_.lost_here = present_.lost_here || lost_here;
    present_.sent += sent > 0 ? sent : 1;
    ++present_.received;
  }
  // Forgets all losses before `now`.
  void restart(Time now) {
    present_ = before_ = {};
    begun_ = now;
  }
  std::optional<double> share(Time now) {
    turn(now);
    return present_.lost_here || before_.lost_here ? std::nullopt : share_with_ours(now);
  }
  // Whoever lost them.
  std::optional<double> share_with_ours(Time now) {
    turn(now);
    const std::uint64_t sent = present_.sent + before_.sent;
    if (sent < kLeast) return std::nullopt;
    const std::uint64_t received = present_.received + before_.received;
    return 1 - static_cast<double>(received) / static_cast<double>(sent);
  }
  // How large the loss may be that shows this share of few messages, whoever lost them; 0 where none was lost, or too few
  // were sent. Example: 50 messages, one lost: 7.5 %.
  double at_most(Time now) {
    constexpr double kPrior = 3;
    const auto known = share_with_ours(now);
    if (!known || *known <= 0) return 0;
    const auto sent = static_cast<double>(present_.sent + before_.sent);
    return (*known * sent + kPrior) / (sent + kPrior);
  }
  // When the share becomes another, if no message comes.
  Time changes() const { return present_.sent + before_.sent == 0 ? kNever : later(begun_, kSpan); }

 private:
  struct Counts {
    std::uint64_t sent = 0;
    std::uint64_t received = 0;
    bool lost_here = false;
  };
  void turn(Time now) {
    if (now < later(begun_, kSpan)) return;
    before_ = now < later(begun_, 2 * kSpan) ? present_ : Counts{};
    present_ = {};
    begun_ = now < later(begun_, 2 * kSpan) ? later(begun_, kSpan) : now;
  }

  Time begun_ = kLongAgo;  // the present span
  Counts present_;
  Counts before_;
};

}  // namespace culprit::monitor
