#include "owners/spawn.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <sstream>
#include <string_view>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>
#include <utility>

#include "base/begin_program.h"
#include "base/invariant.h"

extern char** environ;

namespace culprit::owners {
namespace {

// Where the program may be, in the order of looking.
std::vector<std::string> places_of(const Program& program) {
  const std::string& name = program.arguments.front();
  if (name.find('/') != std::string::npos) return {name};
  std::vector<std::string> places;
  for (const auto& folder : program.search_first) places.push_back((folder / name).native());
  std::istringstream list(value_in_environment("PATH", program.environment));
  for (std::string folder; std::getline(list, folder, ':');)
    places.push_back((folder.empty() ? "." : folder) + "/" + name);
  return places;
}

constexpr mode_t kAsItIs = ~mode_t{0};
mode_t umask_of_programs = kAsItIs;  // written before there are threads

// All that is needed from fork() to execve(). After the fork of a program with threads only system
// calls are safe, on what was made ready before.
struct Preparation {
  char* const* places;
  const char* log;
  const char* folder;  // to run in; null: as it is
  char* const* arguments;
  char* const* environment;
  char* const* const* needs;  // of each need its places
  char* pid_digits;           // where the pid's are to be written; null: nowhere
  int kept;
  Until until;
  pid_t ends_with;  // the process whose end ends it; 0: none
  mode_t mask;
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

// Culprit's service is spared when memory runs out (OOMScoreAdjust=); the processes that it starts
// are not.
void be_spared_no_more() {
  const int file = open("/proc/self/oom_score_adj", O_RDWR | O_CLOEXEC);
  if (file < 0) return;
  char first = 0;
  if (read(file, &first, 1) == 1 && first == '-' && lseek(file, 0, SEEK_SET) == 0) {
    [[maybe_unused]] const auto written = write(file, "0", 1);
  }
  close(file);
}

bool redirect(const char* log) {
  const int input = open("/dev/null", O_RDONLY);
  const int output = open(log, O_WRONLY | O_CREAT | O_APPEND, 0600);
  // An older culprit's may be open to readers. A device is everybody's: it stays as it is.
  struct stat log_status {};
  if (output >= 0 && fstat(output, &log_status) == 0 && S_ISREG(log_status.st_mode))
    fchmod(output, S_IRUSR | S_IWUSR);
  return input >= 0 && output >= 0 && dup2(input, STDIN_FILENO) >= 0 &&
         dup2(output, STDOUT_FILENO) >= 0 && dup2(output, STDERR_FILENO) >= 0;
}

const char* first_readable(char* const* places) {
  for (; *places != nullptr; ++places) {
    if (access(*places, R_OK) == 0) return *places;
  }
  return nullptr;
}

// A modification time in the future proves nothing: the clock was set back.
bool is_being_written(const char* path) {
  struct stat status {};
  if (stat(path, &status) != 0) return true;
  const std::int64_t age = time(nullptr) - std::int64_t{status.st_mtime};
  return age >= 0 && age <= Launch::kSettles;
}

const char* first_executable(char* const* places) {
  for (; *places != nullptr; ++places) {
    struct stat status {};
    if (stat(*places, &status) == 0 && S_ISREG(status.st_mode) && access(*places, X_OK) == 0)
      return *places;
  }
  return nullptr;
}

// Checks a script as execve() would: whether the program that its first line names can be run. Sets
// errno.
bool has_interpreter(const char* path) {
  std::array<char, 256> line{};
  const int file = open(path, O_RDONLY | O_CLOEXEC);
  if (file < 0) return true;  // it may be executable and not readable
  const ssize_t size = read(file, line.data(), line.size() - 1);
  close(file);
  if (size < 3 || line[0] != '#' || line[1] != '!') return true;
  char* begin = line.data() + 2;
  while (*begin == ' ' || *begin == '\t') ++begin;
  char* end = begin;
  while (*end != '\0' && *end != ' ' && *end != '\t' && *end != '\n') ++end;
  *end = '\0';
  return access(begin, X_OK) == 0;
}

// The child's report why it failed; closed by a successful execve(). The descriptors that it keeps
// are beside it.
constexpr int kReport = STDERR_FILENO + 1;
constexpr int kKept = kReport + 1;

enum class Step : std::int32_t { kPrepare, kFind, kOpenLog, kEnterFolder, kNeed, kRun };
struct Failure {
  Step step;
  std::int32_t why;        // errno
  std::int32_t which = 0;  // of kNeed
};

bool is_of_missing(const Failure& failure) {
  const bool is_absent = failure.why == ENOENT || failure.why == ENOTDIR;
  switch (failure.step) {
    case Step::kFind:
    case Step::kNeed:
      return true;
    case Step::kEnterFolder:
      return is_absent;
    case Step::kRun:
      return is_absent || failure.why == ETXTBSY;
    case Step::kPrepare:
    case Step::kOpenLog:
      break;
  }
  return false;
}

// In the child. Comes back only if it fails, or if it is not to be run.
Failure become(const Preparation& ready, int report) {
  // Neither may be in the other's place.
  const int kept = ready.kept < 0 ? -1 : fcntl(ready.kept, F_DUPFD_CLOEXEC, kKept + 1);
  if (ready.kept >= 0 && kept < 0) return {Step::kPrepare, errno};
  if (report != kReport && dup3(report, kReport, O_CLOEXEC) < 0) return {Step::kPrepare, errno};
  if (kept >= 0 && dup3(kept, kKept, O_CLOEXEC) < 0) return {Step::kPrepare, errno};
  setsid();
  if (ready.ends_with != 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != ready.ends_with) _exit(127);  // it exited before the request took effect
  }
  prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0);
  // Our DDS sockets are not marked close-on-exec; a child that kept one would keep its port.
  closefrom(kept >= 0 ? kKept + 1 : kReport + 1);
  if (!redirect(ready.log)) return {Step::kOpenLog, errno};
  closefrom(kept >= 0 ? kKept + 1 : kReport + 1);
  be_spared_no_more();
  if (ready.mask != kAsItIs) umask(ready.mask);
  if (ready.folder != nullptr && chdir(ready.folder) != 0) return {Step::kEnterFolder, errno};
  const char* path = first_executable(ready.places);
  if (path == nullptr) return {Step::kFind, ENOENT};
  bool is_written = ready.until == Until::kItIsReady && is_being_written(path);
  for (std::int32_t need = 0; ready.needs[need] != nullptr; ++need) {
    const char* file = first_readable(ready.needs[need]);
    if (file == nullptr) return {Step::kNeed, ENOENT, need};
    is_written |= ready.until == Until::kItIsReady && is_being_written(file);
  }
  if (is_written) return {Step::kRun, ETXTBSY};
  if (ready.until != Until::kItRuns) return {Step::kRun, has_interpreter(path) ? 0 : errno};
  if (ready.pid_digits != nullptr) write_pid(ready.pid_digits);
  reset_signals();
  execve(path, ready.arguments, ready.environment);
  return {Step::kRun, errno};
}

std::string description(const Failure& failure, const std::string& name,
                        const std::filesystem::path& log, const std::filesystem::path& folder,
                        const std::vector<std::string>& needs) {
  if (failure.step == Step::kNeed) return needs[static_cast<std::size_t>(failure.which)];
  if (failure.step == Step::kFind)
    return "there is no program '" + name + "'" +
           (name.find('/') == std::string::npos ? " in PATH" : ", or it is not executable");
  const std::string why = std::strerror(failure.why);
  if (failure.step == Step::kOpenLog)
    return "cannot start '" + name + "': its log " + log.string() + " cannot be written: " + why;
  if (failure.step == Step::kEnterFolder)
    return "cannot start '" + name + "': its folder " + folder.string() +
           " cannot be entered: " + why;
  return "cannot start '" + name + "': " + why;
}

}  // namespace

