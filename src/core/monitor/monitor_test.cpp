#include "monitor/monitor.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "knowledge/describe.h"
#include "language/checker.h"

namespace culprit {
namespace {

using namespace std::chrono_literals;

constexpr const char* kRules = R"(
SIGNAL s DIAGNOSTIC d KEY k STALE 70ms
RULE R
  POLICIES ERROR
  TRIGGER age(/t) > 25ms || age(/t) >= 40ms || rate(/t, 100ms) < 50 || rate(/t, 100ms) <= 80 || phi(/t) > 3 || s > 2 || mean(s, 50ms) > 1 || max(s, 50ms) > 1
    STRATEGY s 50 10
      ADAPTATION c restart 2
)";

// Truth, computed anew from everything that was ever observed.
struct Oracle {
  std::vector<std::pair<Time, std::uint32_t>> samples;
  std::vector<std::pair<Time, double>> readings;

  std::optional<double> age(Time now) const {
    if (samples.empty()) return std::nullopt;
    return seconds(now - samples.back().first);
  }
  std::optional<double> rate(Time now) const {
    if (samples.empty() || samples.front().first + 100ms > now) return std::nullopt;
    std::uint64_t count = 0;
    for (const auto& [at, n] : samples) count += at + 100ms > now ? n : 0;
    return static_cast<double>(count) / 0.1;
  }
  std::optional<double> phi(Time now) const {
    monitor::PhiAccrual accrual;
    for (const auto& [at, n] : samples) accrual.add(at, n);
    return accrual.phi(now);
  }
  std::optional<double> signal(Time now) const {
    if (readings.empty() || readings.back().first + 70ms <= now) return std::nullopt;
    return readings.back().second;
  }
  // The readings of the last 50 ms, if they are covered: no pause of 70 ms (STALE), and readings from
  // their beginning.
  std::vector<double> window(Time now) const {
    if (!signal(now)) return {};
    std::size_t first = readings.size() - 1;
    while (first > 0 && readings[first].first - readings[first - 1].first <= 70ms) --first;
    std::vector<double> values;
    if (readings[first].first + 50ms > now) return values;
    for (const auto& [at, value] : readings) {
      if (at + 50ms > now) values.push_back(value);
    }
    return values;
  }
  std::optional<double> mean(Time now) const {
    const auto values = window(now);
    double sum = 0;
    for (const double v : values) sum += v;
    return values.empty() ? std::nullopt : std::optional(sum / static_cast<double>(values.size()));
  }
  std::optional<double> max(Time now) const {
    const auto values = window(now);
    return values.empty() ? std::nullopt
                          : std::optional(*std::max_element(values.begin(), values.end()));
  }
  std::optional<double> value(const Input& input, Time now) const {
    switch (input.kind) {
      case Input::Kind::kAge:
        return age(now);
      case Input::Kind::kRate:
        return rate(now);
      case Input::Kind::kPhi:
        return phi(now);
      case Input::Kind::kSignal:
        return signal(now);
      case Input::Kind::kMean:
        return mean(now);
      default:
        return max(now);
    }
  }
};

Monitor::Writes writes(Knowledge& knowledge) {
  return {knowledge.signals,    knowledge.graph,      knowledge.components,
          knowledge.departures, knowledge.discovered, knowledge.reported_names,
          knowledge.clock_step, knowledge.events};
}

// Every comparison in the rules must give the same result as with the true value, at every moment,
// although the monitor is only woken by observations and by its own deadlines.
RC_GTEST_PROP(Monitor, KeepsEveryComparisonTrueWithoutPolling, ()) {
  const Checked checked = check(Source("test.rules", kRules));
  Knowledge knowledge(*checked.rules);
  Monitor monitor(knowledge, writes(knowledge), Time{}, Time(5s));
  Oracle oracle;
  Time now{};
  for (int i = *rc::gen::inRange(5, 60); i > 0; --i) {
    const Time until = now + std::chrono::milliseconds(*rc::gen::weightedElement<int>(
                                 {{8, 10}, {4, 13}, {2, 35}, {1, 300}}));
    for (; now < until; now += 1ms) {
      while (monitor.next_deadline() <= now) monitor.advance(monitor.next_deadline());
      for (std::size_t n = 0; n < checked.rules->inputs.size(); ++n) {
        const Input& input = checked.rules->inputs[n];
        const Slot& slot = knowledge.signals[InputId(n)];
        const auto truth = oracle.value(input, now);
        RC_ASSERT(slot.known == truth.has_value());
        if (!truth) continue;
        const double held = input.type == Type::kDuration ? seconds(Duration(slot.i)) : slot.d;
        for (const double threshold : input.thresholds) {
          // On an age's threshold itself `>=` may lag by the nanosecond that makes `>` right.
          const bool is_age = input.kind == Input::Kind::kAge;
          if (is_age && std::fabs(*truth - threshold) < 2e-9) continue;
          RC_ASSERT((held < threshold) == (*truth < threshold));
          RC_ASSERT((held > threshold) == (*truth > threshold));
        }
      }
    }
    if (*rc::gen::arbitrary<bool>()) {
      const auto count = *rc::gen::inRange<std::uint32_t>(1, 3);
      oracle.samples.push_back({now, count});
      monitor.observe({now, SampleArrived{TopicId(0), count}}, now);
    } else {
      const double value = *rc::gen::element(0.0, 0.5, 1.5, 3.0);
      oracle.readings.push_back({now, value});
      monitor.observe({now, SignalRead{SignalId(0), Value(value)}}, now);
    }
  }
}

struct Watched {
  explicit Watched(const std::string& text)
      : rules(*check(Source("test.rules", text)).rules),
        knowledge(rules),
        monitor(knowledge, writes(knowledge), Time{}, Time(5s)) {}
  template <class What>
  void observe(Duration at, What what) {
    const Time time(at);
    monitor.advance(time);
    monitor.observe({time, std::move(what)}, time);
  }
  std::size_t touched() { return knowledge.signals.take_touched().size(); }
  RuleSet rules;
  Knowledge knowledge;
  Monitor monitor;
};

std::string rule(const std::string& trigger) {
  return "COMPONENT c NODE /c\nRULE R\nPOLICIES ERROR\nTRIGGER " + trigger +
         "\nSTRATEGY s 50 10\nADAPTATION c restart 1\n";
}

TEST(Monitor, EvaluatesNothingWhileATopicIsHealthy) {
  Watched watched(rule("age(/t) > 1s || rate(/t) < 5"));
  for (int i = 0; i < 30; ++i) watched.observe(100ms * i, SampleArrived{TopicId(0), 1});
  watched.touched();
  for (int i = 30; i < 1000; ++i) watched.observe(100ms * i, SampleArrived{TopicId(0), 1});
  EXPECT_EQ(watched.touched(), 0u);
}

TEST(Monitor, TakesATopicThatNeverSpokeForSilentOnceDiscoveryIsOver) {
  Watched watched(rule("age(/t) > 1s"));
  watched.observe(0s, EndpointAppeared{"/c", EndpointKind::kPublisher, "/t"});
  watched.monitor.advance(Time(4s));
  EXPECT_FALSE(watched.knowledge.signals[InputId(0)].known);
  watched.monitor.advance(Time(5s));
  EXPECT_TRUE(watched.knowledge.signals[InputId(0)].known);
}

TEST(Monitor, CountsWhatWasLostOnTheWay) {
  Watched watched(rule("rate(/t, 1s) < 5"));
  for (int i = 0; i < 20; ++i) watched.observe(300ms * i, SampleArrived{TopicId(0), 3});
  EXPECT_NEAR(watched.knowledge.signals[InputId(0)].d, 10, 2.1);
}

TEST(Monitor, DoesNotCallALossWhatOurOwnSocketsDropped) {
  Watched watched(rule("loss(/t) > 0.1"));
  const auto& loss = watched.knowledge.signals[InputId(0)];
  for (int i = 0; i < 20; ++i) watched.observe(100ms * i, SampleArrived{TopicId(0), 2});
  EXPECT_TRUE(loss.known);
  watched.observe(2s, SampleArrived{TopicId(0), 2, true});
  EXPECT_FALSE(loss.known);
  for (int i = 21; i < 200; ++i) watched.observe(100ms * i, SampleArrived{TopicId(0), 2});
  EXPECT_TRUE(loss.known);
}

TEST(Monitor, KnowsHowLongATopicThatComesInBurstsIsSilent) {
  Watched watched(rule("age(/t) > 1s"));
  const auto rhythm = [&] { return watched.knowledge.signals.rhythm(TopicId(0)); };
  for (int i = 0; i < 50; ++i) {
    watched.observe(100ms * i, SampleArrived{TopicId(0), 1});
    watched.observe(100ms * i + 1ms, SampleArrived{TopicId(0), 1});
  }
  EXPECT_LT(rhythm().interval, 60ms);
  EXPECT_GT(rhythm().gap, 85ms);
  watched.observe(60s, SampleArrived{TopicId(0), 1});
  EXPECT_LT(rhythm().gap, 200ms) << "an outage is no pause";
}

TEST(Monitor, HearsOfAParameterAtOnceHoweverSeldomItChanges) {
  Watched watched("COMPONENT camera NODE /camera\nSIGNAL gain PARAMETER camera gain\n" +
                  rule("gain > 1 || other > 1"));
  for (const SignalId signal : {SignalId(0), SignalId(1)})
    watched.observe(100ms, SignalRead{signal, Value(2.0)});
  EXPECT_LE(watched.knowledge.signals.latency(InputId(0)), watched.knowledge.rules.cycle);
  EXPECT_GT(watched.knowledge.signals.latency(InputId(1)), 1s) << "nobody knows of a message";
}

TEST(Monitor, ReadsDiagnosticsAsTheTypeThatTheRulesNeed) {
  Watched watched(rule("flag && number > 1 && text == \"1.50\""));
  const auto read = [&](std::size_t s) {
    watched.observe(1s, SignalRead{SignalId(s), Value(std::string(s == 0 ? "True" : "1.50"))});
  };
  for (const std::size_t s : {0u, 1u, 2u}) read(s);
  EXPECT_TRUE(evaluate(watched.rules.rules[0].trigger, watched.knowledge.signals.slots()).b);
}

// Lower than ever lately, and nearer to the threshold.
TEST(Monitor, FindsAReadingUnusualThatIsANewExtremeOnly) {
  Watched low(rule("s < 2"));
  const auto reads = [](Watched& w, std::initializer_list<double> values) {
    for (const double value : values) w.observe(0ms, SignalRead{SignalId(0), Value(value)});
    return w.knowledge.signals.is_unusual(InputId(0));
  };
  EXPECT_FALSE(reads(low, {10, 5, 8, 9}));
  EXPECT_FALSE(reads(low, {7})) << "there was less";
  EXPECT_FALSE(reads(low, {5})) << "nothing new";
  EXPECT_TRUE(reads(low, {4}));
  EXPECT_FALSE(reads(low, {1})) << "it is no warning any more";
  Watched high(rule("s > 20"));
  EXPECT_FALSE(reads(high, {5, 10, 7, 6}));
  EXPECT_FALSE(reads(high, {8})) << "there was more";
  EXPECT_FALSE(reads(high, {10})) << "nothing new";
  EXPECT_TRUE(reads(high, {11}));
  EXPECT_FALSE(reads(high, {21})) << "it is no warning any more";
}

TEST(Monitor, TakesAReadingThatMakesNoSenseForUnknown) {
  Watched watched(rule("number > 1"));
  watched.observe(1s, SignalRead{SignalId(0), Value(std::string("n/a"))});
  EXPECT_FALSE(watched.knowledge.signals[InputId(0)].known);
}

TEST(Monitor, ChangedHoldsForOneCycle) {
  Watched watched(rule("changed(x)"));
  const auto changed = [&] { return watched.knowledge.signals[InputId(0)]; };
  watched.observe(1s, SignalRead{SignalId(0), Value(1.0)});
  EXPECT_FALSE(changed().known) << "the first value is neither a change nor none";
  watched.monitor.advance(Time(1200ms));
  EXPECT_TRUE(changed().known && !changed().b);
  watched.observe(2s, SignalRead{SignalId(0), Value(2.0)});
  EXPECT_TRUE(changed().b);
  watched.monitor.advance(Time(2200ms));
  EXPECT_TRUE(changed().known && !changed().b);
}

TEST(Monitor, NobodyKnowsWhatChangedInAGap) {
  Watched watched("SIGNAL x DIAGNOSTIC d KEY x STALE 1s\n" + rule("changed(x)"));
  const auto changed = [&] { return watched.knowledge.signals[InputId(0)]; };
  watched.observe(1s, SignalRead{SignalId(0), Value(1.0)});
  watched.observe(1500ms, SignalRead{SignalId(0), Value(1.0)});
  EXPECT_TRUE(changed().known);
  watched.monitor.advance(Time(2500ms));
  EXPECT_FALSE(changed().known);
  EXPECT_EQ(watched.knowledge.signals.why_unknown(InputId(0)), WhyUnknown::kStale);
  watched.observe(3s, SignalRead{SignalId(0), Value(2.0)});
  EXPECT_FALSE(changed().known);
  watched.observe(3500ms, SignalRead{SignalId(0), Value(2.0)});
  EXPECT_TRUE(changed().known && !changed().b);
  watched.monitor.restart(Time(3550ms), Time(3600ms));
  EXPECT_FALSE(changed().known) << "nobody listened";
  watched.monitor.advance(Time(3800ms));
  EXPECT_TRUE(changed().known && !changed().b);
  watched.observe(3900ms, SignalRead{SignalId(0), Value(3.0)});
  EXPECT_TRUE(changed().b) << "at the latest now";
}

TEST(Monitor, AWindowCountsOnceItIsCoveredAndAgainAfterAGap) {
  Watched watched("SIGNAL x DIAGNOSTIC d KEY x STALE 500ms\n" + rule("stddev(x, 2s) < 0.1"));
  const auto is_known = [&] { return watched.knowledge.signals[InputId(0)].known; };
  const auto why = [&] { return watched.knowledge.signals.why_unknown(InputId(0)); };
  const auto read = [&](Duration from, Duration until) {
    for (; from <= until; from += 100ms) watched.observe(from, SignalRead{SignalId(0), Value(4.2)});
  };
  EXPECT_EQ(why(), WhyUnknown::kNoValue);
  read(1s, 2900ms);
  EXPECT_EQ(why(), WhyUnknown::kNotCovered);
  read(3s, 4s);
  EXPECT_TRUE(is_known());
  EXPECT_EQ(watched.knowledge.signals[InputId(0)].d, 0);
  watched.monitor.advance(Time(4500ms));
  EXPECT_EQ(why(), WhyUnknown::kStale);
  read(4600ms, 6500ms);
  EXPECT_EQ(why(), WhyUnknown::kNotCovered) << "the first sample after a gap is not enough";
  read(6600ms, 7s);
  EXPECT_TRUE(is_known());
  watched.monitor.restart(Time(7s), Time(7s));
  EXPECT_EQ(why(), WhyUnknown::kNotCovered) << "nobody listened";
  read(7100ms, 9s);
  EXPECT_FALSE(is_known());
  read(9100ms, 9100ms);
  EXPECT_TRUE(is_known());
}

// Its first message does not make rate(/t) < 9 true; its silence does.
TEST(Monitor, ARateCountsOnceItsWindowIsCoveredAndAgainAfterAGap) {
  Watched watched(rule("rate(/t) < 9"));
  const auto rate = [&] { return watched.knowledge.signals[InputId(0)]; };
  const auto speak = [&](Duration from, Duration until) {
    for (; from <= until; from += 100ms) watched.observe(from, SampleArrived{TopicId(0), 1});
  };
  speak(20s, 21900ms);
  EXPECT_FALSE(rate().known);
  EXPECT_EQ(watched.knowledge.signals.why_unknown(InputId(0)), WhyUnknown::kNotCovered);
  speak(22s, 25s);
  EXPECT_EQ(rate().d, 10);
  watched.monitor.restart(Time(25s), Time(30s));
  EXPECT_FALSE(rate().known);
  speak(31s, 32900ms);
  EXPECT_FALSE(rate().known) << "it was heard again after 1 s";
  speak(33s, 34s);
  EXPECT_EQ(rate().d, 10);
  watched.monitor.advance(Time(36s));
  EXPECT_EQ(rate().d, 0);
  EXPECT_TRUE(rate().known) << "silence is covered, too";
  watched.monitor.restart(Time(38s), Time(40s));
  watched.monitor.advance(Time(42s));
  EXPECT_FALSE(rate().known) << "it has its usual gap and 2 s to be heard again";
  watched.monitor.advance(Time(43s));
  EXPECT_TRUE(rate().known) << "nothing came for a whole window";
}

// A silent topic stays silent, and one that was received is not silent yet; then time goes on.
TEST(Monitor, ASilenceStandsStillUntilTheTopicHadTimeToBeHeardAgain) {
  Watched watched(rule("age(/t) > 1s && phi(/t) > 8"));
  const auto age = [&] { return Duration(watched.knowledge.signals[InputId(0)].i); };
  const auto phi = [&] { return watched.knowledge.signals[InputId(1)].d; };
  for (Duration at = 20s; at <= 21s; at += 100ms) watched.observe(at, SampleArrived{TopicId(0), 1});
  watched.monitor.restart(Time(21100ms), Time(40s));
  for (const Duration at : {40s, 41s, 42s}) {
    watched.monitor.advance(Time(at));
    EXPECT_LE(age(), 100ms);
    EXPECT_LT(phi(), 1);
  }
  watched.monitor.advance(Time(42900ms));
  EXPECT_LE(age(), 1s);
  watched.monitor.advance(Time(43100ms));
  EXPECT_GT(age(), 900ms) << "2 s and its gap of 100 ms later";
  watched.monitor.advance(Time(50s));
  EXPECT_GT(age(), 1s);
  EXPECT_GT(phi(), 8);
  watched.monitor.restart(Time(50s), Time(70s));
  EXPECT_GT(age(), 1s) << "it did not speak";
  EXPECT_GT(phi(), 8);
  watched.observe(71s, SampleArrived{TopicId(0), 1});
  EXPECT_EQ(age(), 0s);
  EXPECT_LT(phi(), 1);
}

std::vector<std::string> told_unknown(const Watched& watched) {
  std::vector<std::string> all;
  for (const Event& event : watched.knowledge.events) {
    if (std::holds_alternative<ValueUnknown>(event.what))
      all.push_back(describe(event, watched.rules));
  }
  return all;
}

TEST(Monitor, WhatIsNotANumberIsUnknownAndTold) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  Watched watched(rule("x > 1 || isnan(x) || mean(x, 1s) > 1 || changed(x)"));
  const auto& signals = watched.knowledge.signals;
  const auto read = [&](Duration at, Value value) {
    watched.observe(at, SignalRead{SignalId(0), std::move(value)});
  };
  for (int i = 0; i <= 20; ++i) read(100ms * i, 0.5);
  EXPECT_TRUE(signals[InputId(1)].known && !signals[InputId(1)].b);
  EXPECT_EQ(signals[InputId(2)].d, 0.5);
  read(2100ms, kNan);
  for (const std::size_t input : {0u, 2u, 3u})
    EXPECT_EQ(signals.why_unknown(InputId(input)), WhyUnknown::kNotANumber) << input;
  EXPECT_TRUE(signals[InputId(1)].b);
  read(2200ms, std::string("nan"));
  EXPECT_TRUE(signals[InputId(1)].b) << "as a diagnostic has it";
  EXPECT_THAT(told_unknown(watched),
              testing::ElementsAre("x is not a number (NaN): rules read it as unknown, except "
                                   "isnan(x)"));
  for (int i = 0; i < 10; ++i) read(2300ms + 100ms * i, 0.5);
  EXPECT_EQ(signals.why_unknown(InputId(2)), WhyUnknown::kNotCovered);
  read(3300ms, 0.5);
  EXPECT_EQ(signals[InputId(2)].d, 0.5);
  read(3400ms, std::string("n/a"));
  EXPECT_EQ(signals.why_unknown(InputId(0)), WhyUnknown::kUnreadable);
  EXPECT_FALSE(signals[InputId(1)].known);
  read(3500ms, kNan);
  EXPECT_EQ(told_unknown(watched).size(), 1u) << "it comes and goes";
  read(64s, kNan);
  EXPECT_EQ(told_unknown(watched).size(), 2u);
}

