#include "web/replay_of_curves.h"

#include <algorithm>
#include <cstdint>

namespace culprit::web {

std::vector<std::string> replay_of_curves(const std::filesystem::path& program,
                                          const std::filesystem::path& journal, double since,
                                          double until, const std::vector<std::string>& names) {
  const auto ago = [](double seconds) {
    return std::to_string(static_cast<std::int64_t>(std::max(0.0, seconds) * 1000)) + "ms";
  };
  std::vector<std::string> command = {program.string(), "replay",   journal.string(), "--json",
                                      "--since",        ago(since), "--until",        ago(until)};
  // In one word: a name that begins with hyphens is no option.
  for (const std::string& name : names) command.push_back("--curve=" + name);
  return command;
}

}  // namespace culprit::web
