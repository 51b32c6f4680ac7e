#include "http/local_exchange.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <climits>
#include <cstring>
#include <memory>
#include <optional>
#include <poll.h>
#include <string_view>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "base/live_clock.h"

namespace culprit::http {
namespace {

// The answer in the bytes received so far; nothing: it is not whole yet. Errors: it never will be.
std::optional<Expected<LocalAnswer>> read_http(const std::string& received, bool is_over) {
  const auto broken = [] { return Expected<LocalAnswer>(Error{"the answer is no HTTP"}); };
  constexpr std::string_view kVersion = "HTTP/1.";
  if (received.compare(0, kVersion.size(), kVersion, 0, std::min(received.size(), kVersion.size())))
    return broken();
  constexpr std::size_t kLongestHeader = 8 << 10;
  const std::size_t end = std::string_view(received).substr(0, kLongestHeader).find("\r\n\r\n");
  if (end == std::string_view::npos)
    return is_over || received.size() > kLongestHeader ? std::optional(broken()) : std::nullopt;
  // "HTTP/1.1 200 OK"
  constexpr std::size_t kStatus = 9;
  LocalAnswer answer;
  const char* const text = received.data();
  const auto [after, error] =
      std::from_chars(text + std::min(kStatus, end), text + end, answer.status);
  if (error != std::errc() || answer.status < 100 || answer.status > 599) return broken();
  std::string header = received.substr(0, end + 2);
  std::transform(header.begin(), header.end(), header.begin(),
                 [](char c) { return 'A' <= c && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  constexpr std::string_view kLength = "\r\ncontent-length:";
  const std::size_t at = header.find(kLength);
  if (at == std::string::npos || header.find("\r\ntransfer-encoding:") != std::string::npos)
    return broken();
  const std::size_t digits =
      std::min(header.find_first_not_of(' ', at + kLength.size()), header.size());
  std::size_t length = 0;
  const auto number =
      std::from_chars(header.data() + digits, header.data() + header.size(), length);
  if (number.ec != std::errc()) return broken();
  const std::size_t begin = end + 4;
  if (received.size() - begin < length) return is_over ? std::optional(broken()) : std::nullopt;
  answer.body = received.substr(begin, length);
  return answer;
}

class Exchange {
 public:
  explicit Exchange(const LocalRequest& request) : request_(request) {}
  Exchange(Exchange&& other) noexcept = delete;
  ~Exchange() {
    if (socket_ >= 0) close(socket_);
  }

  bool is_over() const { return result_.has_value(); }
  // At the end: the result. @pre is_over()
  Expected<LocalAnswer> result() { return std::move(*result_); }
  void fail(std::string why) { result_ = Error{std::move(why)}; }

  // Goes on as far as nothing has to be waited for.
  void go_on() {
    if (!is_connected_) connect_now();
    if (is_connected_ && !is_over()) send_rest();
    if (is_connected_ && !is_over()) receive();
  }

  // Connected: the event that it waits for. Not connected: the other's queue is full, and no event
  // reports when it is not.
  std::optional<pollfd> waits_for() const {
    if (!is_connected_) return std::nullopt;
    const bool sends = sent_ < request_.text.size();
    return pollfd{socket_, static_cast<short>(sends ? POLLOUT | POLLIN : POLLIN), 0};
  }

 private:
  void connect_now() {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string& path = request_.socket.native();
    if (path.size() >= sizeof address.sun_path) return fail("its name is too long for a socket");
    path.copy(address.sun_path, path.size());
    if (socket_ < 0) socket_ = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (socket_ < 0) return fail(std::string("no socket can be made: ") + std::strerror(errno));
    if (connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      if (errno == EAGAIN || errno == EINTR) return;
      if (errno == ECONNREFUSED || errno == ENOENT) return fail("no program listens there");
      return fail(std::strerror(errno));
    }
    ucred peer{};
    socklen_t length = sizeof peer;
    if (getsockopt(socket_, SOL_SOCKET, SO_PEERCRED, &peer, &length) != 0)
      return fail("the kernel does not show which user listens there");
    if (peer.uid != request_.user && peer.uid != 0)
      return fail("a process of another user (" + std::to_string(peer.uid) + ") listens there");
    process_ = peer.pid;
    is_connected_ = true;
  }

  void send_rest() {
    while (sent_ < request_.text.size()) {
      const ssize_t sent = ::send(socket_, request_.text.data() + sent_,
                                  request_.text.size() - sent_, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (sent < 0 && (errno == EAGAIN || errno == EINTR)) return;
      // It may have answered before it closed.
      if (sent < 0) sent_ = request_.text.size();
      if (sent > 0) sent_ += static_cast<std::size_t>(sent);
    }
  }

  // A piece only: one that sends without end must not keep the others waiting.
  void receive() {
    std::array<char, 1 << 14> piece;
    const ssize_t size = recv(socket_, piece.data(), piece.size(), MSG_DONTWAIT);
    if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
    if (size > 0) received_.append(piece.data(), static_cast<std::size_t>(size));
    if (received_.size() > request_.most_bytes)
      return fail("the answer is larger than " + std::to_string(request_.most_bytes >> 10) +
                  " KiB");
    if (size <= 0 && received_.empty())
      return fail("it hung up without an answer; is a limit of threads or descriptors reached?");
    result_ = read_http(received_, size <= 0);
    if (result_ && *result_) (*result_)->process = process_;
  }

  const LocalRequest& request_;
  int socket_ = -1;
  bool is_connected_ = false;
  int process_ = 0;
  std::size_t sent_ = 0;
  std::string received_;
  std::optional<Expected<LocalAnswer>> result_;
};

}  // namespace

std::vector<Expected<LocalAnswer>> exchange_all(std::span<const LocalRequest> requests,
                                                Duration patience) {
  const Time end = later(live_now(), patience);
  std::vector<std::unique_ptr<Exchange>> all;
  for (const LocalRequest& each : requests) all.push_back(std::make_unique<Exchange>(each));
  while (true) {
    std::vector<pollfd> waiting;
    bool is_queued = false;
    bool is_any_open = false;
    for (const auto& each : all) {
      if (!each->is_over()) each->go_on();
      if (each->is_over()) continue;
      is_any_open = true;
      const auto wanted = each->waits_for();
      is_queued |= !wanted;
      if (wanted) waiting.push_back(*wanted);
    }
    const Time now = live_now();
    if (!is_any_open || now >= end) break;
    constexpr std::int64_t kNextTry = 10;  // ms, where a queue is full
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - now).count();
    const std::int64_t most = is_queued ? kNextTry : INT_MAX;
    poll(waiting.data(), waiting.size(), static_cast<int>(std::min<std::int64_t>(left, most)));
  }
  std::vector<Expected<LocalAnswer>> answers;
  for (const auto& each : all) {
    if (!each->is_over()) each->fail("no answer came within " + culprit::to_string(patience));
    answers.push_back(each->result());
  }
  return answers;
}

}  // namespace culprit::http
