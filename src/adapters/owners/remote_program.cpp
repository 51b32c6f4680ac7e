#include "owners/remote_program.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "base/begin_program.h"
#include "base/invariant.h"
#include "base/live_clock.h"
#include "owners/piped_program.h"
#include "owners/spawn.h"

namespace culprit::owners {
namespace {

constexpr int kFailureOfSsh = 255;   // ssh(1): anything else is the program's own
constexpr int kNoSuchProgram = 127;  // sh(1)

// Not a terminal, no window, no agent and no port of ours for the other computer; a link that is cut
// is noticed.
std::vector<std::string> ssh(const std::string& host) {
  const auto patience =
      std::chrono::duration_cast<std::chrono::seconds>(RemoteProgram::kPatience).count() - 1;
  return {"ssh",
          "-axT",
          "-oBatchMode=yes",
          "-oConnectTimeout=" + std::to_string(patience),
          "-oServerAliveInterval=5",
          "-oServerAliveCountMax=2",
          "-oClearAllForwardings=yes",
          "-oPermitLocalCommand=no",
          "-oLogLevel=ERROR",
          "--",
          host};
}

bool says(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

std::string remedy(const std::string& said, const std::string& host) {
  if (says(said, "Permission denied"))
    return "give culprit's user a key that " + host +
           " takes without a password (docs/security.md)";
  if (says(said, "Host key") || says(said, "host key"))
    return "compare its key and let culprit's user accept it once: ssh " + host;
  if (says(said, "resolve hostname")) return "is HOST its name? ssh " + host + " should connect";
  return "is it on, is it in the network, and does ssh " + host + " connect?";
}

}  // namespace

Expected<RemoteProgram> RemoteProgram::begin(const std::string& host,
                                             std::vector<std::string> words) {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    return Error{host + ": " + std::strerror(errno)};
  FileDescriptor ours(ends[0]);
  const FileDescriptor theirs(ends[1]);
  auto errors = make_pipe();
  if (!errors) return Error{host + ": " + errors.error()};
  fcntl(ours.get(), F_SETFL, O_NONBLOCK);
  fcntl(errors->read_end.get(), F_SETFL, O_NONBLOCK);
  std::string program = words.front();
  std::vector<std::string> command = ssh(host);
  command.insert(command.end(), std::make_move_iterator(words.begin()),
                 std::make_move_iterator(words.end()));
  const auto pid =
      begin_program(std::move(command), environment_with({}),
                    {.in = theirs.get(), .out = theirs.get(), .err = errors->write_end.get()});
  if (!pid) return Error{host + ": " + pid.error() + "; install an ssh client"};
  return RemoteProgram(host, std::move(program), *pid, std::move(ours),
                       std::move(errors->read_end));
}

RemoteProgram::RemoteProgram(RemoteProgram&& other) noexcept
    : host_(std::move(other.host_)),
      program_(std::move(other.program_)),
      pid_(std::exchange(other.pid_, 0)),
      status_(other.status_),
      socket_(std::move(other.socket_)),
      errors_(std::move(other.errors_)) {}

RemoteProgram& RemoteProgram::operator=(RemoteProgram&& other) noexcept {
  std::swap(host_, other.host_);
  std::swap(program_, other.program_);
  std::swap(pid_, other.pid_);
  std::swap(status_, other.status_);
  std::swap(socket_, other.socket_);
  std::swap(errors_, other.errors_);
  return *this;
}

RemoteProgram::~RemoteProgram() { end(); }

// Killing ssh loses nothing on the other computer; ssh itself may hang.
void RemoteProgram::end() {
  if (pid_ == 0) return;
  CULPRIT_ASSERT(pid_ > 1);
  kill(-pid_, SIGKILL);
  while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
  }
  pid_ = 0;
}

std::optional<int> RemoteProgram::status(Time until) {
  constexpr Duration kLook = std::chrono::milliseconds(5);
  while (!status_ && pid_ != 0) {
    int how = 0;
    if (waitpid(pid_, &how, WNOHANG) == pid_) {
      pid_ = 0;
      status_ = WIFEXITED(how) ? WEXITSTATUS(how) : kFailureOfSsh;
    } else if (live_now() >= until) {
      break;
    } else {
      std::this_thread::sleep_for(kLook);
    }
  }
  return status_;
}

bool RemoteProgram::was_let_in(Time until) {
  shutdown(socket_.get(), SHUT_WR);
  return status(until).value_or(kFailureOfSsh) != kFailureOfSsh;
}

// ssh names the computer in some of its messages; we always do.
std::string RemoteProgram::without_its_name(std::string said) const {
  const std::string name = host_ + ": ";
  if (said.starts_with(name)) said.erase(0, name.size());
  while (said.ends_with('.')) said.pop_back();
  return said;
}

std::string RemoteProgram::trouble() {
  constexpr Duration kAfterItsWords = std::chrono::milliseconds(300);
  const std::optional<int> how = status(later(live_now(), kAfterItsWords));
  constexpr std::size_t kMostSaid = std::size_t{64} << 10;  // bytes: it may never end
  std::array<char, 4096> text{};
  std::string said;
  for (ssize_t size = 0;
       said.size() < kMostSaid && (size = read(errors_.get(), text.data(), text.size())) > 0;)
    said.append(text.data(), static_cast<std::size_t>(size));
  said = without_its_name(last_line(std::move(said)));
  const std::string of = host_ + ": ";
  if (!how) return of + "it does not answer; " + remedy(said, host_);
  if (*how == kFailureOfSsh)
    return of + (said.empty() ? "ssh failed" : said) + "; " + remedy(said, host_);
  if (*how == kNoSuchProgram)
    return of + "it has no " + program_ + (said.empty() ? "" : " (" + said + ")") +
           "; install it there, or correct the rules";
  return of + program_ + " ended" + (said.empty() ? "" : ": " + said) +
         "; does it work there by hand?";
}

// The other computer may restrict our key to another program; that one ends, too, when its input
// ends.
Expected<void> could_reach(const std::string& host) {
  auto nothing = RemoteProgram::begin(host, {"true"});
  if (!nothing) return Error{nothing.error()};
  constexpr Duration kToEnd = std::chrono::milliseconds(700);
  if (nothing->was_let_in(later(live_now(), RemoteProgram::kPatience + kToEnd))) return {};
  return Error{nothing->trouble()};
}

}  // namespace culprit::owners
