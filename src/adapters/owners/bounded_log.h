// Keeps the logs of started processes from filling the disk.
#pragma once

#include <cstdint>
#include <filesystem>

namespace culprit::owners {

inline constexpr std::uintmax_t kMostOfLog = std::uintmax_t{4} << 20;  // bytes

// Once `log` is larger than that, its end becomes <log>.1, in place of an older one, and `log` is
// emptied. The writer must append (O_APPEND), and goes on in the same file: a pipe would break when
// culprit exits. Lines that are written between the copy and the truncation may be lost.
void bound_log(const std::filesystem::path& log);

}  // namespace culprit::owners
