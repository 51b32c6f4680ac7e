#include "ros2/helper_outbox.h"

#include <array>
#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>
#include <vector>

#include <gtest/gtest.h>

namespace culprit::ros2 {
namespace {

// The two ends of a helper's socket.
class Ends {
 public:
  Ends() {
    EXPECT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, both_.data()), 0);
    for (const int each : both_) fcntl(each, F_SETFL, O_NONBLOCK);
  }
  ~Ends() {
    for (const int each : both_) close(each);
  }
  Ends(const Ends&) = delete;

  int ours() const { return both_[0]; }
  void break_it() { shutdown(both_[1], SHUT_RDWR); }
  // The frames of a helper that reads everything.
  std::vector<culprit_link::Frame> read() {
    std::array<std::uint8_t, 65536> buffer;
    while (true) {
      const ssize_t count = recv(both_[1], buffer.data(), buffer.size(), 0);
      if (count <= 0) break;
      reader_.feed({buffer.data(), static_cast<std::size_t>(count)});
    }
    std::vector<culprit_link::Frame> frames;
    while (auto frame = reader_.next()) frames.push_back(std::move(*frame));
    EXPECT_FALSE(reader_.has_failed());
    return frames;
  }

 private:
  std::array<int, 2> both_{};
  culprit_link::FrameReader reader_;
};

culprit_link::Publish message_of(std::size_t bytes, std::uint32_t id = 1) {
  return {id, culprit_link::Bytes(bytes, 7)};
}

TEST(HelperOutbox, SendsNothingButTheGreetingBeforeTheHelperHasJoined) {
  Ends ends;
  HelperOutbox outbox;
  EXPECT_FALSE(outbox.queue(message_of(10)));
  outbox.greet(culprit_link::Join{});
  EXPECT_FALSE(outbox.queue(message_of(10)));
  EXPECT_TRUE(outbox.send(ends.ours()));
  EXPECT_EQ(ends.read(), std::vector<culprit_link::Frame>{culprit_link::Join{}});
  outbox.begin();
  EXPECT_TRUE(outbox.queue(message_of(10)));
  EXPECT_TRUE(outbox.send(ends.ours()));
  EXPECT_EQ(ends.read(), std::vector<culprit_link::Frame>{message_of(10)});
  EXPECT_FALSE(outbox.has_waiting());
}

// As much comes as its helper reads, so that it is never empty: what was read is not kept.
TEST(HelperOutbox, KeepsNoMoreThanWaits) {
  Ends ends;
  HelperOutbox outbox;
  outbox.greet(culprit_link::Join{});
  outbox.begin();
  constexpr std::size_t kMessage = 10'000;
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(outbox.queue(message_of(kMessage)));
  std::size_t read = 0;
  while (read < 5000) {
    ASSERT_TRUE(outbox.send(ends.ours()));
    ASSERT_TRUE(outbox.has_waiting());
    const std::size_t more = ends.read().size();
    ASSERT_GT(more, 0U);
    for (std::size_t i = 0; i < more; ++i) ASSERT_TRUE(outbox.queue(message_of(kMessage)));
    read += more;
    EXPECT_LT(outbox.memory(), 400 * kMessage);
  }
}

TEST(HelperOutbox, TakesNoMoreThanItsLimitFromAHelperThatDoesNotRead) {
  Ends ends;
  HelperOutbox outbox;
  outbox.greet(culprit_link::Join{});
  outbox.begin();
  std::size_t taken = 0;
  while (taken < 100 && outbox.queue(message_of(culprit_link::kLongestQueue / 10))) {
    ++taken;
    EXPECT_TRUE(outbox.send(ends.ours()));
  }
  EXPECT_TRUE(outbox.is_stuck());
  EXPECT_LE(taken, 11U);
  EXPECT_LT(outbox.memory(), 2 * culprit_link::kLongestQueue);
  outbox.close();
  EXPECT_FALSE(outbox.has_waiting());
  EXPECT_EQ(outbox.memory(), 0U) << "while no helper runs";
}

TEST(HelperOutbox, KnowsThatTheSocketIsBroken) {
  Ends ends;
  HelperOutbox outbox;
  outbox.greet(culprit_link::Join{});
  ends.break_it();
  EXPECT_FALSE(outbox.send(ends.ours()));
}

}  // namespace
}  // namespace culprit::ros2
