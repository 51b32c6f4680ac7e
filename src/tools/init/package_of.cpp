#include "init/package_of.h"

#include <algorithm>
#include <filesystem>

namespace culprit::init {
namespace {

// lib/<package>/<program>
std::string package_of_program(const std::filesystem::path& program) {
  const std::filesystem::path folder = program.parent_path();
  if (!program.is_absolute() || folder.parent_path().filename() != "lib") return "";
  return folder.filename().string();
}

}  // namespace

std::string package_of(const std::vector<std::string>& command) {
  constexpr std::size_t kLooked = 2;  // the program, or an interpreter and its script
  for (std::size_t i = 0; i < std::min(command.size(), kLooked); ++i) {
    if (std::string package = package_of_program(command[i]); !package.empty()) return package;
  }
  return "";
}

}  // namespace culprit::init
