// How often the calling thread has allocated memory so far.
#pragma once

#include <cstdint>

namespace culprit::bench {

std::uint64_t allocations();

}  // namespace culprit::bench