TEST(Monitor, AWindowThatOverflowsIsUnknownAndTold) {
  Watched watched(rule("min(x, 1h) < 0 || rate(/t, 1h) < 1"));
  const auto total = static_cast<std::int64_t>(kMaxWindowSamples) + 2;
  for (std::int64_t i = 0; i < total; ++i) {
    const Time now(500us * i);
    watched.monitor.observe({now, SignalRead{SignalId(0), Value(i)}}, now);
    watched.monitor.observe({now, SampleArrived{TopicId(0), 1}}, now);
  }
  EXPECT_THAT(
      told_unknown(watched),
      testing::ElementsAre("min(x, 1h) is unknown: more than 4194304 samples come within its "
                           "window. Shorten the window",
                           "rate(/t, 1h) is unknown: more than 4194304 samples come within "
                           "its window. Shorten the window"));
  watched.monitor.advance(Time(1h));
  for (const std::size_t input : {0u, 1u})
    EXPECT_EQ(watched.knowledge.signals.why_unknown(InputId(input)), WhyUnknown::kOverflow);
}

TEST(Monitor, KnowsWhetherAComponentIsAlive) {
  Watched watched(rule("!alive(c)"));
  const auto alive = [&] { return watched.knowledge.components[ComponentId(0)].alive; };
  EXPECT_EQ(alive(), std::nullopt);
  watched.observe(1s, NodeAppeared{"/c", 7});
  EXPECT_EQ(alive(), true);
  watched.observe(2s, ProcessSeen{ComponentId(0), ProcessState::kStopped, 7, ""});
  EXPECT_EQ(alive(), false) << "stopped";
  watched.observe(3s, ProcessSeen{ComponentId(0), ProcessState::kRunning, 7, ""});
  EXPECT_EQ(alive(), true);
  watched.observe(4s, ProcessSeen{ComponentId(0), ProcessState::kGone, 7, "exit code 1"});
  EXPECT_EQ(alive(), false);
  watched.observe(5s, ProcessSeen{ComponentId(0), ProcessState::kRunning, 8, ""});
  EXPECT_EQ(alive(), false) << "the process is there, its node is not";
  watched.observe(6s, NodeAppeared{"/c", 8});
  EXPECT_EQ(alive(), true);
  watched.observe(7s, ProcessSeen{ComponentId(0), ProcessState::kGone, 7, "late news"});
  EXPECT_EQ(alive(), true) << "the old process's end says nothing about the new one";
}

