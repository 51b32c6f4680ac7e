#include "process/spawn.h"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <spawn.h>
#include <sstream>
#include <string_view>
#include <system_error>
#include <unistd.h>

extern char** environ;

namespace culprit::process {
namespace {

class FileActions {
 public:
  FileActions() { posix_spawn_file_actions_init(&actions_); }
  ~FileActions() { posix_spawn_file_actions_destroy(&actions_); }
  FileActions(const FileActions&) = delete;
  posix_spawn_file_actions_t* get() { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_;
};

class Attributes {
 public:
  Attributes() { posix_spawnattr_init(&attributes_); }
  ~Attributes() { posix_spawnattr_destroy(&attributes_); }
  Attributes(const Attributes&) = delete;
  posix_spawnattr_t* get() { return &attributes_; }

 private:
  posix_spawnattr_t attributes_;
};

bool is_executable(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error) && access(path.c_str(), X_OK) == 0;
}

// What is inherited, without what `added` has a value for, and `added`.
std::vector<char*> environment_with(std::vector<std::string>& added) {
  std::vector<char*> all;
  for (char** each = environ; *each != nullptr; ++each) {
    const std::string_view variable(*each);
    const std::string_view name = variable.substr(0, variable.find('=') + 1);
    const bool is_replaced = std::any_of(added.begin(), added.end(),
                                         [&](const std::string& a) { return a.starts_with(name); });
    if (!is_replaced) all.push_back(*each);
  }
  for (std::string& each : added) all.push_back(each.data());
  all.push_back(nullptr);
  return all;
}

}  // namespace

Expected<std::filesystem::path> find_program(
    const std::string& name, const std::vector<std::filesystem::path>& search_first) {
  if (name.find('/') != std::string::npos) {
    if (is_executable(name)) return std::filesystem::path(name);
    return Error{"there is no program '" + name + "', or it is not executable"};
  }
  std::vector<std::filesystem::path> folders = search_first;
  if (const char* path = std::getenv("PATH")) {
    std::istringstream list(path);
    for (std::string folder; std::getline(list, folder, ':');)
      folders.emplace_back(folder.empty() ? "." : folder);
  }
  for (const auto& folder : folders) {
    if (is_executable(folder / name)) return folder / name;
  }
  return Error{"there is no program '" + name + "' in PATH"};
}

Expected<int> spawn(const Program& program) {
  if (program.arguments.empty()) return Error{"the launch command is empty"};
  const auto path = find_program(program.arguments.front(), program.search_first);
  if (!path) return Error{path.error()};
  std::error_code error;
  if (program.log.has_parent_path())
    std::filesystem::create_directories(program.log.parent_path(), error);

  FileActions files;
  posix_spawn_file_actions_addopen(files.get(), STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(files.get(), STDOUT_FILENO, program.log.c_str(),
                                   O_WRONLY | O_CREAT | O_APPEND, 0644);
  posix_spawn_file_actions_adddup2(files.get(), STDOUT_FILENO, STDERR_FILENO);
  // Our DDS sockets are not marked close-on-exec; a child that kept one would keep its port.
  posix_spawn_file_actions_addclosefrom_np(files.get(), STDERR_FILENO + 1);

  Attributes attributes;
  sigset_t none;
  sigset_t all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(attributes.get(), &none);
  posix_spawnattr_setsigdefault(attributes.get(), &all);
  posix_spawnattr_setflags(attributes.get(),
                           POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);

  std::vector<std::string> arguments = program.arguments;
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  std::vector<std::string> added = program.environment;
  const std::vector<char*> environment = environment_with(added);
  pid_t pid = 0;
  const int failed = posix_spawn(&pid, path->c_str(), files.get(), attributes.get(), argv.data(),
                                 environment.data());
  if (failed == 0) return static_cast<int>(pid);
  const bool log_fails =
      access(program.log.parent_path().empty() ? "." : program.log.parent_path().c_str(), W_OK) !=
      0;
  return Error{"cannot start '" + path->string() + "': " + std::strerror(failed) +
               (log_fails ? " (its log " + program.log.string() + " cannot be written)" : "")};
}

}  // namespace culprit::process
