#include "terminal/local_service.h"

#include <unistd.h>

#include "live/local_socket.h"
#include "terminal/console.h"
#include "web/app.h"

namespace culprit {

std::unique_ptr<web::HttpServer> serve_this_machine(const WhoServes& who,
                                                    std::vector<web::Route> routes, web::Hub& hub,
                                                    std::FILE* out) {
  live::remove_left_sockets();
  const auto socket = live::own_socket(who.domain);
  Expected<std::unique_ptr<web::HttpServer>> server(nullptr);
  if (socket) {
    web::HttpServer::Options options;
    options.socket = socket->string();
    options.openapi = web::openapi();
    options.about = {{"version", who.version}, {"robot", who.robot}, {"rules", who.rules},
                     {"domain", who.domain},   {"node", who.node},   {"process", getpid()},
                     {"page", who.page}};
    server = web::HttpServer::start(std::move(options), std::move(routes), &hub);
  }
  if (!socket || !server) {
    say(stderr, "culprit: status, pause and the like cannot be asked of this culprit: {}\n",
        socket ? server.error() : socket.error());
    return nullptr;
  }
  say(out, "Ask it from another terminal: culprit status, culprit top, culprit pause\n");
  return std::move(*server);
}

}  // namespace culprit
