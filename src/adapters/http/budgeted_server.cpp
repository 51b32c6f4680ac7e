#include "http/budgeted_server.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <climits>
#include <exception>
#include <filesystem>
#include <netdb.h>
#include <optional>
#include <poll.h>
#include <string>
#include <string_view>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

namespace culprit::http {
namespace {

using Clock = std::chrono::steady_clock;

// Whether `events` come within `patience`.
bool wait_for(int socket, short events, Clock::duration patience) {
  const auto end = Clock::now() + patience;
  while (true) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now()).count();
    pollfd wanted{socket, events, 0};
    const int ready =
        poll(&wanted, 1, static_cast<int>(std::clamp<std::int64_t>(left, 0, INT_MAX)));
    if (ready > 0) return (wanted.revents & events) != 0;
    if (ready == 0 || errno != EINTR) return false;
  }
}

void name_of(int socket, int (*ask)(int, sockaddr*, socklen_t*), std::string& ip, int& port) {
  sockaddr_storage address{};
  socklen_t length = sizeof address;
  std::array<char, NI_MAXHOST> host{};
  std::array<char, NI_MAXSERV> service{};
  auto* const raw = reinterpret_cast<sockaddr*>(&address);
  if (ask(socket, raw, &length) != 0 ||
      getnameinfo(raw, length, host.data(), host.size(), service.data(), service.size(),
                  NI_NUMERICHOST | NI_NUMERICSERV) != 0)
    return;
  ip = host.data();
  port = std::atoi(service.data());
}

class Connection final : public httplib::Stream {
  using For = WaitingClients::For;

  template <class Step>
  auto while_waiting(For what, Clock::time_point since, Step step) const {
    client_.waits(what, since);
    const auto result = step();
    client_.waits(For::kNothing);
    return result;
  }

 public:
  // `tls`: null: it is not encrypted.
  Connection(int socket, const ConnectionBudget& budget, TlsConnection* tls,
             WaitingClients::Connection& client)
      : socket_(socket), budget_(budget), tls_(tls), client_(client) {}

  // Whether another request comes. Its budget begins.
  bool begins_request() {
    const bool has_some = at_ < end_ || (tls_ != nullptr && tls_->has_pending());
    client_.begin_request();
    if (!has_some && !wait_for(socket_, POLLIN, budget_.idle)) return false;
    begun_ = Clock::now();
    client_.waits(For::kRequest, begun_);
    deadline_ = begun_ + budget_.header;
    header_ = body_ = 0;
    line_ends_ = 0;
    return true;
  }

  bool is_readable() const override {
    return at_ < end_ || (tls_ != nullptr && tls_->has_pending()) ||
           wait_for(socket_, POLLIN, deadline_ - Clock::now());
  }
  bool is_writable() const override {
    return while_waiting(For::kAnswer, Clock::now(),
                         [this] { return wait_for(socket_, POLLOUT, budget_.write); });
  }

  ssize_t read(char* to, std::size_t size) override {
    if (at_ == end_ && !fill_for_request()) return is_over_ ? 0 : -1;
    size = std::min(size, end_ - at_);
    // While the header is read, no more than to its end, for the bytes after it count as the body.
    if (line_ends_ < kEndOfHeader.size()) size = 1;
    std::size_t& spent = line_ends_ < kEndOfHeader.size() ? header_ : body_;
    const std::size_t limit =
        line_ends_ < kEndOfHeader.size() ? budget_.header_bytes : budget_.body_bytes;
    if (spent >= limit) return -1;
    size = std::min(size, limit - spent);
    spent += size;
    std::copy_n(buffer_.data() + at_, size, to);
    if (line_ends_ < kEndOfHeader.size()) {
      const char c = buffer_[at_];
      line_ends_ = c == kEndOfHeader[line_ends_] ? line_ends_ + 1 : (c == '\r' ? 1 : 0);
      if (line_ends_ == kEndOfHeader.size()) {
        deadline_ = begun_ + budget_.request;
        client_.waits(For::kNothing);
      }
    }
    at_ += size;
    return static_cast<ssize_t>(size);
  }

  ssize_t write(const char* bytes, std::size_t size) override {
    return while_waiting(For::kAnswer, Clock::now(), [&]() -> ssize_t {
      if (tls_ != nullptr) return tls_->write(bytes, size, budget_.write);
      if (!wait_for(socket_, POLLOUT, budget_.write)) return -1;
      return send(socket_, bytes, size, MSG_NOSIGNAL);
    });
  }

  void get_remote_ip_and_port(std::string& ip, int& port) const override {
    name_of(socket_, getpeername, ip, port);
  }
  void get_local_ip_and_port(std::string& ip, int& port) const override {
    name_of(socket_, getsockname, ip, port);
  }
  socket_t socket() const override { return socket_; }

  // Bytes of this request's body.
  std::size_t body_read() const { return body_; }

 private:
  static constexpr std::string_view kEndOfHeader = "\r\n\r\n";

  bool fill_for_request() {
    if (line_ends_ < kEndOfHeader.size()) return fill();  // is waited for since it began
    return while_waiting(For::kRequest, begun_, [this] { return fill(); });
  }

  bool fill() {
    if (tls_ == nullptr && !is_readable()) return false;
    const ssize_t received =
        tls_ != nullptr
            ? tls_->read(buffer_.data(), buffer_.size(),
                         std::chrono::ceil<std::chrono::milliseconds>(deadline_ - Clock::now()))
            : recv(socket_, buffer_.data(), buffer_.size(), 0);
    is_over_ = received == 0;
    if (received <= 0) return false;
    at_ = 0;
    end_ = static_cast<std::size_t>(received);
    return true;
  }

