#include "http/http_server.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>
#include <sys/socket.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <zlib.h>

#include <fmt/core.h>

#include "http/budgeted_server.h"
#include "http/connection_threads.h"
#include "http/event_stream.h"
#include "http/rate_limit.h"

namespace culprit::http {
namespace {

// So many orders can be given while the page has taken all threads that the system gives.
constexpr std::size_t kReadyThreads = 3;

constexpr const char* kJson = "application/json";

// The app is all of one origin and has no inline script or style; it is never in a frame.
const httplib::Headers kHeaders = {{"Content-Security-Policy",
                                    "default-src 'none'; script-src 'self'; style-src 'self'; "
                                    "img-src 'self' data:; connect-src 'self'; "
                                    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
                                   {"X-Content-Type-Options", "nosniff"},
                                   {"X-Frame-Options", "DENY"},
                                   {"Referrer-Policy", "no-referrer"},
                                   {"Cross-Origin-Opener-Policy", "same-origin"},
                                   {"Cross-Origin-Resource-Policy", "same-origin"},
                                   {"Cache-Control", "no-store"}};

thread_local bool has_token_here = false;  // the client of the request that is served

bool has_body(const httplib::Request& request) {
  return request.has_header("Content-Length") && request.get_header_value("Content-Length") != "0";
}

// Data about the robot need a token; the app itself, and whether culprit runs, are no secrets.
bool is_api(const httplib::Request& request) {
  return request.path.rfind("/api/", 0) == 0 || request.path == "/metrics";
}

bool changes(const httplib::Request& request) {
  return request.method != "GET" && request.method != "HEAD";
}

// "POST"
std::string method_of(const Route& route) {
  std::string name(to_string(route.method));
  for (char& c : name) c = static_cast<char>(c - 'a' + 'A');
  return name;
}

// By default, httplib shares a port with a process that has it already.
void take_port_alone(int socket) {
  const int yes = 1;
  setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
}

const char* reason_for(int status) {
  if (status == 404) return "there is no such page or call";
  if (status == 413) return "that is too large";
  return "the request cannot be served";
}

constexpr int kGzip = 16 + MAX_WBITS;  // the form, for zlib

// For a client that cannot unpack, which is rare: nothing is kept of it.
std::string unpacked(std::string_view gzip) {
  z_stream stream{};
  if (inflateInit2(&stream, kGzip) != Z_OK) return {};
  stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(gzip.data()));
  stream.avail_in = static_cast<uInt>(gzip.size());
  std::string text;
  std::array<char, 1 << 16> part{};
  int result = Z_OK;
  while (result == Z_OK) {
    stream.next_out = reinterpret_cast<Bytef*>(part.data());
    stream.avail_out = static_cast<uInt>(part.size());
    result = inflate(&stream, Z_NO_FLUSH);
    text.append(part.data(), part.size() - stream.avail_out);
  }
  inflateEnd(&stream);
  return text;
}

// At zlib's fastest: the robot's processor is not there for more.
std::string packed(std::string_view text) {
  z_stream stream{};
  constexpr int kUsualMemory = 8;
  if (deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, kGzip, kUsualMemory, Z_DEFAULT_STRATEGY) !=
      Z_OK)
    return {};
  stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  std::string gzip(deflateBound(&stream, text.size()), '\0');
  stream.next_out = reinterpret_cast<Bytef*>(gzip.data());
  stream.avail_out = static_cast<uInt>(gzip.size());
  const bool is_done = deflate(&stream, Z_FINISH) == Z_STREAM_END;
  gzip.resize(is_done ? stream.total_out : 0);
  deflateEnd(&stream);
  return gzip;
}

constexpr std::size_t kWorthPacking = 1 << 12;  // bytes: what is less fits into a few packets

void send(const httplib::Request& request, httplib::Response& response, std::string content,
          const std::string& type) {
  response.set_header("Vary", "Accept-Encoding");
  if (content.size() >= kWorthPacking && takes_gzip(request)) {
    std::string gzip = packed(content);
    if (!gzip.empty()) {
      content = std::move(gzip);
      response.set_header("Content-Encoding", "gzip");
    }
  }
  response.set_content(content, type);
}

// As long as it is now: bytes that are appended later are left out.
void send_file(const httplib::Request& request, httplib::Response& response,
               const Answer::File& file) {
  constexpr std::size_t kPiece = 1 << 16;
  const auto from = std::make_shared<std::ifstream>(file.path, std::ios::binary | std::ios::ate);
  if (!*from) {
    response.status = 404;
    return send(request, response, to_line(refuse(404, "it is not there any more").body), kJson);
  }
  const auto size = static_cast<std::size_t>(from->tellg());
  response.set_header("Content-Disposition", "attachment; filename=\"" + file.name + "\"");
  response.set_content_provider(
      size, file.type, [from](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
        std::array<char, kPiece> piece;
        from->clear();
        from->seekg(static_cast<std::streamoff>(offset));
        from->read(piece.data(), static_cast<std::streamsize>(std::min(length, piece.size())));
        const auto count = static_cast<std::size_t>(from->gcount());
        return count > 0 && sink.write(piece.data(), count);
      });
}

void give(const httplib::Request& request, httplib::Response& response, const Answer& answer) {
  response.status = answer.status;
  if (answer.file) return send_file(request, response, *answer.file);
  if (!answer.text) return send(request, response, to_line(answer.body), kJson);
  if (!answer.text->policy.empty())
    response.set_header("Content-Security-Policy", answer.text->policy);
  send(request, response, answer.text->content, answer.text->type);
}

// A path as the expression that httplib takes.
std::string exactly(const std::string& path) {
  std::string pattern;
  for (const char c : path) pattern += c == '.' ? std::string("\\.") : std::string(1, c);
  return pattern;
}

}  // namespace

