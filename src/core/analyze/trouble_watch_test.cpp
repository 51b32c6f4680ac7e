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

}  // namespace
}  // namespace culprit