  const int socket_;
  const ConnectionBudget& budget_;
  TlsConnection* const tls_;
  WaitingClients::Connection& client_;
  std::array<char, 4096> buffer_;
  std::size_t at_ = 0;
  std::size_t end_ = 0;
  bool is_over_ = false;  // the client sends no more
  Clock::time_point begun_;
  Clock::time_point deadline_;
  std::size_t header_ = 0;     // bytes of this request
  std::size_t body_ = 0;       // likewise
  std::size_t line_ends_ = 0;  // of the end of the header, so many bytes came last
};

thread_local bool refuses_here = false;
thread_local WaitingClients::Connection* served_here = nullptr;

// While one lives, this thread serves the connection.
class Serves {
 public:
  explicit Serves(WaitingClients::Connection& connection) { served_here = &connection; }
  ~Serves() { served_here = nullptr; }
  Serves(const Serves&) = delete;
};

constexpr const char* kTakes = "Accept-Encoding";
constexpr const char* kTakesGzip = "Culprit-Takes-Gzip";  // in its place, for httplib not to see it

void hide_what_it_takes(httplib::Request& request) {
  const bool gzip = request.get_header_value(kTakes).find("gzip") != std::string::npos;
  for (const char* name : {kTakes, kTakesGzip}) request.headers.erase(name);
  if (gzip) request.set_header(kTakesGzip, "yes");
}

// httplib would put all of them into its memory, and a header has room for thousands of times the whole content.
void pass_over_several_ranges(httplib::Request& request) {
  if (request.ranges.size() <= 1) return;
  request.ranges.clear();
  request.headers.erase("Range");
}

// Bytes; nothing: its header does not say, or says several.
std::optional<std::size_t> size_of_body(const httplib::Request& request) {
  if (request.has_header("Transfer-Encoding")) return std::nullopt;
  const std::size_t count = request.get_header_value_count("Content-Length");
  if (count == 0) return std::size_t{0};
  const std::string text = request.get_header_value("Content-Length");
  std::size_t size = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), size);
  if (count > 1 || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return size;
}

// The kernel resets a connection that is closed with unread bytes; its client would see an error of the network.
void close_cleanly(int socket) {
  constexpr int kMostPieces = 16;
  shutdown(socket, SHUT_WR);
  std::array<char, 4096> piece;
  for (int i = 0; i < kMostPieces; ++i) {
    if (recv(socket, piece.data(), piece.size(), MSG_DONTWAIT) <= 0) break;
  }
  close(socket);
}

// Ours, or root's.
bool is_of_own_user(int socket) {
  ucred peer{};
  socklen_t length = sizeof peer;
  return getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &length) == 0 &&
         (peer.uid == geteuid() || peer.uid == 0);
}

}  // namespace

RefusesConnections::RefusesConnections() { refuses_here = true; }
RefusesConnections::~RefusesConnections() { refuses_here = false; }

void spare_this_request() {
  if (served_here != nullptr) served_here->spare();
}

bool takes_gzip(const httplib::Request& request) { return request.has_header(kTakesGzip); }

// A connection for which memory runs out ends; the others, and the server, go on.
bool BudgetedServer::process_and_close_socket(socket_t socket) {
  if (refuses_here) return close_cleanly(socket), false;
  bool is_well = false;
  try {
    is_well = serve(socket);
  } catch (const std::exception&) {
    is_well = false;
  }
  close_cleanly(socket);
  return is_well;
}

void BudgetedServer::let_wait(int connections) { ::listen(svr_sock_, connections); }

bool BudgetedServer::serve(socket_t socket) {
  WaitingClients::Connection client(waiting_, socket);
  const Serves serves(client);
  std::unique_ptr<TlsConnection> tls;
  if (tls_ != nullptr) tls = TlsConnection::accept(*tls_, socket, budget_.request);
  if (tls_ != nullptr && tls == nullptr) return false;
  Connection connection(socket, budget_, tls.get(), client);
  bool is_well = clients_ == Clients::kAny || is_of_own_user(socket);
  for (int left = is_well ? budget_.requests : 0; left > 0 && svr_sock_ != INVALID_SOCKET; --left) {
    if (!connection.begins_request()) break;
    bool is_closed = false;
    std::optional<std::size_t> body;
    is_well = process_request(connection, left == 1, is_closed, [&](httplib::Request& request) {
      hide_what_it_takes(request);
      pass_over_several_ranges(request);
      body = size_of_body(request);
    });
    // The rest of a body would be read as the next request. A page of another site writes such bodies, and could choose
    // every header of that request.
    if (!is_well || is_closed || body != connection.body_read()) break;
  }
  return is_well;
}

std::size_t affordable_connections(std::size_t wanted) {
  // Processes that are started and watched, subscriptions, the journal: the manager opens these
  // when it needs them most.
  constexpr std::size_t kReserved = 32;
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return wanted;
  std::error_code error;
  std::size_t open = 0;
  for (const auto& each : std::filesystem::directory_iterator("/proc/self/fd", error)) {
    static_cast<void>(each);
    ++open;
  }
  const std::size_t taken = open + kReserved;
  const std::size_t left = limit.rlim_cur > taken ? limit.rlim_cur - taken : 0;
  return std::clamp<std::size_t>(left / 2, 1, wanted);
}

}  // namespace culprit::http
