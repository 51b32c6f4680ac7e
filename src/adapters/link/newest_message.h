// The newest message of a topic, as bytes. One that is too large is not kept: the one before it stays.
#pragma once

#include <cstdint>
#include <string>

#include "base/time.h"
#include "ros2/participant.h"

namespace culprit::link {

struct NewestMessage {
  std::string topic;
  rtps::Bytes payload;
  Time at{};
  std::uint64_t number = 0;  // 0: none came
  std::size_t refused = 0;   // bytes of the one that came last, if it was too large

  // Numbers it with the next one of `messages`, if it has at most `most` bytes.
  void keep(const std::string& from, rtps::ByteView bytes, std::size_t most, Time now,
            std::uint64_t& messages) {
    refused = bytes.size() <= most ? 0 : bytes.size();
    if (refused > 0) return;
    topic = from;
    payload.assign(bytes.begin(), bytes.end());
    at = now;
    number = ++messages;
  }
};

}  // namespace culprit::link