std::string value_in_environment(const std::string& variable,
                                 const std::vector<std::string>& added) {
  for (const std::string& each : added) {
    if (each.starts_with(variable + "=")) return each.substr(variable.size() + 1);
  }
  const char* own = std::getenv(variable.c_str());
  return own == nullptr ? "" : own;
}

void keep_files_private() { umask_of_programs = umask(S_IRWXG | S_IRWXO); }

std::vector<std::string> environment_with(const std::vector<std::string>& added) {
  std::vector<std::string> all;
  for (char** each = environ; *each != nullptr; ++each) {
    const std::string_view variable(*each);
    const std::string_view name = variable.substr(0, variable.find('=') + 1);
    const bool is_replaced = std::any_of(added.begin(), added.end(),
                                         [&](const std::string& a) { return a.starts_with(name); });
    if (!is_replaced) all.emplace_back(variable);
  }
  all.insert(all.end(), added.begin(), added.end());
  return all;
}

namespace {

// The new process becomes the program, or reports why it cannot. Minus the error number where there is none.
pid_t fork_into(const Preparation& ready, int report) {
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);  // no handler of ours runs in the child
  const pid_t pid = fork();
  if (pid == 0) {
    const Failure failure = become(ready, report);
    if (failure.why != 0) {
      [[maybe_unused]] const auto written = write(kReport, &failure, sizeof failure);
    }
    _exit(127);
  }
  const int why = errno;
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return pid < 0 ? -why : pid;
}

}  // namespace