// A mode manager offers services in the names of nodes.
TEST(Monitor, TellsTheProcessOfANodeAlsoIfItWasFirstTakenForThatOfItsManager) {
  Watched watched(rule("!alive(c)"));
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(2s, NodeAppeared{"/c", 8});
  watched.observe(3s, NodeAppeared{"/c", 8});
  std::vector<int> told;
  for (const Event& event : watched.knowledge.events) {
    if (const auto* found = std::get_if<ComponentFound>(&event.what)) told.push_back(found->pid);
  }
  EXPECT_EQ(told, (std::vector<int>{7, 8}));
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].node_pid, 8);
}

TEST(Monitor, AComponentWhoseComputerCannotBeAskedIsNeitherAliveNorDead) {
  Watched watched(rule("!alive(c)"));
  const auto alive = [&] { return watched.knowledge.components[ComponentId(0)].alive; };
  watched.observe(1s, NodeAppeared{"/c", 0});
  watched.observe(2s, HostReached{ComponentId(0), false});
  EXPECT_EQ(alive(), true) << "it is heard";
  watched.observe(3s, NodeVanished{"/c"});
  EXPECT_EQ(alive(), std::nullopt);
  EXPECT_FALSE(watched.knowledge.signals[InputId(0)].known);
  watched.observe(14s, HostReached{ComponentId(0), true});
  EXPECT_EQ(alive(), false) << "it had the time to be heard";
  watched.observe(15s, NodeAppeared{"/c", 0});
  EXPECT_EQ(alive(), true);
  watched.observe(16s, ProcessSeen{ComponentId(0), ProcessState::kGone, 0, "c.service failed"});
  watched.observe(17s, HostReached{ComponentId(0), false});
  EXPECT_EQ(alive(), false) << "what its owner said is proof";
}