bool client_has_token() { return has_token_here; }

class HttpServer::Http {
 public:
  Http(Options options, std::vector<Route> routes, Hub* hub)
      : options_(std::move(options)),
        routes_(std::move(routes)),
        hub_(hub),
        limit_(kRequestsPerSecond, kBurst),
        token_limit_(kRequestsPerSecond, kBurst),
        most_connections_(affordable_connections(kMostConnections)),
        server_({.body_bytes = kMostBytes}, is_on_socket() ? Clients::kOwnUser : Clients::kAny,
                options_.tls) {
    server_.new_task_queue = [this] {
      return new ConnectionThreads(most_connections_, kReadyThreads,
                                   [this] { return server_.end_one(); });
    };
    server_.set_socket_options(take_port_alone);
    server_.set_tcp_nodelay(!is_on_socket());
    server_.set_payload_max_length(kMostBytes);
    server_.set_default_headers(kHeaders);
    server_.set_pre_routing_handler([this](const httplib::Request& q, httplib::Response& r) {
      const auto refusal = refusal_of(q);
      if (!refusal) return httplib::Server::HandlerResponse::Unhandled;
      // Its body is not read, and so nothing more on this connection.
      if (has_body(q) || q.has_header("Transfer-Encoding")) r.set_header("Connection", "close");
      give(q, r, *refusal);
      return httplib::Server::HandlerResponse::Handled;
    });
    server_.set_error_handler(
        httplib::Server::HandlerWithResponse([](const httplib::Request& q, httplib::Response& r) {
          if (!r.body.empty()) return httplib::Server::HandlerResponse::Unhandled;
          give(q, r, refuse(r.status, reason_for(r.status)));
          return httplib::Server::HandlerResponse::Handled;
        }));
    server_.set_exception_handler(
        [](const httplib::Request& q, httplib::Response& r, std::exception_ptr) {
          give(q, r, refuse(500, "that failed"));
        });
    add_app();
    for (const Route& route : routes_) add(route);
    server_.Get("/api/about", [this](const httplib::Request& q, httplib::Response& r) {
      give(q, r, {200, about()});
    });
    server_.Get("/api/openapi\\.json", [this](const httplib::Request& q, httplib::Response& r) {
      send(q, r, std::string(options_.openapi), kJson);
    });
    if (hub_ != nullptr) {
      server_.Get("/api/stream",
                  [this](const httplib::Request& q, httplib::Response& r) { stream(q, r); });
    }
  }

  ~Http() {
    if (is_bound_ && is_on_socket()) unlink(options_.socket.c_str());
  }

