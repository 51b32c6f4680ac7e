// Which sockets a process of this machine holds, as the kernel's tables show (proc(5)):
// /proc/<pid>/fd and /proc/<pid>/stat. Files of another user's process are visible only with
// CAP_SYS_PTRACE.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>

namespace culprit::rtps {

// The targets of its open files: "socket:[12345]". Nothing: there is no such process, or its files
// are not readable. A process that is just ending may have closed them already.
std::optional<std::set<std::string>> descriptors_of(const std::filesystem::path& process);

// When it began, in ticks since the machine was started. Nothing: there is no such process, or it has
// ended and was not reaped.
std::optional<std::uint64_t> running_since(const std::filesystem::path& process);

}  // namespace culprit::rtps
