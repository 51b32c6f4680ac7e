#include "alerts/courier.h"

#include <atomic>
#include <sys/socket.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "alerts/test_webhook.h"
#include "base/live_clock.h"
#include "base/mutex.h"

namespace culprit::alerts {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

struct Told {
  std::function<void(const std::string&)> take = [this](const std::string& text) {
    const MutexLock lock(mutex);
    all += text + "\n";
  };
  std::string text() {
    const MutexLock lock(mutex);
    return all;
  }
  Mutex mutex;
  std::string all CULPRIT_GUARDED_BY(mutex);
};

Destination json_at(const std::string& url) {
  Destination destination;
  destination.url = url;
  return destination;
}

Alert numbered(int number, bool needs_person = false) {
  Alert alert;
  alert.id = std::to_string(number);
  alert.headline = "fault " + alert.id;
  alert.needs_person = needs_person;
  return alert;
}

TEST(Courier, DeliversToEachDestinationWhatItIsFor) {
  const test::TestWebhook all;
  const test::TestWebhook only_needed;
  Told told;
  std::vector<Destination> to{json_at(all.address()), json_at(only_needed.address())};
  to[1].only_for_person = true;
  Courier courier(to, told.take);
  courier.post(numbered(1));
  courier.post(numbered(2, true));
  ASSERT_TRUE(all.waits_for(2));
  ASSERT_TRUE(only_needed.waits_for(1));
  EXPECT_THAT(only_needed.requests()[0].body, HasSubstr("fault 2"));
  EXPECT_EQ(told.text(), "");
}

// A destination that hangs holds up neither the other nor the caller, and lost alerts are reported.
TEST(Courier, IsHeldUpByNobody) {
  const test::TestWebhook well;
  char request[4096];
  const test::TestListener hangs([&](int connection) {
    while (recv(connection, request, sizeof request, 0) > 0) continue;
  });
  Told told;
  const Time begin = live_now();
  Duration longest{};
  {
    Courier courier({json_at(hangs.address()), json_at(well.address())}, told.take);
    for (int i = 0; i < 1000; ++i) {
      const Time before = live_now();
      courier.post(numbered(i));
      longest = std::max(longest, live_now() - before);
    }
    EXPECT_TRUE(well.waits_for(10)) << "what is allowed at once";
  }
  EXPECT_LT(live_now() - begin, 30s);
  EXPECT_LT(longest, 5s) << "it did not wait for the one that hangs";
  EXPECT_THAT(told.text(), HasSubstr("were not sent to json at 127.0.0.1"));
}

TEST(Courier, TriesAgainAndTellsOnce) {
  std::atomic<int> count = 0;
  const test::TestWebhook server([&] { return ++count == 1 ? 503 : 200; });
  Told told;
  Courier courier({json_at(server.address())}, told.take);
  courier.post(numbered(1));
  ASSERT_TRUE(server.waits_for(2));
  for (int i = 0; i < 500 && told.text().find("reach") == std::string::npos; ++i)
    std::this_thread::sleep_for(10ms);
  EXPECT_EQ(
      told.text(),
      "an alert is not sent to json at 127.0.0.1: it answers with status 503; it is tried again\n"
      "alerts reach json at 127.0.0.1 again\n");
}

}  // namespace
}  // namespace culprit::alerts
