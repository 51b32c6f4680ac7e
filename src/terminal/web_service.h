// Serving the web app from a command: its switches, and where it can be seen.
#pragma once

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "http/http_server.h"

namespace culprit {

struct WebOptions {
  static constexpr int kUsualPort = 8642;

  std::string address = "127.0.0.1";
  std::optional<int> port;  // nothing: the usual one, or another if that is taken
  std::string token_file;
  std::string operate_token_file;
  std::string look_token_file;
  std::string certificate;
  std::string key;
  std::vector<std::string> allowed_hosts;

  // The options must live as long as `command`.
  void add_to(CLI::App& command);
};

// Serves until the server is destroyed, and says on `out` where. `hub` may be null.
// Errors: the address is not local and there is no token file; a file cannot be used; or it cannot be listened at.
Expected<std::unique_ptr<http::HttpServer>> serve(const WebOptions& options,
                                                  std::vector<http::Route> routes, http::Hub* hub,
                                                  std::FILE* out = stdout);

}  // namespace culprit
