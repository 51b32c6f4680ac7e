// Reads the kernel's data about processes from /proc.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/expected.h"
#include "base/time.h"
#include "language/rule_set.h"

namespace culprit::owners {

// 'R', 'S', 'T' (stopped), 'Z' (ended, not reaped) ...; nothing if there is no such process.
std::optional<char> state_letter(int pid);

// Why it is not replaced: a debugger holds it, and its user would lose it. Nothing: none does.
std::optional<std::string> hold_of_debugger(int pid);

// Why a process is not ended yet that has crashed: it still writes its core dump, which SIGKILL would cut. Nothing: it does not.
std::optional<std::string> core_dump_of(int pid);

// The exit status that its parent will receive, as in wait(2). Nothing: it has not ended, its
// parent has received it, or it is another user's.
std::optional<int> status_of_zombie(int pid);

// Its parent, or its new parent once that one has exited; nothing if there is no such process.
std::optional<int> parent_of(int pid);

// The process that started one that culprit did not start; `ros2 run` is skipped, for it only
// waits.
struct Origin {
  enum class What : std::uint8_t {
    kKnown,
    // It has ended, for sure: the process belongs to init, or to a user's systemd, and is of a session that
    // neither of them made. Not so in a service of systemd, which may start it again.
    kEnded,
    kUnknown
  } what = What::kUnknown;
  int pid = 0;  // kKnown
};
Origin origin_of(int pid);

// Whether the shell `shell` runs it as a job in the foreground of its terminal: Ctrl-C there ends it. Not so for what
// another program starts in its own process group, as `ros2 launch` does. Nothing: it has ended, and the shell has the
// foreground.
std::optional<bool> is_foreground_job(int pid, int shell);

// Whether the shell `shell` runs it as a job, in the foreground or not, all of which is stopped, as by Ctrl-Z. Not so if
// only one process of the job is (kill -STOP).
bool is_stopped_job(int pid, int shell);

// On live_now()'s clock, to a hundredth of a second.
std::optional<Time> started_at(int pid);

// Whether the process of this number began before `known`: numbers are reused.
bool was_there(int pid, Time known);

// All processes that are visible.
std::vector<int> all_processes();

// When it began, in ticks of the kernel since the machine was started: with its number, which process it is.
std::optional<std::int64_t> start_ticks_of(int pid);

// The value after `prefix` ("NAME=") in the environment that the process was started with. Empty:
// nothing, or it is a process of another user.
std::string value_of_variable(int pid, const std::string& prefix);

// Those that it started itself and that have not ended.
std::vector<int> children_of(int pid);

// Whether `variable` ("NAME=value") is in the environment that the process was started with. False for processes of
// another user, also where this one may read theirs: any user can write anything into it.
bool has_variable(int pid, const std::string& variable);
// All such processes.
std::vector<int> processes_with(const std::string& variable);

// Where processes are counted: "pid:[4026531836]". Empty if it is unknown.
std::string pid_namespace_of(int pid);
// The network that it is in: "net:[4026531840]". Empty if it is unknown.
std::string network_namespace_of(int pid);
// The number that a process has in the innermost namespace that it is in; 0 if it is unknown.
int own_number_of(int pid);
// An error where /proc counts processes in another PID namespace than this process is in: its numbers are those of others here.
Expected<void> proc_is_of_our_processes();

// The program of a process: `script` is an interpreter's argument, as `ros2 run` is Python's.
struct Identity {
  unsigned user = 0;    // effective
  std::string program;  // with its path
  std::string script;   // with its path; empty for other programs
  bool operator==(const Identity&) const = default;
};
// Nothing: there is no such process, or it is not visible.
std::optional<Identity> identity_of(int pid);
bool runs_python(const Identity& identity);
// "/usr/bin/python3 /opt/ros/bin/ros2 of user 1000"
std::string to_string(const Identity& identity);

// The unit of systemd that has started it, by its parent and its control group: "lidar.service". A
// process that such a one started has none, nor has what a person started.
std::optional<SystemdUnit> unit_started_as(int pid);

// The container of an engine (docker, podman) that it lives in, by its control group: its id, 64
// digits. Empty: in none, or unknown.
std::string container_of(int pid);

struct Relative {
  int pid = 0;
  std::string command;           // as the kernel shortens it
  std::int64_t start_ticks = 0;  // with the PID, which process it was
};
// Those that `pid` started, and what those started.
std::vector<Relative> descendants_of(int pid);
// Those in the process group and in the session that `leader` made, itself included.
std::vector<int> members_of_group(int leader);

// The processor time that processes have used, and their memory.
struct Work {
  Duration processor{};
  std::int64_t bytes = 0;  // of memory
  // By more than what a process does that only waits.
  bool is_more_than(const Work& before) const;
};
Work work_of_group(int leader);

}  // namespace culprit::owners
