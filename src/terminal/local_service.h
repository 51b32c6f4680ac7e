// Serves other terminals of this machine, for questions and orders to a running culprit: culprit status, pause.
#pragma once

#include <chrono>
#include <cstdio>
#include <memory>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "base/expected.h"
#include "base/time.h"
#include "http/http_server.h"

namespace culprit {

// Who is asked. `page` is where its page is; empty: it has none.
struct CulpritIdentity {
  std::string version;
  std::string robot;
  std::string rules;  // the file
  std::uint32_t domain = 0;
  std::string node;
  std::string page;
  std::string program = "culprit";  // how a terminal calls it; empty: nothing is said about it
};

// Listens at a socket, and at a new one after it was removed: with the folder of a user who logged out, or by a
// program that cleans /tmp. Without it nobody could pause culprit.
class LocalService {
 public:
  // How often it looks whether its socket is there.
  static constexpr Duration kLook = std::chrono::seconds(2);

  // Errors: it cannot listen. `hub` outlives it.
  static Expected<std::unique_ptr<LocalService>> begin(CulpritIdentity identity,
                                                       std::vector<http::Route> routes,
                                                       http::Hub& hub);

 private:
  LocalService(CulpritIdentity identity, std::vector<http::Route> routes, http::Hub& hub)
      : identity_(std::move(identity)), routes_(std::move(routes)), hub_(hub) {}

  Expected<void> listen();
  void keep_listening(const std::stop_token& stop);

  const CulpritIdentity identity_;
  const std::vector<http::Route> routes_;
  http::Hub& hub_;
  std::string socket_;
  // The thread has it, once it runs; null: it cannot listen now.
  std::unique_ptr<http::HttpServer> server_;
  std::jthread looking_;  // ends first
};

// Serves until that is destroyed, and says on `out` how to ask. Null, and said, if it is
// impossible: a robot is managed all the same.
std::unique_ptr<LocalService> serve_this_machine(const CulpritIdentity& identity,
                                                 std::vector<http::Route> routes, http::Hub& hub,
                                                 std::FILE* out = stdout);

}  // namespace culprit