  bool bind() {
    constexpr int kMostWaiting = 128;  // until one is taken
    const bool is_bound = is_on_socket() ? bind_to_socket() : bind_to_port();
    if (is_bound) server_.let_wait(kMostWaiting);
    return is_bound;
  }
  void listen() {
    server_.listen_after_bind();
    is_over_ = true;
  }
  void stop() {
    if (hub_ != nullptr && closes_hub_) hub_->close();
    server_.stop();
  }
  void leave_hub_open() { closes_hub_ = false; }
  bool is_on_socket() const { return !options_.socket.empty(); }
  bool has_begun() const { return server_.is_running() || is_over_; }
  int port() const { return port_; }
  const Options& options() const { return options_; }

 private:
  bool bind_to_port() {
    port_ = options_.port;
    if (port_ != 0) return server_.bind_to_port(options_.address, port_);
    port_ = server_.bind_to_any_port(options_.address);
    return port_ > 0;
  }

  // An earlier process with the same PID may have left a socket file in the way.
  bool bind_to_socket() {
    unlink(options_.socket.c_str());
    server_.set_address_family(AF_UNIX);
    constexpr int kAnyPort = 80;  // it has none
    is_bound_ = server_.bind_to_port(options_.socket, kAnyPort);
    return is_bound_ && chmod(options_.socket.c_str(), S_IRUSR | S_IWUSR) == 0;
  }

  // Why a request is not served; nothing: it is.
  std::optional<Answer> refusal_of(const httplib::Request& q) {
    has_token_here = is_on_socket();
    if (auto refusal = is_on_socket() ? std::nullopt : refusal_of_sender(q)) return refusal;
    if (q.has_header("Transfer-Encoding")) return refuse(411, "say the length of the body");
    if (q.has_header("Content-Encoding")) return refuse(415, "send the body as it is");
    if (has_body(q) && q.get_header_value("Content-Type").rfind(kJson, 0) != 0)
      return refuse(415, "send the body as application/json");
    return std::nullopt;
  }

  std::optional<Answer> refusal_of_sender(const httplib::Request& q) {
    const std::string host = q.get_header_value("Host");
    if (!options_.access.allows_host(host))
      return refuse(403, "this server is not called '" + host + "'");
    const std::string site = q.get_header_value("Sec-Fetch-Site");
    const bool is_foreign = (site == "cross-site" || site == "same-site") && is_api(q);
    if (is_foreign || !options_.access.allows_origin(q.get_header_value("Origin"), host))
      return refuse(403, "pages of other sites may not ask this server");
    const auto role = options_.access.role_of(q.get_header_value("Authorization"));
    has_token_here = role.has_value();
    if (role) spare_this_request();
    const Role needed = role_for(q);
    if (!is_within_limits(q, role && *role >= needed ? role : std::nullopt))
      return refuse(429, "too many requests; wait a second");
    const bool needs_token = changes(q) || (is_api(q) && !options_.access.is_local);
    if (needs_token && !role)
      return refuse(401,
                    "this needs the token that culprit printed: Authorization: Bearer <token>");
    if (needs_token && *role < needed)
      return refuse(403, fmt::format("this token allows to {}; this needs one that allows to {}",
                                     to_string(*role), to_string(needed)));
    return std::nullopt;
  }

  Role role_for(const httplib::Request& q) const {
    if (!changes(q)) return Role::kLook;
    for (const Route& route : routes_) {
      if (route.path == q.path && method_of(route) == q.method) return route.role();
    }
    return Role::kAdminister;
  }

  // An address says little about the client: all users of this machine share one. Each token has limits of its own, for changes
  // and for the rest, so that neither requests without it nor those with another one can delay it.
  bool is_within_limits(const httplib::Request& q, std::optional<Role> token) {
    const auto now = RateLimit::Clock::now();
    if (!token) return limit_.allows(q.remote_addr, now);
    return token_limit_.allows(std::string(to_string(*token)) + (changes(q) ? " changes" : ""),
                               now);
  }

  // The calls that this server offers: a page shows no more than that.
  Json about() const {
    Json calls = Json::array();
    if (hub_ != nullptr) calls.push_back("get /api/stream");
    for (const Route& route : routes_)
      calls.push_back(std::string(to_string(route.method)) + " " + route.path);
    Json about = options_.about;
    about["calls"] = std::move(calls);
    return about;
  }

