// How many more threads the control groups of this process allow (pids.max, cgroups(7)).
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace culprit::http {

// The least of all groups that it is in. Nothing: no group limits it, or none can be read. `groups`: as
// /proc/self/cgroup lists them; `mounted`: where they are.
std::optional<std::size_t> threads_left(const std::string& groups,
                                        const std::filesystem::path& mounted);
std::optional<std::size_t> threads_left();

}  // namespace culprit::http