TEST(Monitor, LosesAComponentThatDoesNotAnswerProbes) {
  Watched watched(rule("!alive(c)"));
  watched.observe(1s, NodeAppeared{"/c", 0});
  watched.observe(2s, Probed{ComponentId(0), false});
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].alive, true) << "one answer may be lost";
  watched.observe(3s, Probed{ComponentId(0), false});
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].alive, false);
  watched.observe(4s, Probed{ComponentId(0), true});
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].alive, true);
}

TEST(Monitor, ForgetsTheStateOfAProcessThatIsGone) {
  Watched watched(rule("lifecycle(c) == \"active\" || parameter(c, p) > 1 || parameter(d, p) > 1"));
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(1s, LifecycleRead{ComponentId(0), Lifecycle::kActive});
  watched.observe(1s, ParameterRead{ParameterId(0), Value(2.0)});
  watched.observe(1s, ParameterRead{ParameterId(1), Value(2.0)});
  EXPECT_TRUE(watched.knowledge.signals[InputId(0)].known &&
              watched.knowledge.signals[InputId(1)].known);
  watched.observe(2s, ProcessSeen{ComponentId(0), ProcessState::kGone, 7, ""});
  EXPECT_FALSE(watched.knowledge.signals[InputId(0)].known ||
               watched.knowledge.signals[InputId(1)].known);
  EXPECT_TRUE(watched.knowledge.signals[InputId(2)].known) << "of another component";
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].intended_lifecycle, Lifecycle::kActive);
}

