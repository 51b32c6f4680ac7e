#include "link/simulated_clock.h"

#include <gtest/gtest.h>

namespace culprit::link {
namespace {

using namespace std::chrono_literals;

// A clock that advances with the simulation at this rate.
struct Simulation {
  SimulatedClock clock;
  Time now{10s};
  Duration shown = 100s;
  void run(Duration time, Duration period = 10ms, int speed = 1) {
    for (const Time end = now + time; now < end; now += period) {
      clock.tick(shown, now);
      shown += speed * period;
    }
    now -= period;
  }
  bool is_sure() const { return clock.doubtful(now) > now; }
};

TEST(SimulatedClock, IsInDoubtUntilItIsHeard) {
  Simulation s;
  EXPECT_FALSE(s.is_sure());
  EXPECT_EQ(s.clock.doubt(s.now),
            "culprit runs with --use-sim-time, and no node publishes /clock yet");
  s.run(1s);
  EXPECT_TRUE(s.is_sure());
}

TEST(SimulatedClock, StandsStillWhenItIsNotToldOrToldTheSame) {
  for (const bool is_told : {false, true}) {
    Simulation s;
    s.run(1s);
    for (int i = 0; i < 11; ++i, s.now += 10ms) {
      if (is_told) s.clock.tick(s.shown - 10ms, s.now);
    }
    EXPECT_FALSE(s.is_sure());
    EXPECT_EQ(s.clock.doubt(s.now), "the simulated time stands still");
    s.run(100ms);
    EXPECT_TRUE(s.is_sure()) << "it runs again";
  }
}

TEST(SimulatedClock, MayBeToldSeldom) {
  Simulation s;
  s.run(60s, 500ms);
  s.now += 499ms;
  EXPECT_TRUE(s.is_sure());
  s.now += 3s;
  EXPECT_FALSE(s.is_sure());
}

TEST(SimulatedClock, ThatJumpsIsInDoubtForAWhile) {
  for (const Duration jump : {Duration(-5s), Duration(60s)}) {
    Simulation s;
    s.run(1s);
    s.shown += jump;
    s.run(500ms);
    EXPECT_FALSE(s.is_sure());
    EXPECT_EQ(s.clock.doubt(s.now), "the simulated time jumped");
    s.run(600ms);
    EXPECT_TRUE(s.is_sure());
  }
}

TEST(SimulatedClock, MayRunFast) {
  Simulation s;
  s.run(60s, 1s, 50);
  EXPECT_TRUE(s.is_sure());
}

}  // namespace
}  // namespace culprit::link
