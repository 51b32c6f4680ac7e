#include "analyze/trouble_watch.h"

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit {
namespace {

using namespace std::chrono_literals;

constexpr ComponentId kLamp{std::size_t{0}};

struct Lamp {
  Lamp() { knowledge.discovered.note(kLamp, Time(0s)); }

  ComponentState& state() { return knowledge.components[kLamp]; }
  void stop(Time at) {
    state().process = ProcessState::kStopped;
    state().process_since = at;
  }
  void go_on() { state().process = ProcessState::kRunning; }

  const RuleSet rules = *check(Source("x.rules",
                                      "COMPONENT lamp NODE /lamp\nRULE Dark\nPOLICIES ERROR\n"
                                      "TRIGGER x > 1\nSTRATEGY s 90 10\n"
                                      "ADAPTATION lamp restart 5\n"))
                             .rules;
  Knowledge knowledge{rules};
  TroubleWatch watch{knowledge, knowledge.components};
};

TEST(TroubleWatch, NotesATroubleThatEndsBesideAFailure) {
  Lamp lamp;
  lamp.stop(Time(10s));
  lamp.watch.look(Time(12s), true);
  EXPECT_FALSE(lamp.state().past_trouble);
  lamp.go_on();
  lamp.watch.look(Time(20s), true);
  ASSERT_TRUE(lamp.state().past_trouble);
  EXPECT_EQ(lamp.state().past_trouble->since, Time(10s));
  EXPECT_EQ(lamp.state().past_trouble->over, Time(20s));
}

TEST(TroubleWatch, ForgetsATroubleThatOutlastsTheFailures) {
  Lamp lamp;
  lamp.stop(Time(10s));
  lamp.watch.look(Time(12s), true);
  lamp.watch.look(Time(13s), false);
  lamp.go_on();
  lamp.watch.look(Time(5min), true);
  EXPECT_FALSE(lamp.state().past_trouble) << "when it ended was not seen";
}

// A component that alone publishes a topic, silent for a second.
class SilentTopic : public testing::Test {
 protected:
  SilentTopic()
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
    rhythm_.last = kBegan;
    rhythm_.interval = rhythm_.gap = 100ms;
    rhythm_.flowed = 100s;
    look(kBegan + 1s);
  }

  // A message comes; with `silence` it ends one.
  void receive(Time at, std::optional<SignalStore::Rhythm::Silence> silence) {
    rhythm_.last = at;
    rhythm_.silence = silence;
    look(at);
  }
  const std::optional<PastTrouble>& past() const {
    return knowledge_.components[kComponent].past_trouble;
  }

  static constexpr Time kBegan{100s};

 private:
  static constexpr ComponentId kComponent{0u};

  void look(Time now) {
    knowledge_.now = now;
    knowledge_.signals.set_rhythm(TopicId(0u), rhythm_);
    watch_.look(now, true);
  }

  RuleSet rules_;
  Knowledge knowledge_{rules_};
  TroubleWatch watch_{knowledge_, knowledge_.components};
  SignalStore::Rhythm rhythm_;
};

TEST_F(SilentTopic, ASilenceThatIsOverIsAPastTrouble) {
  const Time over = kBegan + 2s;
  receive(over, {{kBegan, over, 100ms}});
  ASSERT_TRUE(past());
  EXPECT_EQ(past()->since, kBegan);
  EXPECT_EQ(past()->over, over);
  receive(over + 100ms, {{kBegan, over, 100ms}});
  receive(over + 200ms, {{over, over + 200ms, 100ms}});
  EXPECT_TRUE(past());
}

TEST_F(SilentTopic, ASlowMessageEndsNoTrouble) {
  receive(kBegan + 2s, std::nullopt);
  EXPECT_FALSE(past());
}

TEST_F(SilentTopic, ASilenceThatTurnsOutToBeASlowTopicIsForgotten) {
  const Time over = kBegan + 2s;
  receive(over, {{kBegan, over, 100ms}});
  receive(over + 2s, std::nullopt);
  EXPECT_FALSE(past());
}

}  // namespace
}  // namespace culprit
