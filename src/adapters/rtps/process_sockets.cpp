#include "rtps/process_sockets.h"

#include <fstream>
#include <sstream>
#include <system_error>

namespace culprit::rtps {

namespace fs = std::filesystem;

std::optional<std::set<std::string>> descriptors_of(const fs::path& process) {
  std::error_code error;
  fs::directory_iterator files(process / "fd", error);
  if (error) return std::nullopt;
  std::set<std::string> links;
  while (!error && files != fs::directory_iterator()) {
    const fs::path target = fs::read_symlink(files->path(), error);
    if (!error) links.insert(target.native());
    files.increment(error);  // fails if the process went away meanwhile
  }
  return links;
}

std::optional<std::uint64_t> running_since(const fs::path& process) {
  std::ifstream file(process / "stat");
  std::string line;
  std::getline(file, line);
  const auto end = line.rfind(')');  // the command is in parentheses, and may hold anything
  if (end == std::string::npos || end + 2 >= line.size()) return std::nullopt;
  std::istringstream rest(line.substr(end + 2));
  std::string state;
  rest >> state;
  if (state == "Z" || state == "X") return std::nullopt;
  std::string skipped;
  for (int i = 0; i < 18; ++i) rest >> skipped;
  std::uint64_t ticks = 0;
  if (!(rest >> ticks)) return std::nullopt;
  return ticks;
}

}  // namespace culprit::rtps
