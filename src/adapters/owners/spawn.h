// Starts a program: an argument vector, never a shell.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/expected.h"
#include "owners/file_descriptor.h"

namespace culprit::owners {

// How long a process lives that nobody ends.
enum class Lifetime : std::uint8_t {
  kOwn,     // it outlives whoever started it, however that ends
  kStarter  // it is killed with the thread that started it: for worlds that are gone with theirs
};

struct Program {
  std::vector<std::string> arguments;  // the first is the program, with or without a path
  std::vector<std::filesystem::path> search_first;  // where to look for it before PATH
  // Its output is appended here. Parent folders are made; the file is its user's alone.
  std::filesystem::path log;
  // "NAME=value", beside what it inherits; also where it is looked for, if PATH is among them.
  std::vector<std::string> environment{};
  // A variable that holds the new process's own pid, and in processes that it starts, not theirs.
  std::string pid_variable{};
  // A descriptor that the new process keeps until the program runs; -1: none.
  int kept_until_it_runs = -1;
  Lifetime lifetime = Lifetime::kOwn;
  std::filesystem::path folder{};  // where it runs; empty: where we do
};

enum class Until : std::uint8_t {
  kItRuns,
  kItCouldRun  // all is done but the last step: the program is not run
};

// A start under way: the process is there, whether the program runs will be known. It may take as
// long as the file system that the program is on.
class Launch {
 public:
  // The new process leads a session and a process group of its own (a Ctrl-C at culprit's terminal
  // is not for it), reads nothing, inherits the environment, no open file
  // and no capability that whoever started this program gave it, has default signal handling, and is not spared
  // when memory runs out because this program is.
  // Does not wait for any file system but that of the log. Errors: the system gives no process or
  // no descriptor.
  static Expected<Launch> begin(const Program& program, Until until);
  Launch(Launch&& other) noexcept;
  Launch& operator=(Launch&& other) noexcept;
  // A start that is not over yet is given up. What runs goes on.
  ~Launch();

  int pid() const { return pid_; }
  // Readable when outcome() does not have to wait.
  int descriptor() const { return report_.get(); }

  // Waits, until the program runs, or could. If it does, the caller reaps it; all others are
  // reaped. Errors: no such program, not executable, the log cannot be written, the folder cannot be
  // entered. @pre not called yet
  Expected<void> outcome();

 private:
  Launch(int pid, FileDescriptor report, Until until, const Program& program)
      : pid_(pid),
        report_(std::move(report)),
        until_(until),
        name_(program.arguments.front()),
        log_(program.log),
        folder_(program.folder) {}

  int pid_;  // 0: it is over, or moved from
  FileDescriptor report_;
  Until until_;
  std::string name_;
  std::filesystem::path log_;
  std::filesystem::path folder_;
};

// From now on only this user can read the files that this process makes (umask), so that no other user can lock them
// either. Programs that spawn() starts have the umask from before. Call it before there are threads.
void keep_files_private();

// As execve(2) takes them, with a null behind. They point into `texts`.
std::vector<char*> pointers_to(std::vector<std::string>& texts);

// What we have in our environment, without what `added` has a value for, and `added`.
std::vector<std::string> environment_with(const std::vector<std::string>& added);

// Starts it and waits until it runs. Gives its pid; the caller reaps it.
Expected<int> spawn(const Program& program);

}  // namespace culprit::owners
