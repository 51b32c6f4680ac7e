// Whether a message is awaited, or may be read a little later together with others
// (receive_thread.h). Waking a thread for each message would be most of the cost of receiving it.
#pragma once

#include <cstdint>

namespace culprit::rtps {

enum class Haste : std::uint8_t { kNow, kSoon };

}  // namespace culprit::rtps
