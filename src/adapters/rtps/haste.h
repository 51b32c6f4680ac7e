// Whether what comes is awaited, or may be read a little later together with other things
// (receive_thread.h), since to wake a thread for each is most of what hearing it costs.
#pragma once

#include <cstdint>

namespace culprit::ros2 {

enum class Haste : std::uint8_t { kNow, kSoon };

}  // namespace culprit::ros2
