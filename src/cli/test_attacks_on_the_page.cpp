// Attackers who reach the page's port, and have no token.
#include <string>

#include "cli/test_attacks.h"
#include "cli/test_connections.h"
#include "cli/test_repeatedly.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;

const std::string kHead = " HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: application/json\r\n";

std::string post(const std::string& path, const std::string& body, const std::string& more = "") {
  return "POST " + path + kHead + more + "Content-Length: " + std::to_string(body.size()) +
         "\r\n\r\n" + body;
}

// New connections all the time, each with these requests.
class Requests {
 public:
  Requests(const Target& target, std::vector<std::string> requests, int at_once,
           std::chrono::milliseconds pause = 20ms)
      : requests_(std::move(requests)), repeat_(pause, [this, port = target.page, at_once] {
          for (const std::string& each : requests_) {
            Connections connections(port);
            connections.open(at_once);
            std::this_thread::sleep_for(2ms);
            connections.say(each);
            std::this_thread::sleep_for(2ms);
          }
        }) {}

 private:
  const std::vector<std::string> requests_;
  Repeatedly repeat_;  // ends first
};

// Connections that stay, and get a piece now and then.
class Trickle {
 public:
  Trickle(const Target& target, int count, const std::string& begin, std::string piece)
      : connections_(target.page) {
    connections_.open(count);
    std::this_thread::sleep_for(20ms);
    connections_.say(begin);
    repeat_.emplace(20ms, [this, piece = std::move(piece)] { connections_.say(piece); });
  }

 private:
  Connections connections_;
  std::optional<Repeatedly> repeat_;  // ends first
};

Ongoing many_connections(const Target& target) {
  auto connections = std::make_shared<Connections>(target.page);
  connections->open(500);
  return connections;
}
Ongoing endless_headers(const Target& target) {
  return std::make_shared<Trickle>(target, 10, "GET / HTTP/1.1\r\n",
                                   "X-Long: " + std::string(60'000, 'x') + "\r\n");
}
Ongoing slow_requests(const Target& target) {
  return std::make_shared<Trickle>(target, 100, "GET / HTTP/1.1\r\nX-Slow: ", "x");
}
Ongoing slow_bodies(const Target& target) {
  return std::make_shared<Trickle>(
      target, 100, "POST /api/orders" + kHead + "Content-Length: 60000\r\n\r\n", "x");
}
Ongoing endless_bodies(const Target& target) {
  return std::make_shared<Trickle>(
      target, 10, "POST /api/orders" + kHead + "Content-Length: 9223372036854775807\r\n\r\n",
      std::string(60'000, 'x'));
}
Ongoing readers_that_read_nothing(const Target& target) {
  return std::make_shared<Trickle>(target, 20, "", "GET /api/robot" + kHead + "\r\n");
}
Ongoing bad_tokens(const Target& target) {
  std::vector<std::string> all;
  for (const std::string token : {"", "x", "Bearer x", "Bearer \xff\xfe"})
    all.push_back(post("/api/orders", R"({"order": "pause"})", "Authorization: " + token + "\r\n"));
  all.push_back(post("/api/orders", R"({"order": "pause"})",
                     "Authorization: Bearer " + std::string(50'000, 'x') + "\r\n"));
  return std::make_shared<Requests>(target, all, 10);
}
Ongoing duplicate_and_deep_json(const Target& target) {
  return std::make_shared<Requests>(
      target,
      std::vector{post("/api/orders", R"({"order": "resume", "order": "pause"})"),
                  post("/api/orders", std::string(50'000, '[')),
                  post("/api/orders", R"({"order": "pause", "reason": "\u001b[2J"})"),
                  post("/api/orders", "{\"order\": \"\xff\xfe\"}")},
      10);
}
Ongoing garbage(const Target& target) {
  return std::make_shared<Requests>(
      target,
      std::vector<std::string>{
          std::string(1000, '\0'), "\x16\x03\x01\x02" + std::string(500, 'x'),
          "GET /../../../../etc/passwd" + kHead + "\r\n",
          "GET /%2e%2e/%2e%2e/etc/shadow" + kHead + "\r\n", "GET http://evil/" + kHead + "\r\n",
          "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
          "GET / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\nffffffffffffffff\r\n"},
      10);
}
Ongoing a_thousand_requests_a_second(const Target& target) {
  return std::make_shared<Requests>(target, std::vector{"GET /api/robot" + kHead + "\r\n"}, 20,
                                    1ms);
}

}  // namespace

std::vector<Attack> attacks_on_the_page() {
  return {
      {"many_connections", many_connections},
      {"endless_headers", endless_headers, Place::kHere, true},
      {"slow_requests", slow_requests},
      {"slow_bodies", slow_bodies},
      {"endless_bodies", endless_bodies},
      {"readers_that_read_nothing", readers_that_read_nothing},
      {"bad_tokens", bad_tokens},
      {"duplicate_and_deep_json", duplicate_and_deep_json},
      {"garbage_as_requests", garbage},
      {"a_thousand_requests_a_second", a_thousand_requests_a_second},
  };
}

}  // namespace culprit::cli