  void add_app() {
    for (const Asset& asset : options_.app) {
      server_.Get(exactly(std::string(asset.path)),
                  [asset](const httplib::Request& q, httplib::Response& r) {
                    r.set_header("Vary", "Accept-Encoding");
                    if (!takes_gzip(q))
                      return r.set_content(unpacked(asset.gzip), std::string(asset.type));
                    r.set_header("Content-Encoding", "gzip");
                    r.set_content(asset.gzip.data(), asset.gzip.size(), std::string(asset.type));
                  });
    }
  }

  void add(const Route& route) {
    const std::string pattern = exactly(route.path);
    const auto serve = [&route](const httplib::Request& q, httplib::Response& r) {
      Json body = nullptr;
      if (route.method == Method::kGet) {
        for (const auto& [name, value] : q.params) {
          if (body.contains(name)) return give(q, r, refuse(400, "say each '?name=' once"));
          body[name] = value;
        }
      } else if (!q.body.empty()) {
        body = parse_strict_json(q.body);
        if (body.is_discarded())
          return give(q, r, refuse(400, "the body is no JSON, or has a member twice"));
      }
      give(q, r, route.answer(body));
    };
    switch (route.method) {
      case Method::kGet:
        server_.Get(pattern, serve);
        break;
      case Method::kPost:
        server_.Post(pattern, serve);
        break;
      case Method::kPut:
        server_.Put(pattern, serve);
        break;
      case Method::kDelete:
        server_.Delete(pattern, serve);
        break;
    }
  }

  void stream(const httplib::Request& q, httplib::Response& r) {
    // Other requests need a connection, too.
    const bool has_token =
        is_on_socket() || options_.access.role_of(q.get_header_value("Authorization"));
    const std::size_t all = std::min(kMostStreams, (most_connections_ + 1) / 2);
    const std::size_t most =
        has_token ? all : (all * kMostStreamsWithoutToken + kMostStreams - 1) / kMostStreams;
    if (++streams_ > static_cast<int>(most)) {
      --streams_;
      r.set_header("Retry-After", "5");
      return give(q, r, refuse(503, "too many pages are open; close some"));
    }
    const auto events = std::make_shared<EventStream>(*hub_, q.get_header_value("Last-Event-ID"));
    r.set_chunked_content_provider(
        "text/event-stream",
        [events](std::size_t, httplib::DataSink& sink) {
          const std::optional<std::string> text = events->next();
          if (!text) return false;
          return sink.write(text->data(), text->size());
        },
        [this](bool) { --streams_; });
  }

  const Options options_;
  const std::vector<Route> routes_;
  Hub* const hub_;
  RateLimit limit_;
  RateLimit token_limit_;
  std::atomic<int> streams_ = 0;
  std::atomic<bool> is_over_ = false;  // it does not listen any more
  const std::size_t most_connections_;
  BudgetedServer server_;
  int port_ = 0;
  bool is_bound_ = false;  // to the socket
  bool closes_hub_ = true;
};

HttpServer::HttpServer(std::unique_ptr<Http> http) : http_(std::move(http)) {
  thread_ = std::thread([this] { http_->listen(); });
}

Expected<std::unique_ptr<HttpServer>> HttpServer::start(Options options, std::vector<Route> routes,
                                                        Hub* hub) {
  auto http = std::make_unique<Http>(std::move(options), std::move(routes), hub);
  const bool is_bound = http->bind();
  if (!is_bound && http->is_on_socket())
    return Error{
        fmt::format("cannot listen at {}: {}", http->options().socket, std::strerror(errno))};
  if (!is_bound)
    return Error{
        fmt::format("cannot listen at {} port {}; is the port taken? --port chooses another",
                    http->options().address, http->options().port)};
  try {
    return std::unique_ptr<HttpServer>(new HttpServer(std::move(http)));
  } catch (const std::system_error& no_thread) {
    return Error{fmt::format("the system gives no thread to serve on: {}", no_thread.what())};
  }
}

HttpServer::~HttpServer() {
  // stop() before it listens would be lost.
  while (!http_->has_begun()) std::this_thread::yield();
  http_->stop();
  thread_.join();
}

void HttpServer::leave_hub_open() { http_->leave_hub_open(); }

int HttpServer::port() const { return http_->port(); }

std::string HttpServer::address() const {
  return fmt::format("{}://{}:{}/#token={}", http_->options().tls ? "https" : "http",
                     http_->options().address, http_->port(), http_->options().access.token);
}

}  // namespace culprit::http
