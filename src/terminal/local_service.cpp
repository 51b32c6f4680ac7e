#include "terminal/local_service.h"

#include <condition_variable>
#include <mutex>
#include <system_error>
#include <unistd.h>
#include <utility>

#include "live/local_socket.h"
#include "terminal/console.h"
#include "web/app.h"

namespace culprit {

Expected<std::unique_ptr<LocalService>> LocalService::begin(CulpritIdentity identity,
                                                            std::vector<http::Route> routes,
                                                            http::Hub& hub) {
  live::remove_left_sockets();
  std::unique_ptr<LocalService> service(
      new LocalService(std::move(identity), std::move(routes), hub));
  if (auto listens = service->listen(); !listens) return Error{listens.error()};
  try {
    service->looking_ = std::jthread(
        [raw = service.get()](const std::stop_token& stop) { raw->keep_listening(stop); });
  } catch (const std::system_error& no_thread) {
    return Error{std::string("the system gives no further thread: ") + no_thread.what()};
  }
  return Expected<std::unique_ptr<LocalService>>(std::move(service));
}

Expected<void> LocalService::listen() {
  const auto socket = live::own_socket(identity_.domain);
  if (!socket) return Error{socket.error()};
  http::HttpServer::Options options;
  options.socket = socket_ = socket->string();
  options.openapi = web::openapi();
  options.about = {{"version", identity_.version}, {"robot", identity_.robot},
                   {"rules", identity_.rules},     {"domain", identity_.domain},
                   {"node", identity_.node},       {"process", getpid()},
                   {"page", identity_.page}};
  auto server = http::HttpServer::start(std::move(options), routes_, &hub_);
  if (!server) return Error{server.error()};
  server_ = std::move(*server);
  return {};
}

// The folder may be back only once the user logs in again.
void LocalService::keep_listening(const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  while (!never.wait_for(lock, stop, kLook, [&] { return stop.stop_requested(); })) {
    if (server_ && access(socket_.c_str(), F_OK) == 0) continue;
    if (server_) server_->leave_hub_open();
    server_.reset();
    (void)listen();
  }
}

std::unique_ptr<LocalService> serve_this_machine(const CulpritIdentity& identity,
                                                 std::vector<http::Route> routes, http::Hub& hub,
                                                 std::FILE* out) {
  auto service = LocalService::begin(identity, std::move(routes), hub);
  if (!service) {
    say(stderr, "culprit: status, pause and the like cannot be asked of this culprit: {}\n",
        service.error());
    return nullptr;
  }
  if (identity.program.empty()) return std::move(*service);
  const std::string where =
      identity.domain == 0 ? "" : " --domain " + std::to_string(identity.domain);
  say(out, "Ask it from another terminal: {0} status{1}, {0} top{1}, {0} pause{1}\n",
      identity.program, where);
  return std::move(*service);
}

}  // namespace culprit