TEST(Monitor, ANodeIsOfARunningProcessUnlessItsOwnIsKnownToBeStopped) {
  Watched watched(rule("!alive(c)"));
  const auto process = [&] { return watched.knowledge.components[ComponentId(0)].process; };
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(2s, ProcessSeen{ComponentId(0), ProcessState::kStopped, 7, ""});
  watched.observe(3s, NodeAppeared{"/c", 7});
  EXPECT_EQ(process(), ProcessState::kStopped) << "it was only discovered anew";
  watched.observe(4s, ProcessSeen{ComponentId(0), ProcessState::kGone, 7, ""});
  watched.observe(5s, NodeAppeared{"/c", 8});
  EXPECT_EQ(process(), ProcessState::kRunning);
}

TEST(Monitor, ANodeThatIsOnlyDiscoveredAnewIsAsItWas) {
  Watched watched(rule("lifecycle(c) == \"active\""));
  const auto lifecycle = [&] { return watched.knowledge.components[ComponentId(0)].lifecycle; };
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(1s, LifecycleRead{ComponentId(0), Lifecycle::kActive});
  watched.observe(2s, NodeAppeared{"/c", 7});
  EXPECT_EQ(lifecycle(), Lifecycle::kActive);
  watched.observe(3s, NodeAppeared{"/c", 0});
  watched.observe(3s, LifecycleRead{ComponentId(0), Lifecycle::kActive});
  watched.observe(4s, NodeAppeared{"/c", 0});
  EXPECT_EQ(lifecycle(), Lifecycle::kUnknown) << "of another machine it may be another process";
}

