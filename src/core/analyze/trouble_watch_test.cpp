#include "analyze/trouble_watch.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit {
namespace {

using namespace std::chrono_literals;

// A component that alone publishes a topic.
class TroubleWatchTest : public testing::Test {
 protected:
  TroubleWatchTest()
      : rules_(
            *check(Source("x.rules",
                          "COMPONENT c NODE /c\nRULE Gone\nPOLICIES ERROR\n"
                          "TRIGGER age(/t) > 1h\nSTRATEGY again 90 10\nADAPTATION c restart 5\n"))
                 .rules) {
    knowledge_.components[kComponent].alive = true;
    knowledge_.components[kComponent].lifecycle = Lifecycle::kActive;
    knowledge_.graph.node_appeared("/c");
    knowledge_.graph.endpoint_appeared("/c", EndpointKind::kPublisher, "/t");
    knowledge_.discovered.note(kComponent, Time{});
    come_steadily();
  }

  // The topic came at 10 Hz until now.
  void come_steadily() {
    SignalStore::Rhythm rhythm;
    rhythm.last = now_;
    rhythm.interval = rhythm.gap = 100ms;
    rhythm.flowed = 100s;
    knowledge_.signals.set_rhythm(kTopic, rhythm);
  }

  // The next message comes after that time. culprit looks every 20 ms.
  void send_after(Duration pause) {
    for (const Time end = now_ + pause; now_ < end;) {
      now_ += 20ms;
      if (now_ == end) receive(pause);
      knowledge_.now = now_;
      watch_.look(now_, true);
    }
  }
  const std::optional<PastTrouble>& past() const {
    return knowledge_.components[kComponent].past_trouble;
  }

  Time now_{100s};

 private:
  static constexpr ComponentId kComponent{0u};
  static constexpr TopicId kTopic{0u};

  void receive(Duration pause) {
    SignalStore::Rhythm rhythm = knowledge_.signals.rhythm(kTopic);
    rhythm.last = now_;
    rhythm.gap = std::min(pause, 2 * rhythm.gap);  // as the monitor reckons a longer one
    knowledge_.signals.set_rhythm(kTopic, rhythm);
  }

  RuleSet rules_;
  Knowledge knowledge_{rules_};
  TroubleWatch watch_{knowledge_, knowledge_.components};
};

TEST_F(TroubleWatchTest, ASilenceIsOverWithAMessage) {
  const Time began = now_;
  send_after(100ms);
  EXPECT_FALSE(past());
  send_after(3s);
  ASSERT_TRUE(past());
  EXPECT_EQ(past()->since, began + 100ms);
  EXPECT_EQ(past()->over, now_);
  for (int i = 0; i < 20; ++i) send_after(100ms);
  EXPECT_TRUE(past());
}

// The first of its slow gaps is as long as the others.
TEST_F(TroubleWatchTest, ATopicThatBecomesSlowRecoversFromNothing) {
  for (const Duration gap : {240ms, 340ms, 500ms, 1000ms}) {
    come_steadily();
    for (int i = 0; i < 20; ++i) send_after(gap);
    EXPECT_FALSE(past()) << gap.count();
  }
}

TEST_F(TroubleWatchTest, OneLateMessageIsNoTrouble) {
  send_after(240ms);
  send_after(100ms);
  EXPECT_FALSE(past());
}

// It began with the first of them.
TEST_F(TroubleWatchTest, OneMessageEndsNoSilence) {
  const Time began = now_;
  send_after(5s);
  send_after(5s);
  send_after(100ms);
  ASSERT_TRUE(past());
  EXPECT_EQ(past()->since, began);
}

}  // namespace
}  // namespace culprit
