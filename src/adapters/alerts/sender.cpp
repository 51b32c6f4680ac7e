#include "alerts/sender.h"

#include <csignal>
#include <fcntl.h>
#include <httplib.h>
#include <optional>
#include <sys/socket.h>
#include <sys/wait.h>
#include <thread>

#include <fmt/core.h>

#include "alerts/received_bytes.h"
#include "alerts/templates.h"
#include "base/live_clock.h"
#include "base/mutex.h"
#include "owners/spawn.h"

namespace culprit::alerts {
namespace {

using namespace std::chrono_literals;
using How = Sent::How;

// ---- over HTTP

// Ends a request that takes too long as a whole, or is answered with too much: httplib waits again
// for each byte, and keeps all headers that come.
class Guard {
 public:
  Guard(Duration patience, const std::atomic<bool>& stop)
      : thread_([this, end = live_now() + patience, &stop] { watch(end, stop); }) {}
  ~Guard() {
    {
      const MutexLock lock(mutex_);
      is_over_ = true;
    }
    is_done_.notify_all();
    thread_.join();
  }

  // The socket of the request, when it is made.
  void watch_over(int socket) {
    const MutexLock lock(mutex_);
    socket_ = owners::FileDescriptor(fcntl(socket, F_DUPFD_CLOEXEC, 0));
  }
  bool has_ended_it() const { return has_ended_it_; }

 private:
  void watch(Time end, const std::atomic<bool>& stop) {
    constexpr Duration kLook = 20ms;
    MutexLock lock(mutex_);
    while (!is_over_) {
      if (live_now() >= end || stop || received_bytes(socket_.get()) > kMostReceived) {
        has_ended_it_ = true;
        shutdown(socket_.get(), SHUT_RDWR);
      }
      is_done_.wait_for(lock, kLook);
    }
  }

  static constexpr std::uint64_t kMostReceived = 1 << 20;
  Mutex mutex_;
  ConditionVariable is_done_;
  bool is_over_ CULPRIT_GUARDED_BY(mutex_) = false;
  owners::FileDescriptor socket_ CULPRIT_GUARDED_BY(mutex_);
  std::atomic<bool> has_ended_it_ = false;
  std::thread thread_;
};

bool is_worth_another_try(int status) {
  constexpr int kTimeout = 408;
  constexpr int kTooMany = 429;
  constexpr int kServerError = 500;
  return status == kTimeout || status == kTooMany || status >= kServerError;
}

Sent post(const Destination& destination, const Alert& alert, Duration patience,
          const std::atomic<bool>& stop) {
  const auto url = read_url(destination.url);
  if (!url) return {How::kNever, url.error()};
  httplib::Client client(url->origin);
  if (!destination.ca.empty()) client.set_ca_cert_path(destination.ca);
  client.enable_server_certificate_verification(true);
  client.set_keep_alive(false);
  const auto limit = std::chrono::duration_cast<std::chrono::microseconds>(patience);
  client.set_connection_timeout(limit);
  client.set_read_timeout(limit);
  client.set_write_timeout(limit);
  httplib::Request request;
  request.method = "POST";
  request.path = path_for(destination.kind, *url);
  request.headers = {{"Content-Type", "application/json"}, {"User-Agent", "culprit"}};
  request.body = body_for(destination.kind, alert);
  // Only the status of the answer counts; its body is dropped.
  request.content_receiver = [](const char*, std::size_t, std::uint64_t, std::uint64_t) {
    return true;
  };
  Guard guard(patience, stop);
  client.set_socket_options([&guard](int socket) { guard.watch_over(socket); });
  const auto answer = client.send(request);
  if (guard.has_ended_it())
    return {How::kNotNow, "it did not answer within " + to_string(patience) + ", or with too much"};
  if (!answer) return {How::kNotNow, httplib::to_string(answer.error())};
  if (answer->status >= 200 && answer->status < 300) return {};
  return {is_worth_another_try(answer->status) ? How::kNotNow : How::kNever,
          fmt::format("it answers with status {}", answer->status)};
}

// ---- to a program

// Its exit status, as waitpid(2) gives it; nothing: it had to be killed.
std::optional<int> wait_for(int pid, Duration patience, const std::atomic<bool>& stop) {
  const Time end = live_now() + patience;
  int status = 0;
  while (waitpid(pid, &status, WNOHANG) == 0) {
    if (live_now() < end && !stop) {
      std::this_thread::sleep_for(20ms);
      continue;
    }
    kill(-pid, SIGKILL);  // it leads a group of its own
    waitpid(pid, &status, 0);
    return std::nullopt;
  }
  return status;
}

Sent tell_program(const Destination& destination, const Alert& alert, Duration patience,
                  const std::atomic<bool>& stop) {
  owners::Program program;
  program.arguments = destination.command;
  program.arguments.push_back(text_of(alert));
  program.environment = {"CULPRIT_ALERT=" + as_json(alert)};
  program.log = "/dev/null";
  const auto pid = owners::spawn(program);
  if (!pid) return {How::kNever, pid.error()};
  const auto status = wait_for(*pid, patience, stop);
  if (!status)
    return {How::kNotNow, "it did not end within " + to_string(patience) + " and was killed"};
  if (WIFEXITED(*status) && WEXITSTATUS(*status) == 0) return {};
  return {How::kNotNow, WIFEXITED(*status) ? fmt::format("it exits with {}", WEXITSTATUS(*status))
                                           : fmt::format("signal {} ended it", WTERMSIG(*status))};
}

}  // namespace

Sent send(const Destination& destination, const Alert& alert, Duration patience,
          const std::atomic<bool>& stop) {
  return destination.kind == Destination::Kind::kCommand
             ? tell_program(destination, alert, patience, stop)
             : post(destination, alert, patience, stop);
}

}  // namespace culprit::alerts