// As where `respawn` of a launch file starts a node again: it comes up unconfigured.
TEST(Monitor, NobodyIntendedTheStateThatANewProcessComesUpIn) {
  Watched watched(rule("!alive(c)"));
  const auto intended = [&] {
    return watched.knowledge.components[ComponentId(0)].intended_lifecycle;
  };
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(1s, LifecycleRead{ComponentId(0), Lifecycle::kActive});
  watched.observe(2s, NodeVanished{"/c"});
  watched.observe(3s, NodeAppeared{"/c", 8});
  watched.observe(3s, LifecycleRead{ComponentId(0), Lifecycle::kUnconfigured});
  EXPECT_EQ(intended(), Lifecycle::kActive);
  watched.observe(4s, NodeAppeared{"/c", 9});
  watched.observe(4s, LifecycleRead{ComponentId(0), Lifecycle::kUnconfigured});
  EXPECT_EQ(intended(), Lifecycle::kActive) << "its end was not seen";
  watched.observe(5s, LifecycleRead{ComponentId(0), Lifecycle::kInactive});
  EXPECT_EQ(intended(), Lifecycle::kInactive) << "somebody configured it";
  watched.observe(6s, NodeAppeared{"/c", 10});
  watched.observe(6s, LifecycleRead{ComponentId(0), Lifecycle::kTransition});
  watched.observe(6s, LifecycleRead{ComponentId(0), Lifecycle::kActive});
  EXPECT_EQ(intended(), Lifecycle::kActive) << "it was seen on its way";
}

// Its consumers need a moment after that, whether or not a failure was there beside.
TEST(Monitor, AnActivationEndsATroubleAndTheFirstReadingDoesNot) {
  Watched watched(rule("!alive(c)"));
  const auto& past = watched.knowledge.components[ComponentId(0)].past_trouble;
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(1s, LifecycleRead{ComponentId(0), Lifecycle::kActive});
  EXPECT_FALSE(past);
  watched.observe(20s, LifecycleRead{ComponentId(0), Lifecycle::kInactive});
  watched.observe(140s, LifecycleRead{ComponentId(0), Lifecycle::kActive});
  ASSERT_TRUE(past);
  EXPECT_EQ(past->over - past->since, 120s);
}

constexpr const char* kHeard = "!alive(c) || age(/t) > 1h";

// Its process is known, it publishes /t every 100 ms until `end`, and answers until then.
void work_until(Watched& watched, Duration end) {
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(1s, EndpointAppeared{"/c", EndpointKind::kPublisher, "/t"});
  for (Duration at = 1s; at < end; at += 100ms) watched.observe(at, SampleArrived{TopicId(0), 1});
  watched.observe(end, Probed{ComponentId(0), true});
}

// The topic came every 100 ms before these pauses.
std::optional<SignalStore::Rhythm::Silence> silence_after(std::initializer_list<Duration> pauses) {
  Watched watched(rule(kHeard));
  work_until(watched, 5s);
  Duration at = 4900ms;
  for (const Duration pause : pauses) watched.observe(at += pause, SampleArrived{TopicId(0), 1});
  return watched.knowledge.signals.rhythm(TopicId(0)).silence;
}

TEST(Monitor, ASilenceIsOverWithAMessage) {
  const auto silence = silence_after({3s});
  ASSERT_TRUE(silence);
  EXPECT_EQ(silence->over - silence->since, 3s);
  EXPECT_TRUE(silence_after({3s, 100ms, 100ms, 100ms}));
  EXPECT_TRUE(silence_after({3s, 250ms, 100ms})) << "it comes irregularly at first";
  EXPECT_FALSE(silence_after({240ms, 100ms})) << "one message is late";
}

// The first of its slow gaps is as long as the others.
TEST(Monitor, ATopicThatBecomesSlowWasNotSilent) {
  for (const Duration gap : {240ms, 340ms, 500ms, 1000ms, 3000ms})
    EXPECT_FALSE(silence_after({gap, gap, gap, gap, gap, gap, gap, gap})) << gap.count();
}

TEST(Monitor, NotesSinceWhenAnswersAreMissing) {
  Watched watched(rule(kHeard));
  work_until(watched, 5s);
  const ComponentState& state = watched.knowledge.components[ComponentId(0)];
  const Time begin = state.answered;
  watched.observe(6s, Probed{ComponentId(0), false});
  watched.observe(7s, Probed{ComponentId(0), true});
  watched.observe(8s, Probed{ComponentId(0), false});
  watched.observe(9s, Probed{ComponentId(0), false});
  EXPECT_EQ(state.missed_since - begin, 3s);
}

TEST(Monitor, ALocalNodeHangsThatNeitherAnswersNorPublishes) {
  Watched watched(rule(kHeard));
  const auto is_alive = [&] { return watched.knowledge.components[ComponentId(0)].alive; };
  work_until(watched, 5s);
  watched.observe(5400ms, Probed{ComponentId(0), false});
  watched.observe(5800ms, Probed{ComponentId(0), false});
  EXPECT_EQ(is_alive(), true) << "it was heard a moment ago";
  watched.observe(6200ms, Probed{ComponentId(0), false});
  EXPECT_EQ(is_alive(), false);
  watched.observe(6300ms, Probed{ComponentId(0), true});
  EXPECT_EQ(is_alive(), true);
}

TEST(Monitor, ALocalNodeIsAtWorkThatPublishesOrPausesAsEver) {
  Watched watched(rule(kHeard));
  const auto is_alive = [&] { return watched.knowledge.components[ComponentId(0)].alive; };
  work_until(watched, 5s);
  for (Duration at = 5s; at < 8s; at += 100ms) {
    watched.observe(at, SampleArrived{TopicId(0), 1});
    watched.observe(at, Probed{ComponentId(0), false});
  }
  EXPECT_EQ(is_alive(), true) << "it is busy";
  watched.observe(8s, Probed{ComponentId(0), true});
  watched.observe(11s, SampleArrived{TopicId(0), 1});  // a pause of 3.1 s, and it was well
  for (Duration at = 11s; at < 15s; at += 400ms) watched.observe(at, Probed{ComponentId(0), false});
  EXPECT_EQ(is_alive(), true);
  watched.observe(16s, Probed{ComponentId(0), false});
  EXPECT_EQ(is_alive(), false);
}

