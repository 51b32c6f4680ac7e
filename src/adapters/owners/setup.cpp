#include "owners/setup.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <poll.h>
#include <string_view>
#include <sys/wait.h>
#include <unistd.h>

#include "base/invariant.h"
#include "base/live_clock.h"
#include "owners/piped_program.h"
#include "owners/spawn.h"

namespace culprit::owners {
namespace {

constexpr std::size_t kMostOutput = std::size_t{1} << 20;

// The file sees no arguments. Its output is for people, so it goes to standard error.
constexpr const char* kLine =
    R"(culprit_setup=$1; shift; . "$culprit_setup" >&2 && exec /usr/bin/env -0)";

bool begins_with_any(std::string_view variable, std::initializer_list<std::string_view> names) {
  return std::any_of(names.begin(), names.end(),
                     [&](std::string_view name) { return variable.starts_with(name); });
}

// False at the end, and when there is too much.
bool take_from(int descriptor, std::string& text) {
  std::array<char, 4096> part{};
  const ssize_t size = read(descriptor, part.data(), part.size());
  if (size < 0) return errno == EINTR || errno == EAGAIN;
  text.append(part.data(), static_cast<std::size_t>(size));
  return size > 0 && text.size() <= kMostOutput;
}

enum class Over : std::uint8_t { kItself, kTime };
// Reads until all holders of both ends have closed them, or `end`. The last part of the errors is
// kept.
Over read_all(int out, int err, Time end, std::string& printed, std::string& errors) {
  std::array<pollfd, 2> files{{{out, POLLIN, 0}, {err, POLLIN, 0}}};
  while (files[0].fd >= 0) {
    const Time now = live_now();
    if (now >= end) return Over::kTime;
    const auto wait = std::chrono::ceil<std::chrono::milliseconds>(end - now).count();
    poll(files.data(), files.size(), static_cast<int>(wait));
    if (files[0].revents != 0 && !take_from(out, printed)) files[0].fd = -1;
    if (files[1].revents != 0 && !take_from(err, errors)) files[1].fd = -1;
    if (errors.size() > kMostOutput / 2) errors.erase(0, errors.size() - kMostOutput / 4);
  }
  return Over::kItself;
}

// ": No such file or directory", from its last output.
std::string last_words(const std::string& errors) {
  const std::string line = last_line(errors);
  return line.empty() ? "" : ": " + line;
}

}  // namespace

Expected<std::vector<std::string>> environment_after(const std::filesystem::path& file,
                                                     const std::vector<std::string>& given,
                                                     Duration limit) {
  const std::string name = "SETUP " + file.string();
  // BASH_ENV names another file that bash would read.
  std::vector<std::string> before = environment_with(given);
  std::erase_if(before, [](const std::string& v) { return v.starts_with("BASH_ENV="); });
  auto out = make_pipe();
  auto err = make_pipe();
  if (!out) return Error{name + ": " + out.error()};
  if (!err) return Error{name + ": " + err.error()};
  const auto pid = begin_piped(
      {"/bin/bash", "--noprofile", "--norc", "-c", kLine, "culprit-setup", file.native()}, before,
      {.out = out->write_end.get(), .err = err->write_end.get()});
  out->write_end = FileDescriptor();
  err->write_end = FileDescriptor();
  if (!pid) return Error{name + ": " + pid.error()};
  std::string printed;
  std::string errors;
  const Over over =
      read_all(out->read_end.get(), err->read_end.get(), later(live_now(), limit), printed, errors);
  CULPRIT_ASSERT(*pid > 1);
  kill(-*pid, SIGKILL);  // what it started in the background, too
  int status = 0;
  while (waitpid(*pid, &status, 0) < 0 && errno == EINTR) {
  }
  if (over == Over::kTime)
    return Error{name + " took longer than " + culprit::to_string(limit) + last_words(errors)};
  if (printed.size() > kMostOutput) return Error{name + " gives too large an environment"};
  std::vector<std::string> after;
  for (std::size_t begin = 0; begin < printed.size();) {
    const std::size_t end = printed.find('\0', begin);
    if (end == std::string::npos) break;
    std::string variable = printed.substr(begin, end - begin);
    // Those are the shell's own.
    if (!begins_with_any(variable, {"_=", "SHLVL=", "PWD=", "OLDPWD="}))
      after.push_back(std::move(variable));
    begin = end + 1;
  }
  if (after.empty()) return Error{name + " failed" + last_words(errors)};
  std::erase_if(after, [&](const std::string& variable) {
    return std::any_of(given.begin(), given.end(), [&](const std::string& each) {
      return variable.starts_with(each.substr(0, each.find('=') + 1));
    });
  });
  after.insert(after.end(), given.begin(), given.end());
  return after;
}

}  // namespace culprit::owners
