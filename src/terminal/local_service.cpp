#include "terminal/local_service.h"

#include <unistd.h>

#include "live/local_socket.h"
#include "terminal/console.h"
#include "web/app.h"

namespace culprit {

std::unique_ptr<web::HttpServer> serve_this_machine(const CulpritIdentity& identity,
                                                    std::vector<web::Route> routes, web::Hub& hub,
                                                    std::FILE* out) {
  live::remove_left_sockets();
  const auto socket = live::own_socket(identity.domain);
  Expected<std::unique_ptr<web::HttpServer>> server(nullptr);
  if (socket) {
    web::HttpServer::Options options;
    options.socket = socket->string();
    options.openapi = web::openapi();
    options.about = {{"version", identity.version}, {"robot", identity.robot},
                     {"rules", identity.rules},     {"domain", identity.domain},
                     {"node", identity.node},       {"process", getpid()},
                     {"page", identity.page}};
    server = web::HttpServer::start(std::move(options), std::move(routes), &hub);
  }
  if (!socket || !server) {
    say(stderr, "culprit: status, pause and the like cannot be asked of this culprit: {}\n",
        socket ? server.error() : socket.error());
    return nullptr;
  }
  if (identity.program.empty()) return std::move(*server);
  const std::string where =
      identity.domain == 0 ? "" : " --domain " + std::to_string(identity.domain);
  say(out, "Ask it from another terminal: {0} status{1}, {0} top{1}, {0} pause{1}\n",
      identity.program, where);
  return std::move(*server);
}

}  // namespace culprit
