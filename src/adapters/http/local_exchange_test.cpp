// Hostile programs at unix sockets: none delays or falsifies what another one answers.
#include "http/local_exchange.h"

#include <atomic>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "base/test_folder.h"

namespace culprit::http {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

int listening_at(const std::filesystem::path& path, int queue) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.native().copy(address.sun_path, sizeof address.sun_path - 1);
  const int descriptor = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  EXPECT_EQ(bind(descriptor, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  EXPECT_EQ(listen(descriptor, queue), 0);
  return descriptor;
}

// Takes connections, and sends `piece` to each again and again, with a pause between, until it is destroyed.
class Talker {
 public:
  Talker(std::filesystem::path path, std::string piece, std::chrono::milliseconds pause, int times)
      : path_(std::move(path)), descriptor_(listening_at(path_, 8)) {
    thread_ = std::thread([this, piece = std::move(piece), pause, times] {
      while (!is_over_) {
        pollfd wanted{descriptor_, POLLIN, 0};
        if (poll(&wanted, 1, 10) <= 0) continue;
        const int peer = accept4(descriptor_, nullptr, nullptr, SOCK_CLOEXEC);
        for (int i = 0; i < times && !is_over_; ++i) {
          if (send(peer, piece.data(), piece.size(), MSG_NOSIGNAL) < 0) break;
          std::this_thread::sleep_for(pause);
        }
        pollfd closed{peer, POLLRDHUP, 0};
        while (!is_over_ && poll(&closed, 1, 10) == 0) {
        }
        close(peer);
      }
    });
  }
  ~Talker() {
    is_over_ = true;
    thread_.join();
    close(descriptor_);
  }

 private:
  const std::filesystem::path path_;
  const int descriptor_;
  std::atomic<bool> is_over_ = false;
  std::thread thread_;
};

constexpr const char* kWell = "HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\n{}";

LocalRequest request_to(const std::filesystem::path& path) {
  return {path, geteuid(), "GET /api/about HTTP/1.1\r\nHost: localhost\r\n\r\n", 64 << 10};
}

std::string error_of(const Expected<LocalAnswer>& answer) {
  return answer ? "answered: " + answer->body : answer.error();
}

TEST(LocalExchange, HasTheAnswersOfTheHonestAmongTheHostile) {
  const test::TestFolder folder;
  const Talker honest(folder / "honest", kWell, 0ms, 1);
  const int silent = listening_at(folder / "silent", 8);
  const Talker trickles(folder / "trickles", "H", 20ms, 1 << 20);
  const Talker trickles_well(folder / "header", "HTTP/1.1 200 OK\r\n", 20ms, 1 << 20);
  const Talker endless(folder / "endless", "HTTP/1.1 200 OK\r\n" + std::string(1 << 16, 'x'), 0ms,
                       1 << 20);
  const Talker huge(folder / "huge",
                    "HTTP/1.1 200 OK\r\nContent-Length: 99999999999999999999\r\n\r\n", 0ms, 1);
  const Talker body(
      folder / "body",
      "HTTP/1.1 200 OK\r\nContent-Length: 999999999\r\n\r\n" + std::string(1 << 16, 'x'), 0ms,
      1 << 20);
  const Talker no_http(folder / "no_http", "220 ftp.example.org\r\n", 0ms, 1);
  std::vector<LocalRequest> requests;
  for (const char* each :
       {"silent", "trickles", "header", "endless", "huge", "body", "no_http", "nobody", "honest"})
    requests.push_back(request_to(folder / each));
  const Time begin = live_now();
  const auto answers = exchange_all(requests, 500ms);
  EXPECT_LT(live_now() - begin, Duration(5s)) << "the time is theirs together";
  EXPECT_THAT(error_of(answers[0]), HasSubstr("no answer came within 500ms"));
  EXPECT_THAT(error_of(answers[1]), HasSubstr("no HTTP"));
  EXPECT_THAT(error_of(answers[2]), HasSubstr("no answer came within 500ms"));
  EXPECT_THAT(error_of(answers[3]), HasSubstr("no HTTP"));
  EXPECT_THAT(error_of(answers[4]), HasSubstr("no HTTP"));
  EXPECT_THAT(error_of(answers[5]), HasSubstr("larger than 64 KiB"));
  EXPECT_THAT(error_of(answers[6]), HasSubstr("no HTTP"));
  EXPECT_THAT(error_of(answers[7]), HasSubstr("no program listens"));
  ASSERT_TRUE(answers[8]) << answers[8].error();
  EXPECT_EQ(answers[8]->body, "{}");
  EXPECT_EQ(answers[8]->process, getpid());
  close(silent);
}

// The queue of one that is stopped is full: connecting would wait for it.
TEST(LocalExchange, DoesNotWaitForAFullQueue) {
  const test::TestFolder folder;
  const int full = listening_at(folder / "full", 0);
  std::vector<LocalRequest> requests(4, request_to(folder / "full"));
  for (const auto& answer : exchange_all(requests, 100ms))
    EXPECT_THAT(error_of(answer), HasSubstr("no answer came within 100ms"));
  close(full);
}

TEST(LocalExchange, IsBelievedOnlyOfTheUserThatIsMeant) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become somebody else";
  constexpr uid_t kNobody = 65534;
  const test::TestFolder folder;
  std::filesystem::permissions(folder.path(), std::filesystem::perms::all);
  const std::string path = folder / "lies";
  const pid_t liar = fork();
  if (liar == 0) {
    if (setresuid(kNobody, kNobody, kNobody) != 0) _exit(1);
    const int descriptor = listening_at(path, 8);
    while (true) {
      const int peer = accept(descriptor, nullptr, nullptr);
      send(peer, kWell, std::string(kWell).size(), MSG_NOSIGNAL);
      close(peer);
    }
  }
  while (!std::filesystem::exists(path)) std::this_thread::sleep_for(1ms);
  std::this_thread::sleep_for(50ms);
  const std::vector requests{request_to(path)};
  EXPECT_THAT(error_of(exchange_all(requests, 5s).front()), HasSubstr("a process of another user"));
  auto of_nobody = requests;
  of_nobody.front().user = kNobody;
  EXPECT_TRUE(exchange_all(of_nobody, 5s).front()) << "it was asked for that user's";
  kill(liar, SIGKILL);
  waitpid(liar, nullptr, 0);
}

}  // namespace
}  // namespace culprit::http
