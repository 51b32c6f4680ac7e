// Alerts over real sockets and to real programs, to destinations that accept them and to others
// that do not.
#include "alerts/sender.h"

#include <atomic>
#include <fstream>
#include <sstream>
#include <sys/socket.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "alerts/test_webhook.h"
#include "base/live_clock.h"
#include "base/test_folder.h"

namespace culprit::alerts {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using How = Sent::How;
using Kind = Destination::Kind;

constexpr Duration kLong = 20s;  // only failures need it
constexpr Duration kShort = 100ms;

Alert an_alert() {
  Alert alert;
  alert.id = "1-CameraGone";
  alert.robot = "rover";
  alert.headline = "camera is down";
  alert.health = "ERROR";
  return alert;
}

Sent send_to(const Destination& destination, Duration patience = kLong) {
  const std::atomic<bool> stop = false;
  return send(destination, an_alert(), patience, stop);
}

Destination webhook(Kind kind, const std::string& url) {
  Destination destination;
  destination.kind = kind;
  destination.url = url;
  return destination;
}

Destination program(std::vector<std::string> arguments) {
  Destination destination;
  destination.kind = Kind::kCommand;
  destination.command = std::move(arguments);
  return destination;
}

std::string content_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(AlertSender, PostsToAWebhook) {
  const test::TestWebhook server;
  EXPECT_EQ(send_to(webhook(Kind::kSlack, server.address() + "/services/T/B?x=1")).how, How::kSent);
  EXPECT_EQ(send_to(webhook(Kind::kAlertmanager, server.address())).how, How::kSent);
  ASSERT_EQ(server.requests().size(), 2u);
  EXPECT_EQ(server.requests()[0].path, "/services/T/B");
  EXPECT_THAT(server.requests()[0].body, HasSubstr("camera is down"));
  EXPECT_EQ(server.requests()[1].path, "/api/v2/alerts");
}

TEST(AlertSender, TellsWhatAnotherTryMayHelp) {
  std::atomic<int> status = 500;  // the server asks for it in a thread of its own
  const test::TestWebhook server([&] { return status.load(); });
  const Destination destination = webhook(Kind::kJson, server.address() + "/secret");
  for (const auto& [answer, how] :
       {std::pair(500, How::kNotNow), std::pair(503, How::kNotNow), std::pair(429, How::kNotNow),
        std::pair(404, How::kNever), std::pair(403, How::kNever), std::pair(302, How::kNever),
        std::pair(204, How::kSent)}) {
    status = answer;
    const Sent sent = send_to(destination);
    EXPECT_EQ(sent.how, how) << answer;
    EXPECT_THAT(sent.why, testing::Not(HasSubstr("secret")));
  }
}

TEST(AlertSender, DoesNotWaitForAReceiverThatIsAbsentOrDoesNotAnswer) {
  EXPECT_EQ(send_to(webhook(Kind::kJson, "http://127.0.0.1:1/")).how, How::kNotNow);
  EXPECT_EQ(send_to(webhook(Kind::kJson, "http://no.such.host.invalid/")).how, How::kNotNow);
  char request[4096];
  const test::TestListener silent([&](int connection) {
    while (recv(connection, request, sizeof request, 0) > 0) continue;
  });
  EXPECT_EQ(send_to(webhook(Kind::kJson, silent.address()), kShort).how, How::kNotNow);
  // A byte each moment is an answer to every single read.
  const test::TestListener slow([&](int connection) {
    while (send(connection, "H", 1, MSG_NOSIGNAL) > 0) std::this_thread::sleep_for(10ms);
  });
  EXPECT_EQ(send_to(webhook(Kind::kJson, slow.address()), kShort).how, How::kNotNow);
}

TEST(AlertSender, TakesNoMoreThanItWants) {
  std::atomic<std::size_t> sent_in_all = 0;
  const test::TestListener endless([&](int connection) {
    const std::string header = "HTTP/1.1 200 OK\r\nX: ";
    send(connection, header.data(), header.size(), MSG_NOSIGNAL);
    const std::string more(1 << 16, 'x');
    for (ssize_t n = 0; (n = send(connection, more.data(), more.size(), MSG_NOSIGNAL)) > 0;)
      sent_in_all += static_cast<std::size_t>(n);
  });
  EXPECT_EQ(send_to(webhook(Kind::kJson, endless.address())).how, How::kNotNow);
  EXPECT_LT(sent_in_all, 512u << 20);
}

TEST(AlertSender, GoesOnAfterAnswersOfAnyForm) {
  for (const std::string& answer :
       {std::string("\0\xff\n\n", 4), std::string("HTTP/1.1 999999999999 x\r\n\r\n"),
        std::string("HTTP/1.1 200 OK\r\nContent-Length: -1\r\n\r\n"), std::string()}) {
    const test::TestListener odd(
        [&](int connection) { send(connection, answer.data(), answer.size(), MSG_NOSIGNAL); });
    send_to(webhook(Kind::kJson, odd.address()), 1s);
  }
}

TEST(AlertSender, BelievesOnlyCertificatesThatSomebodyTrustedHasSigned) {
  const test::TestFolder folder;
  const test::TestWebhook server(folder.path());
  Destination destination = webhook(Kind::kJson, server.address());
  EXPECT_EQ(send_to(destination).how, How::kNotNow);
  EXPECT_TRUE(server.requests().empty());
  destination.ca = server.certificate();
  EXPECT_EQ(send_to(destination).how, How::kSent);
  EXPECT_EQ(server.requests().size(), 1u);
}

TEST(AlertSender, StopsWhenItIsToldTo) {
  char request[4096];
  const test::TestListener silent([&](int connection) {
    while (recv(connection, request, sizeof request, 0) > 0) continue;
  });
  const std::atomic<bool> stop = true;
  EXPECT_EQ(send(webhook(Kind::kJson, silent.address()), an_alert(), 1h, stop).how, How::kNotNow);
  EXPECT_EQ(send(program({"sh", "-c", "exec sleep 3600"}), an_alert(), 1h, stop).how, How::kNotNow);
}

TEST(AlertSender, TellsAProgramByItsLastArgumentAndNeverAShell) {
  const test::TestFolder folder;
  const std::string out = folder / "out";
  Destination destination =
      program({"sh", "-c", "printf '%s|%s|%s' \"$0\" \"$1\" \"$CULPRIT_ALERT\" > " + out,
               "a; touch b $(c)"});
  const Sent sent = send_to(destination);
  EXPECT_EQ(sent.how, How::kSent) << sent.why;
  EXPECT_THAT(
      content_of(out),
      HasSubstr("a; touch b $(c)|rover: camera is down (ERROR)|{\"format\":\"culprit-alert\""));
}

TEST(AlertSender, TellsWhatBecameOfAProgram) {
  EXPECT_EQ(send_to(program({"no-such-program-at-all"})).how, How::kNever);
  const Sent failing = send_to(program({"false"}));
  EXPECT_EQ(failing.how, How::kNotNow);
  EXPECT_EQ(failing.why, "it exits with 1");
  const Time begin = live_now();
  const Sent hanging = send_to(program({"sh", "-c", "exec sleep 3600"}), kShort);
  EXPECT_EQ(hanging.how, How::kNotNow);
  EXPECT_THAT(hanging.why, HasSubstr("was killed"));
  EXPECT_LT(live_now() - begin, kLong);
}

}  // namespace
}  // namespace culprit::alerts
