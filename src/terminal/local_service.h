// Serves other terminals of this machine, for questions and orders to a running culprit: culprit status, pause.
#pragma once

#include <cstdio>
#include <memory>

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

// Serves until the server is destroyed, and says on `out` how to ask. Null, and said, if that is
// impossible: a robot is managed all the same.
std::unique_ptr<web::HttpServer> serve_this_machine(const CulpritIdentity& identity,
                                                    std::vector<web::Route> routes, web::Hub& hub,
                                                    std::FILE* out = stdout);

}  // namespace culprit