// Real robots showed it: after an outage of its camera, a detector that hung was taken for busy for as long as that had been.
TEST(Monitor, WhatALocalNodeWasSilentForWhileWhatItNeedsWasDownIsNoPauseOfItsOwn) {
  Watched watched("COMPONENT d NODE /d\n" + rule(kHeard));
  const auto probe = [&](Duration at, bool answers) {
    watched.observe(at, Probed{ComponentId(1), answers});
  };
  watched.observe(1s, NodeAppeared{"/d", 8});
  watched.observe(1s, EndpointAppeared{"/d", EndpointKind::kPublisher, "/in"});
  watched.observe(1s, EndpointAppeared{"/c", EndpointKind::kSubscriber, "/in"});
  work_until(watched, 5s);
  probe(5s, true);
  watched.observe(5s, NodeVanished{"/d"});
  watched.observe(8s, NodeAppeared{"/d", 9});
  watched.observe(8s, EndpointAppeared{"/d", EndpointKind::kPublisher, "/in"});
  for (Duration at = 8200ms; at < 10s; at += 100ms)
    watched.observe(at, SampleArrived{TopicId(0), 1});
  for (const Duration at : {10400ms, 10800ms, 11200ms}) probe(at, false);
  EXPECT_EQ(watched.knowledge.components[ComponentId(1)].alive, false);
}

TEST(Monitor, ALocalNodeIsNotAtWorkBecauseAnotherOnePublishes) {
  Watched watched(rule("!alive(c) || age(/t) > 1h || age(/u) > 1h || age(/v) > 1h"));
  work_until(watched, 5s);
  watched.observe(5s, NodeAppeared{"/d", 8});
  for (const char* topic : {"/u", "/v"})
    watched.observe(5s, EndpointAppeared{"/d", EndpointKind::kPublisher, topic});
  watched.observe(5s, EndpointAppeared{"/c", EndpointKind::kPublisher, "/v"});
  for (Duration at = 5s; at < 8s; at += 100ms) {
    watched.observe(at, SampleArrived{TopicId(1), 1});
    watched.observe(at, SampleArrived{TopicId(2), 1});
    watched.observe(at, Probed{ComponentId(0), false});
  }
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].alive, false);
}

// As one in a container may be, or on another computer.
TEST(Monitor, ANodeOfAnUnknownProcessIsAtWorkWhileItIsHeardToo) {
  Watched watched(rule(kHeard));
  watched.observe(1s, NodeAppeared{"/c", 0});
  watched.observe(1s, EndpointAppeared{"/c", EndpointKind::kPublisher, "/t"});
  for (Duration at = 1s; at < 5s; at += 100ms) {
    watched.observe(at, SampleArrived{TopicId(0), 1});
    watched.observe(at, Probed{ComponentId(0), at < 3s});
  }
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].alive, true) << "it is busy";
  watched.observe(5800ms, Probed{ComponentId(0), false});
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].alive, true);
  watched.observe(6s, Probed{ComponentId(0), false});
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].alive, false);
}

TEST(Monitor, ANodeThatNeverAnsweredProvesNothingByNotAnswering) {
  Watched watched(rule(kHeard));
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(1s, EndpointAppeared{"/c", EndpointKind::kPublisher, "/t"});
  for (Duration at = 1s; at < 3s; at += 100ms) watched.observe(at, SampleArrived{TopicId(0), 1});
  for (Duration at = 3s; at < 60s; at += 400ms) watched.observe(at, Probed{ComponentId(0), false});
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].alive, true);
}

TEST(Monitor, ALocalNodeOfWhichNothingElseIsHeardHangsIfItDoesNotAnswerForLong) {
  Watched watched(rule("!alive(c)"));
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(1s, Probed{ComponentId(0), true});
  for (Duration at = 2s; at < 3600ms; at += 400ms)
    watched.observe(at, Probed{ComponentId(0), false});
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].alive, true);
  watched.observe(3600ms, Probed{ComponentId(0), false});
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].alive, false);
}

TEST(Monitor, ALocalNodeThatWasHeardOnceIsGivenAsLongAsOneThatNeverWas) {
  Watched watched(rule(kHeard));
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(1s, EndpointAppeared{"/c", EndpointKind::kPublisher, "/t"});
  watched.observe(1s, SampleArrived{TopicId(0), 1});
  watched.observe(1s, Probed{ComponentId(0), true});
  for (Duration at = 3s; at < 4600ms; at += 400ms)
    watched.observe(at, Probed{ComponentId(0), false});
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].alive, true) << "it has no rhythm yet";
  watched.observe(4600ms, Probed{ComponentId(0), false});
  EXPECT_EQ(watched.knowledge.components[ComponentId(0)].alive, false);
}

TEST(Monitor, EndsOfANodeThatBeganAnewAreAwaitedForAWhile) {
  Watched watched(
      "COMPONENT c NODE /c\nCOMPONENT d NODE /d\nRULE R\nPOLICIES ERROR\n"
      "TRIGGER !alive(c) || !alive(d)\nSTRATEGY s 50 10\nADAPTATION c activate 1\n");
  const auto depends = [&] { return !watched.knowledge.graph.upstream(ComponentId(0)).empty(); };
  const auto& c = watched.knowledge.components[ComponentId(0)];
  const EndpointAppeared end{"/c", EndpointKind::kSubscriber, "/from_d"};
  watched.observe(1s, NodeAppeared{"/d", 6});
  watched.observe(1s, EndpointAppeared{"/d", EndpointKind::kPublisher, "/from_d"});
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(1s, end);
  const auto begins_anew = [&](Duration at, int pid) {
    watched.observe(at, EndpointVanished{"/c", EndpointKind::kSubscriber, "/from_d"});
    watched.observe(at, NodeVanished{"/c"});
    watched.observe(at, NodeAppeared{"/c", pid});
  };
  begins_anew(2s, 8);
  EXPECT_TRUE(depends()) << "it opens its device first";
  EXPECT_GT(c.awaits_ends_until, Time(2s));
  watched.observe(5s, end);
  EXPECT_TRUE(depends());
  EXPECT_EQ(c.awaits_ends_until, kLongAgo);
  EXPECT_EQ(c.ends_back, Time(5s));
  begins_anew(6s, 9);
  watched.monitor.advance(Time(15900ms));
  EXPECT_TRUE(depends());
  watched.monitor.advance(Time(16s));
  EXPECT_FALSE(depends()) << "it does not have that end any more";
}

