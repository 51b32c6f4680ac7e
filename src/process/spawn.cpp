#include "process/spawn.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <pthread.h>
#include <sstream>
#include <string_view>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>

#include "process/file_descriptor.h"

extern char** environ;

namespace culprit::process {
namespace {

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

// All that is needed from fork() to execve(). After the fork of a program with threads only system
// calls are safe, on what was made ready before.
struct Launch {
  const char* path;
  const char* log;
  char* const* arguments;
  char* const* environment;
  char* pid_digits;  // where the pid's are to be written; null: nowhere
};
constexpr std::size_t kPidDigits = 10;

void write_pid(char* digits) {
  int pid = getpid();
  std::size_t count = 1;
  for (int rest = pid / 10; rest > 0; rest /= 10) ++count;
  for (std::size_t i = count; i-- > 0; pid /= 10) digits[i] = static_cast<char>('0' + pid % 10);
  digits[count] = '\0';
}

void reset_signals() {
  struct sigaction otherwise {};
  otherwise.sa_handler = SIG_DFL;
  for (int number = 1; number < NSIG; ++number) sigaction(number, &otherwise, nullptr);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
}

bool redirect(const char* log) {
  const int input = open("/dev/null", O_RDONLY);
  const int output = open(log, O_WRONLY | O_CREAT | O_APPEND, 0644);
  return input >= 0 && output >= 0 && dup2(input, STDIN_FILENO) >= 0 &&
         dup2(output, STDOUT_FILENO) >= 0 && dup2(output, STDERR_FILENO) >= 0;
}

// Where the child says why it failed; closed by a successful execve().
constexpr int kReport = STDERR_FILENO + 1;

// In the child. Comes back only if it fails; then errno says why.
void become(const Launch& launch, int report) {
  if (report != kReport && dup3(report, kReport, O_CLOEXEC) < 0) return;
  setsid();
  prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0);
  if (!redirect(launch.log)) return;
  // Our DDS sockets are not marked close-on-exec; a child that kept one would keep its port.
  closefrom(kReport + 1);
  if (launch.pid_digits != nullptr) write_pid(launch.pid_digits);
  reset_signals();
  execve(launch.path, launch.arguments, launch.environment);
}

// Gives the pid, or minus the number of the error.
int start(const Launch& launch) {
  std::array<int, 2> report{};
  if (pipe2(report.data(), O_CLOEXEC) != 0) return -errno;
  const FileDescriptor read_end(report[0]);
  FileDescriptor write_end(report[1]);
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);  // no handler of ours runs in the child
  const pid_t pid = fork();
  if (pid == 0) {
    become(launch, write_end.get());
    const int why = errno;
    [[maybe_unused]] const auto written = write(kReport, &why, sizeof why);
    _exit(127);
  }
  const int fork_error = errno;
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (pid < 0) return -fork_error;
  write_end = FileDescriptor();
  int why = 0;
  ssize_t size = 0;
  do size = read(read_end.get(), &why, sizeof why);
  while (size < 0 && errno == EINTR);
  if (size != sizeof why) return pid;
  waitpid(pid, nullptr, 0);
  return -why;
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

  std::vector<std::string> arguments = program.arguments;
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  std::vector<std::string> added = program.environment;
  if (!program.pid_variable.empty())
    added.push_back(program.pid_variable + "=" + std::string(kPidDigits + 1, '\0'));
  const std::vector<char*> environment = environment_with(added);
  char* digits =
      program.pid_variable.empty() ? nullptr : &added.back()[program.pid_variable.size() + 1];
  const int pid =
      start({path->c_str(), program.log.c_str(), argv.data(), environment.data(), digits});
  if (pid > 0) return pid;
  const bool log_fails =
      access(program.log.parent_path().empty() ? "." : program.log.parent_path().c_str(), W_OK) !=
      0;
  return Error{"cannot start '" + path->string() + "': " + std::strerror(-pid) +
               (log_fails ? " (its log " + program.log.string() + " cannot be written)" : "")};
}

}  // namespace culprit::process
