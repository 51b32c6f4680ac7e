// Asks a running culprit of this machine, over its socket (HttpServer::Options): the calls of its API.
//
//     const LocalClient client("/run/culprit/0-4711.sock", std::chrono::seconds(1), user);
//     const auto robot = client.get("/api/robot", LocalClient::kLargeAnswer);
//
// Answers are bounded in time and size, and come from a process of the expected user or of root
// (local_exchange.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/expected.h"
#include "base/time.h"
#include "http/routes.h"

namespace culprit::http {

class LocalClient {
 public:
  static constexpr std::size_t kUsualAnswer = 64 << 10;  // bytes
  static constexpr std::size_t kLargeAnswer = 16 << 20;  // of what grows with the robot

  // `patience`: time for each whole answer. `user`: whose process has to listen there; root's may, too.
  LocalClient(std::filesystem::path socket, Duration patience, std::uint32_t user)
      : socket_(std::move(socket)), patience_(patience), user_(user) {}

  LocalClient with_patience(Duration patience) const { return {socket_, patience, user_}; }
  std::uint32_t user() const { return user_; }

  // Its answer, refusals too. Errors: no server listens, or no whole answer came in time.
  Expected<Answer> ask(Method method, const std::string& path, const Json& body = nullptr,
                       std::size_t most_bytes = kUsualAnswer) const;
  // The answer to a call that only looks. Errors: as above, and the text of a refusal.
  Expected<Json> get(const std::string& path, std::size_t most_bytes = kUsualAnswer) const;

  // The same call of several, at once: none waits for another one. Answers in the order of `clients`;
  // `bodies` has one for each, or none at all. Returns within `patience`.
  static std::vector<Expected<Answer>> ask_all(std::span<const LocalClient> clients, Method method,
                                               const std::string& path,
                                               std::span<const Json> bodies, Duration patience);

  // GET /api/stream: calls `take` with each document and its kind ("state") until that returns
  // false, or the stream ends. A sign of life is of no kind, and comes each second at least.
  // Errors: no server listens, or nothing came for the time of `patience`, or a document was larger
  // than kLargeAnswer.
  using Take = std::function<bool(std::string_view kind, Json document)>;
  Expected<void> follow(const Take& take) const;

 private:
  std::filesystem::path socket_;
  Duration patience_;
  std::uint32_t user_;
};

}  // namespace culprit::http
