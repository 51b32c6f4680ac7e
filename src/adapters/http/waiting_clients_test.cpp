#include "http/waiting_clients.h"

#include <array>
#include <memory>
#include <sys/socket.h>
#include <unistd.h>

#include <gtest/gtest.h>

namespace culprit::http {
namespace {

using For = WaitingClients::For;
constexpr std::chrono::seconds kSecond{1};

struct WaitingFor : testing::Test {
  // A connection, and its client's socket.
  struct Pair {
    explicit Pair(WaitingClients& all) {
      EXPECT_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, sockets.data()), 0);
      connection = std::make_unique<WaitingClients::Connection>(all, sockets[0]);
    }
    ~Pair() {
      connection.reset();
      for (const int each : sockets) close(each);
    }
    Pair(const Pair&) = delete;

    bool has_ended() const {
      char byte = 0;
      return recv(sockets[1], &byte, 1, 0) == 0;
    }

    std::array<int, 2> sockets{};
    std::unique_ptr<WaitingClients::Connection> connection;
  };

  const WaitingClients::Clock::time_point now = WaitingClients::Clock::now();
  WaitingClients all;
  Pair first{all};
  Pair second{all};
};

TEST_F(WaitingFor, ClientsThatWereWaitedForLongestEndFirst) {
  first.connection->waits(For::kRequest, now - kSecond);
  second.connection->waits(For::kRequest, now - 2 * kSecond);
  EXPECT_TRUE(all.end_one(now));
  EXPECT_TRUE(second.has_ended());
  EXPECT_FALSE(first.has_ended());
  EXPECT_TRUE(all.end_one(now)) << "each is ended once";
  EXPECT_TRUE(first.has_ended());
  EXPECT_FALSE(all.end_one(now));
}

TEST_F(WaitingFor, ClientsThatAreServedOrSparedGoOn) {
  first.connection->waits(For::kNothing);
  second.connection->spare();
  EXPECT_FALSE(all.end_one(now));
  second.connection->begin_request();
  EXPECT_TRUE(all.end_one(now)) << "it was spared for the request before";
  EXPECT_FALSE(first.has_ended());
}

TEST_F(WaitingFor, ClientsThatTakeTheirAnswerSlowlyEndAfterThoseThatAskNothing) {
  first.connection->waits(For::kAnswer, now - 5 * kSecond);
  second.connection->waits(For::kRequest, now);
  EXPECT_TRUE(all.end_one(now));
  EXPECT_FALSE(first.has_ended());
  first.connection->waits(For::kAnswer, now);
  EXPECT_FALSE(all.end_one(now)) << "it had no time to take it";
  EXPECT_TRUE(all.end_one(now + kSecond));
  EXPECT_TRUE(first.has_ended());
}

TEST_F(WaitingFor, ClientsThatLeftAreForgotten) {
  first.connection.reset();
  second.connection.reset();
  EXPECT_FALSE(all.end_one(now));
}

}  // namespace
}  // namespace culprit::http
