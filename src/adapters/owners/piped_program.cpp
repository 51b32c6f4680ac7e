#include "owners/piped_program.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "base/begin_program.h"
#include "base/invariant.h"
#include "base/live_clock.h"

namespace culprit::owners {

Expected<Pipe> make_pipe() {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return Error{std::strerror(errno)};
  return Pipe{FileDescriptor(ends[0]), FileDescriptor(ends[1])};
}

namespace {

// False at the end, and when there is too much.
bool take_from(int descriptor, std::string& text) {
  std::array<char, 4096> part{};
  const ssize_t size = read(descriptor, part.data(), part.size());
  if (size < 0) return errno == EINTR || errno == EAGAIN;
  text.append(part.data(), static_cast<std::size_t>(size));
  return size > 0 && text.size() <= kMostOutput;
}

// Reads until all holders of both ends have closed them, or `end`. The last part of the errors is
// kept.
void read_all(int out, int err, Time end, PipedRun& run) {
  std::array<pollfd, 2> files{{{out, POLLIN, 0}, {err, POLLIN, 0}}};
  while (files[0].fd >= 0) {
    const Time now = live_now();
    if (now >= end) {
      run.end = PipedRun::End::kTime;
      return;
    }
    const auto wait = std::chrono::ceil<std::chrono::milliseconds>(end - now).count();
    poll(files.data(), files.size(), static_cast<int>(wait));
    if (files[0].revents != 0 && !take_from(out, run.out)) files[0].fd = -1;
    if (files[1].revents != 0 && !take_from(err, run.err)) files[1].fd = -1;
    if (run.err.size() > kMostOutput / 2) run.err.erase(0, run.err.size() - kMostOutput / 4);
  }
  if (run.out.size() > kMostOutput) run.end = PipedRun::End::kTooMuch;
}

// The exit status of a program that has closed its output; it gets until `end` to exit by itself.
int status_of(int pid, Time end) {
  constexpr Duration kLook = std::chrono::milliseconds(1);
  // It is not reaped before its group is killed: then the number could be another's.
  siginfo_t ended{};
  const auto has_ended = [&] {
    const int looked = waitid(P_PID, static_cast<id_t>(pid), &ended, WEXITED | WNOHANG | WNOWAIT);
    return looked != 0 || ended.si_pid != 0;
  };
  while (live_now() < end && !has_ended()) std::this_thread::sleep_for(kLook);
  CULPRIT_ASSERT(pid > 1);
  kill(-pid, SIGKILL);  // what it started in the background, too
  int how = 0;
  while (waitpid(pid, &how, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(how) ? WEXITSTATUS(how) : 128 + WTERMSIG(how);
}

}  // namespace

Expected<PipedRun> run_piped(std::vector<std::string> words, std::vector<std::string> environment,
                             Duration limit) {
  auto out = make_pipe();
  if (!out) return Error{out.error()};
  auto err = make_pipe();
  if (!err) return Error{err.error()};
  const auto pid = begin_program(std::move(words), std::move(environment),
                                 {.out = out->write_end.get(), .err = err->write_end.get()});
  out->write_end = FileDescriptor();
  err->write_end = FileDescriptor();
  if (!pid) return Error{pid.error()};
  constexpr Duration kExits = std::chrono::seconds(1);
  PipedRun run;
  const Time end = later(live_now(), limit);
  read_all(out->read_end.get(), err->read_end.get(), end, run);
  const bool is_over = run.end == PipedRun::End::kItself;
  run.status = status_of(*pid, is_over ? std::min(end, later(live_now(), kExits)) : kLongAgo);
  return run;
}

std::string last_line(std::string printed) {
  while (!printed.empty() && (printed.back() == '\n' || printed.back() == '\r')) printed.pop_back();
  std::string line = printed.substr(printed.rfind('\n') + 1);
  constexpr std::size_t kShown = 200;
  if (line.size() > kShown) line.resize(kShown);
  std::replace_if(
      line.begin(), line.end(), [](unsigned char c) { return c < ' ' || c == 0x7f; }, ' ');
  return line;
}

}  // namespace culprit::owners
