// Asks a running culprit of this machine, over its socket (Server::Options): the calls of its API.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "base/expected.h"
#include "base/time.h"
#include "http/routes.h"

namespace culprit::web {

class LocalClient {
 public:
  // `patience`: how long it is waited for each answer.
  LocalClient(std::filesystem::path socket, Duration patience)
      : socket_(std::move(socket)), patience_(patience) {}

  LocalClient with_patience(Duration patience) const { return {socket_, patience}; }

  // What it answered, refusals too. Errors: nobody listens, or no whole answer came in time.
  Expected<Answer> ask(Method method, const std::string& path, const Json& body = nullptr) const;
  // Of a call that only looks. Errors: likewise, and what it refused with.
  Expected<Json> get(const std::string& path) const;

  // GET /api/stream: calls `take` with each document and its kind ("state") until that says no, or the
  // stream ends. A sign of life is of no kind, and comes each second at least. Errors: nobody listens, or
  // nothing came for the time of `patience`.
  using Take = std::function<bool(std::string_view kind, Json document)>;
  Expected<void> follow(const Take& take) const;

 private:
  std::filesystem::path socket_;
  Duration patience_;
};

}  // namespace culprit::web
