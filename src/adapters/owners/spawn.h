// Starts a program: an argument vector, never a shell.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/expected.h"
#include "owners/file_descriptor.h"

namespace culprit::owners {

// How long a process runs if it is not ended.
enum class Lifetime : std::uint8_t {
  kOwn,     // it outlives its starter, however that ends
  kStarter  // it is killed with the thread that started it: for worlds that are gone with theirs
};

// A file that a program reads when it starts, beside itself.
struct StartNeed {
  std::vector<std::string> places;  // it has to be in one of them
  std::string missing;              // for people, if it is in none: "there is no file /a.yaml"
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
  std::vector<StartNeed> needs{};  // without these it is not started
};

enum class Until : std::uint8_t {
  kItRuns,
  kItCouldRun,  // all is done but the last step: the program is not run
  kItIsReady    // as above, and its files were not written for kSettles: no build is at them
};

// A start under way: the process is there, whether the program runs will be known. It may take as
// long as the file system that the program is on.
class Launch {
 public:
  static constexpr std::int64_t kSettles = 1;  // seconds

  // The new process leads a session and a process group of its own, so a Ctrl-C at culprit's
  // terminal does not reach it. It reads nothing. It inherits the environment, but no open file,
  // and no capability that this program was given. It has default signal handling, and culprit's
  // protection from the OOM killer does not extend to it. Does not wait for any file system but
  // that of the log. Errors: the system gives no process or no descriptor.
  static Expected<Launch> begin(const Program& program, Until until);
  Launch(Launch&& other) noexcept;
  Launch& operator=(Launch&& other) noexcept;
  // Gives up a start that is not over yet. A running program goes on.
  ~Launch();

  int pid() const { return pid_; }
  // Readable when outcome() does not have to wait.
  int descriptor() const { return report_.get(); }

  // Waits, until the program runs, or could. If it does, the caller reaps it; all others are
  // reaped. Errors: no such program, not executable, the log cannot be written, the folder cannot be
  // entered. @pre not called yet
  Expected<void> outcome();

  // After outcome(): did it fail because a file that it needs, the program or its folder is not there,
  // or is being written? Then a later start may succeed without any other change.
  bool is_missing_something() const { return is_missing_something_; }

 private:
  Launch(int pid, FileDescriptor report, Until until, const Program& program)
      : pid_(pid),
        report_(std::move(report)),
        until_(until),
        name_(program.arguments.front()),
        log_(program.log),
        folder_(program.folder) {
    for (const StartNeed& need : program.needs) needs_.push_back(need.missing);
  }

  int pid_;  // 0: it is over, or moved from
  FileDescriptor report_;
  Until until_;
  std::string name_;
  std::filesystem::path log_;
  std::filesystem::path folder_;
  std::vector<std::string> needs_;
  bool is_missing_something_ = false;
};

// From now on only this user can read the files that this process makes (umask), so that no other user can lock them
// either. Programs that spawn() starts have the umask from before. Call it before there are threads.
void keep_files_private();

// The value that a program gets of `variable`: from `added`, or else from our own environment. Empty: none.
std::string value_in_environment(const std::string& variable,
                                 const std::vector<std::string>& added);

// Our environment, with `added` in place of variables of the same names.
std::vector<std::string> environment_with(const std::vector<std::string>& added);

// Starts it and waits until it runs. Gives its pid; the caller reaps it.
Expected<int> spawn(const Program& program);

}  // namespace culprit::owners