// `run --launch` brings nodes up before the manager begins, which sees them only then.
TEST(Monitor, ANodeThatCulpritBroughtUpBeforeAndThatCrashedIsLeftToItself) {
  Watched watched(rule("!alive(c)"));
  const auto& c = watched.knowledge.components[ComponentId(0)];
  const ComingUp by_culprit{ComingUp::Driver::kCulprit, 300ms, 50ms};
  watched.monitor.remember(History{{Time(3s), CameUp{ComponentId(0), by_culprit}}});
  watched.observe(5s, NodeAppeared{"/c", 7});
  watched.observe(5500ms, NodeVanished{"/c"});
  EXPECT_EQ(c.coming_up.driver, ComingUp::Driver::kOther);
  EXPECT_EQ(c.coming_up.rising, 2500ms) << "the next one is left more time than that";
  watched.monitor.remember(History{{Time(6s), CameUp{ComponentId(0), by_culprit}}});
  watched.observe(7s, NodeAppeared{"/c", 8});
  watched.observe(8s, NodeVanished{"/c"});
  EXPECT_EQ(c.coming_up.driver, ComingUp::Driver::kCulprit) << "that was another process";
}

TEST(Monitor, AManagedNodeHangsWhoseTransitionTakesMuchLongerThanEver) {
  Watched watched(rule("!alive(c) || lifecycle(c) != \"active\""));
  const auto& c = watched.knowledge.components[ComponentId(0)];
  watched.knowledge.components[ComponentId(0)].coming_up.rising = 1s;
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(1s, LifecycleRead{ComponentId(0), Lifecycle::kInactive});
  watched.observe(1s, Probed{ComponentId(0), true});
  watched.observe(2s, LifecycleRead{ComponentId(0), Lifecycle::kTransition});
  for (Duration at = 2s; at < 6s; at += 400ms) watched.observe(at, Probed{ComponentId(0), false});
  EXPECT_EQ(c.alive, true) << "it has one thread, and that one is at work";
  watched.observe(6s, Probed{ComponentId(0), false});
  EXPECT_EQ(c.alive, false);
  EXPECT_TRUE(c.hangs());
  watched.knowledge.components[ComponentId(0)].coming_up.rising = 5s;  // the next gets more
  watched.observe(6400ms, Probed{ComponentId(0), false});
  EXPECT_TRUE(c.hangs());
}

TEST(Monitor, ATransitionThatTakesTooLongIsAStateAlsoWhereTheNodeAnswers) {
  Watched watched(rule("lifecycle(c) != \"active\""));
  const auto fires = [&] { return watched.knowledge.signals[InputId(0)]; };
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(1s, LifecycleRead{ComponentId(0), Lifecycle::kTransition});
  watched.observe(60s, Probed{ComponentId(0), true});
  EXPECT_FALSE(fires().known) << "somebody else asked for it, and it may be slow";
  watched.observe(61s, Probed{ComponentId(0), true});
  EXPECT_TRUE(fires().known);
  watched.observe(61s, LifecycleRead{ComponentId(0), Lifecycle::kTransition});
  EXPECT_TRUE(fires().known) << "it is read again";
  watched.observe(62s, LifecycleRead{ComponentId(0), Lifecycle::kActive});
  EXPECT_TRUE(fires().known);
}

TEST(Monitor, EndsStayWhileANodeIsBroughtUp) {
  Watched watched(
      "COMPONENT c NODE /c\nCOMPONENT d NODE /d\nRULE R\nPOLICIES ERROR\n"
      "TRIGGER !alive(c) || !alive(d)\nSTRATEGY s 50 10\nADAPTATION c activate 1\n");
  const auto depends = [&] { return !watched.knowledge.graph.upstream(ComponentId(0)).empty(); };
  const EndpointVanished gone{"/c", EndpointKind::kSubscriber, "/from_d"};
  watched.observe(1s, NodeAppeared{"/d", 6});
  watched.observe(1s, EndpointAppeared{"/d", EndpointKind::kPublisher, "/from_d"});
  watched.observe(1s, NodeAppeared{"/c", 7});
  watched.observe(1s, EndpointAppeared{"/c", EndpointKind::kSubscriber, "/from_d"});
  watched.observe(1s, LifecycleRead{ComponentId(0), Lifecycle::kActive});
  EXPECT_TRUE(depends());
  watched.observe(2s, gone);
  watched.observe(2s, NodeVanished{"/c"});
  watched.observe(3s, NodeAppeared{"/c", 8});
  watched.observe(3s, LifecycleRead{ComponentId(0), Lifecycle::kUnconfigured});
  EXPECT_TRUE(depends()) << "it is not configured yet";
  watched.observe(4s, LifecycleRead{ComponentId(0), Lifecycle::kActive});
  EXPECT_FALSE(depends()) << "it came up without that end";
}

}  // namespace
}  // namespace culprit