Expected<Launch> Launch::begin(const Program& program, Until until) {
  if (program.arguments.empty()) return Error{"the launch command is empty"};
  std::error_code error;
  if (program.log.has_parent_path())
    std::filesystem::create_directories(program.log.parent_path(), error);

  std::vector<std::string> arguments = program.arguments;
  std::vector<std::string> places = places_of(program);
  std::vector<std::string> variables = environment_with(program.environment);
  if (!program.pid_variable.empty()) {
    std::erase_if(variables, [&](const std::string& each) {
      return each.starts_with(program.pid_variable + "=");
    });
    variables.push_back(program.pid_variable + "=" + std::string(kPidDigits + 1, '\0'));
  }
  const std::vector<char*> argument_pointers = pointers_to(arguments);
  const std::vector<char*> place_pointers = pointers_to(places);
  const std::vector<char*> environment = pointers_to(variables);
  std::vector<std::vector<std::string>> need_places;
  std::vector<std::vector<char*>> need_pointers;
  std::vector<char* const*> needs;
  for (const StartNeed& need : program.needs) need_places.push_back(need.places);
  for (std::vector<std::string>& each : need_places) need_pointers.push_back(pointers_to(each));
  for (const std::vector<char*>& each : need_pointers) needs.push_back(each.data());
  needs.push_back(nullptr);
  const Preparation ready{
      place_pointers.data(),
      program.log.c_str(),
      program.folder.empty() ? nullptr : program.folder.c_str(),
      argument_pointers.data(),
      environment.data(),
      needs.data(),
      program.pid_variable.empty() ? nullptr : &variables.back()[program.pid_variable.size() + 1],
      program.kept_until_it_runs,
      until,
      program.lifetime == Lifetime::kStarter ? getpid() : 0,
      umask_of_programs};

  const std::string& name = program.arguments.front();
  const auto failed = [&](int why) {
    return Error{description({Step::kPrepare, why}, name, program.log, program.folder, {})};
  };
  std::array<int, 2> report{};
  if (pipe2(report.data(), O_CLOEXEC) != 0) return failed(errno);
  FileDescriptor read_end(report[0]);
  const FileDescriptor write_end(report[1]);
  const pid_t pid = fork_into(ready, write_end.get());
  if (pid < 0) return failed(-pid);
  return Launch(pid, std::move(read_end), until, program);
}

Launch::Launch(Launch&& other) noexcept
    : pid_(std::exchange(other.pid_, 0)),
      report_(std::move(other.report_)),
      until_(other.until_),
      name_(std::move(other.name_)),
      log_(std::move(other.log_)),
      folder_(std::move(other.folder_)),
      needs_(std::move(other.needs_)),
      is_missing_something_(other.is_missing_something_) {}

Launch& Launch::operator=(Launch&& other) noexcept {
  std::swap(pid_, other.pid_);
  std::swap(report_, other.report_);
  std::swap(until_, other.until_);
  std::swap(name_, other.name_);
  std::swap(log_, other.log_);
  std::swap(folder_, other.folder_);
  std::swap(needs_, other.needs_);
  std::swap(is_missing_something_, other.is_missing_something_);
  return *this;
}

Launch::~Launch() {
  if (pid_ == 0) return;
  pollfd report{report_.get(), POLLIN, 0};
  const bool is_decided = poll(&report, 1, 0) > 0;
  if (is_decided) {
    (void)outcome();
    return;
  }
  CULPRIT_ASSERT(pid_ > 1);  // -1 would be all processes
  kill(pid_, SIGKILL);
  // One that hangs in a file system exits when that lets it go: the supervisor cannot wait for it.
  waitpid(pid_, nullptr, WNOHANG);
}

Expected<void> Launch::outcome() {
  CULPRIT_ASSERT(report_.get() >= 0);
  CULPRIT_ASSERT(pid_ > 1);  // waitpid() would wait for another's child
  const int pid = std::exchange(pid_, 0);
  Failure failure{};
  ssize_t size = 0;
  do size = read(report_.get(), &failure, sizeof failure);
  while (size < 0 && errno == EINTR);
  report_ = FileDescriptor();
  const bool has_failed = size == sizeof failure;
  if (has_failed || until_ != Until::kItRuns) waitpid(pid, nullptr, 0);
  is_missing_something_ = has_failed && is_of_missing(failure);
  if (has_failed) return Error{description(failure, name_, log_, folder_, needs_)};
  return {};
}

Expected<int> spawn(const Program& program) {
  auto launch = Launch::begin(program, Until::kItRuns);
  if (!launch) return Error{launch.error()};
  const int pid = launch->pid();
  if (const auto runs = launch->outcome(); !runs) return Error{runs.error()};
  return pid;
}

}  // namespace culprit::owners
