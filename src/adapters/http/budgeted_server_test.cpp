// The threads of a server whose clients only begin their requests.
#include "http/budgeted_server.h"

#include <arpa/inet.h>
#include <atomic>
#include <chrono>
#include <future>
#include <httplib.h>
#include <string>
#include <string_view>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "http/connection_threads.h"

namespace culprit::http {
namespace {

// Its clients may take an hour: no limit of time makes room.
struct BusyServer : testing::Test {
  static constexpr std::size_t kThreads = 8;

  BusyServer() {
    server.new_task_queue = [this] {
      return new ConnectionThreads(kThreads, 2, [this] { return server.end_one(); });
    };
    server.set_pre_routing_handler([](const httplib::Request& q, httplib::Response&) {
      if (q.has_header("Authorization")) spare_this_request();
      return httplib::Server::HandlerResponse::Unhandled;
    });
    server.Get("/api/state", [](const httplib::Request&, httplib::Response& r) {
      r.set_content("{}", "application/json");
    });
    server.Post("/api/orders", [](const httplib::Request& q, httplib::Response& r) {
      r.set_content(q.body, "application/json");
    });
    server.Get("/api/long", [this](const httplib::Request&, httplib::Response&) {
      ++at_work;
      released.wait();
    });
    port = server.bind_to_any_port("127.0.0.1");
    server.let_wait(128);
    thread = std::thread([this] { server.listen_after_bind(); });
    while (!server.is_running()) std::this_thread::yield();
  }
  ~BusyServer() {
    release();
    for (const int each : open) close(each);
    server.stop();
    thread.join();
  }

  // A connection that sends this, and goes on.
  int begin(std::string_view request) {
    open.push_back(socket(AF_INET, SOCK_STREAM, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(open.back(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    EXPECT_GT(send(open.back(), request.data(), request.size(), MSG_NOSIGNAL), 0);
    return open.back();
  }
  void release() {
    if (std::exchange(is_released, true)) return;
    goes_on.set_value();
  }
  int status_of_state() const {
    httplib::Client client("127.0.0.1", port);
    client.set_read_timeout(60);
    const auto answer = client.Get("/api/state");
    return answer ? answer->status : -1;
  }

  static constexpr std::chrono::hours kHour{1};
  BudgetedServer server{
      {.header = kHour, .request = kHour, .idle = kHour, .write = kHour}, Clients::kAny, nullptr};
  std::promise<void> goes_on;
  const std::shared_future<void> released = goes_on.get_future().share();
  bool is_released = false;
  std::atomic<std::size_t> at_work = 0;
  int port = 0;
  std::thread thread;
  std::vector<int> open;
};

TEST_F(BusyServer, AnswersBesideTwoHundredRequestsThatAreOnlyBegun) {
  int answered = 0;
  for (int i = 0; i < 200; ++i) {
    begin("GET /api/state HTTP/1.1\r\nHost: local");
    if (i % 10 == 9) answered += status_of_state() == 200;
  }
  EXPECT_EQ(answered, 20);
}

TEST_F(BusyServer, AnswersBesideConnectionsThatAskNothingMore) {
  for (int i = 0; i < 50; ++i) begin("GET /api/state HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(status_of_state(), 200);
}

TEST_F(BusyServer, TakesASlowOrderWithATokenBesideThem) {
  for (std::size_t i = 0; i < kThreads; ++i) begin("GET /");
  const int owner = begin(
      "POST /api/orders HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer x\r\n"
      "Content-Type: application/json\r\nContent-Length: 2\r\nExpect: 100-continue\r\n\r\n");
  char answer[256];
  ASSERT_GT(recv(owner, answer, sizeof answer, 0), 0) << "its header is read";
  for (int i = 0; i < 50; ++i) begin("GET /");
  EXPECT_EQ(status_of_state(), 200);
  ASSERT_EQ(send(owner, "{}", 2, MSG_NOSIGNAL), 2);
  const ssize_t size = recv(owner, answer, sizeof answer, 0);
  ASSERT_GT(size, 0);
  EXPECT_EQ(std::string_view(answer, static_cast<std::size_t>(size)).substr(0, 12), "HTTP/1.1 200");
}

TEST_F(BusyServer, RefusesOthersInTimeWhileEachThreadIsAtWork) {
  for (std::size_t i = 0; i < kThreads; ++i)
    begin("GET /api/long HTTP/1.1\r\nHost: localhost\r\n\r\n");
  while (at_work < kThreads) std::this_thread::yield();
  const auto began = std::chrono::steady_clock::now();
  for (int i = 0; i < 20; ++i) {
    const int refused = begin("GET /api/state HTTP/1.1\r\nHost: localhost\r\n\r\n");
    const timeval patience{20, 0};
    setsockopt(refused, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    char byte = 0;
    EXPECT_EQ(recv(refused, &byte, 1, 0), 0) << "it is closed, and no error";
  }
  EXPECT_LT(std::chrono::steady_clock::now() - began, 5 * ConnectionThreads::kPatience)
      << "not each one waits";
  release();
  EXPECT_EQ(status_of_state(), 200);
}

}  // namespace
}  // namespace culprit::http
