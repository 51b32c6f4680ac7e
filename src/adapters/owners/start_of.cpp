#include "owners/start_of.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>

namespace culprit::owners {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> texts_of(const fs::path& file) {
  std::vector<std::string> all;
  std::ifstream in(file, std::ios::binary);
  for (std::string text; std::getline(in, text, '\0');) all.push_back(std::move(text));
  return all;
}

// The path by which a process named its program, if that still leads to `program`: an interpreter finds its packages by
// that path, as Python those of a virtual environment. Else `program` itself. A name alone depends on PATH, and a path on a
// folder.
std::string whole_path(const Started& started, const std::string& program) {
  const std::string& named = started.command.front();
  if (named.starts_with('/')) return named;
  std::vector<fs::path> places;
  if (named.find('/') != std::string::npos) {
    places.push_back((fs::path(started.folder) / named).lexically_normal());
  } else {
    constexpr std::string_view kPath = "PATH=";
    const auto path = std::ranges::find_if(
        started.environment, [&](const std::string& each) { return each.starts_with(kPath); });
    std::istringstream list(path == started.environment.end() ? "" : path->substr(kPath.size()));
    for (std::string folder; std::getline(list, folder, ':');) {
      if (folder.starts_with('/')) places.push_back(fs::path(folder) / named);
    }
  }
  const auto place = std::ranges::find_if(places, [&](const fs::path& each) {
    std::error_code error;
    return fs::canonical(each, error) == program && !error;
  });
  return place == places.end() ? program : place->native();
}

}  // namespace

std::optional<Started> start_of(int pid) {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/" + std::to_string(pid) + "/exe", error);
  if (error || program.native().ends_with(" (deleted)")) return std::nullopt;
  return started_as(pid);
}

std::optional<Started> started_as(int pid) {
  const fs::path process = "/proc/" + std::to_string(pid);
  Started started{texts_of(process / "cmdline"), texts_of(process / "environ"), {}};
  std::error_code error;
  std::string program = fs::read_symlink(process / "exe", error).native();
  if (error || started.command.empty()) return std::nullopt;
  constexpr std::string_view kDeleted = " (deleted)";
  if (program.ends_with(kDeleted)) program.resize(program.size() - kDeleted.size());
  started.folder = fs::read_symlink(process / "cwd", error);
  started.command.front() = whole_path(started, program);
  return started;
}

}  // namespace culprit::owners
