// How many samples each writer of a topic wrote since its last one that came here, by RTPS sequence numbers.
//
// Those between were lost on the way, or our own full sockets dropped them: that is possible if datagrams were dropped
// meanwhile. Pure: each question brings how many were dropped so far (ReceiveThread).
#pragma once

#include <cstdint>
#include <unordered_map>
#include <utility>

#include "rtps/guid.h"

namespace culprit::ros2 {

class SampleGaps {
 public:
  struct Step {
    std::uint32_t published = 1;  // this one included
    bool lost_here = false;       // we may have dropped some of them
  };

  Step next(const rtps::Guid& writer, std::int64_t sequence, std::uint64_t dropped_here) {
    constexpr std::size_t kMaxWriters = 1000;  // the network decides how many there are
    constexpr std::int64_t kMaxGap = 1000;     // a larger one is a restart or a lie
    if (last_.size() >= kMaxWriters) last_.clear();
    const auto [last, is_new] = last_.try_emplace(writer);
    const Last before = std::exchange(last->second, {sequence, dropped_here});
    std::int64_t gap = 0;
    const bool overflows = __builtin_sub_overflow(sequence, before.sequence, &gap);
    if (is_new || overflows || gap <= 1 || gap > kMaxGap) return {};
    return {static_cast<std::uint32_t>(gap), dropped_here != before.dropped_here};
  }

 private:
  struct Last {
    std::int64_t sequence = 0;
    std::uint64_t dropped_here = 0;  // before it
  };
  std::unordered_map<rtps::Guid, Last> last_;  // by writer
};

}  // namespace culprit::ros2
