#include "owners/start_of.h"

#include <filesystem>
#include <fstream>
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
  // The program may read its own name, but a name alone depends on PATH, and a path on a folder.
  if (!started.command.front().starts_with('/')) started.command.front() = program;
  return started;
}

}  // namespace culprit::owners
