// The command that prints curves of a journal: what POST /api/series/past runs aside.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace culprit::web {

// `since` and `until` are seconds before now; below 0: now. The names come from a page, and none is an option.
std::vector<std::string> replay_of_curves(const std::filesystem::path& program,
                                          const std::filesystem::path& journal, double since,
                                          double until, const std::vector<std::string>& names);

}  // namespace culprit::web
