// Serves the web app, its API and its stream of changes over HTTP, on threads of its own.
//
// It is made for hostile company: the rules of access are in access.h; requests are bounded in size
// and in number; connections are bounded, and one that dawdles is closed. A slow reader delays only
// itself, and the manager knows nothing of readers (hub.h).
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "http/access.h"
#include "http/hub.h"
#include "http/routes.h"
#include "http/tls.h"

namespace culprit::http {

// A file of the app that browsers are given. Its texts outlive the server.
struct Asset {
  std::string_view path;  // "/app.js"
  std::string_view type;  // "text/javascript; charset=utf-8"
  std::string_view gzip;
};

class HttpServer {
 public:
  // Fewer where the limit of descriptors (ulimit -n) is low: those are the manager's first.
  static constexpr std::size_t kMostConnections = 128;
  static constexpr std::size_t kMostStreams = 64;
  static constexpr std::size_t kMostStreamsWithoutToken = 48;  // the rest is for those with one
  static constexpr std::size_t kMostBytes = 1 << 20;           // of a request's body
  // The limit for one address, in the long run; and for each token as many changes, and as many other requests.
  static constexpr double kRequestsPerSecond = 50;
  static constexpr double kBurst = 200;

  struct Options {
    std::string address = "127.0.0.1";
    int port = 0;  // 0: any that is free
    Access access;
    std::shared_ptr<const TlsContext> tls{};  // null: not encrypted
    // Where to listen instead: a unix socket. Only processes of this user and of root
    // are served there, and need no token.
    std::string socket{};
    Json about = Json::object();  // identifies the server, beside its calls
    std::span<const Asset> app{};
    std::string_view openapi{};  // describes `routes`, at /api/openapi.json; outlives the server
  };

  // Serves from now on. `hub` may be null: nothing is streamed then. Both have to outlive the
  // server. Errors: the port is taken, or the address is not ours; the socket cannot be made; the
  // system gives no thread.
  static Expected<std::unique_ptr<HttpServer>> start(Options options, std::vector<Route> routes,
                                                     Hub* hub);
  // Closes the hub, and with it every stream.
  ~HttpServer();
  // Another server takes its place: its end leaves the hub open, and waits for its own streams.
  void leave_hub_open();

  int port() const;
  // The address to type into a browser, token included.
  std::string address() const;

 private:
  class Http;
  explicit HttpServer(std::unique_ptr<Http> http);

  std::unique_ptr<Http> http_;
  std::thread thread_;
};

}  // namespace culprit::http
