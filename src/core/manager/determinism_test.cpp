// The manager's promise: its decisions depend on the observations and their times, not on when it
// happens to be stepped.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "language/checker.h"
#include "manager/manager.h"
#include "manager/test_robot.h"

namespace culprit::test {
namespace {

constexpr const char* kRules = R"(
COMPONENT c NODE /c LAUNCH "c"
SIGNAL s DIAGNOSTIC d KEY k STALE 700ms
RULE Age
  POLICIES ERROR FOR 100ms
  TRIGGER age(/a) > 250ms
    STRATEGY s 50 10
      ADAPTATION c restart 2
RULE Rate
  POLICIES ERROR
  TRIGGER rate(/a, 1s) < 4
    STRATEGY s 50 10
      ADAPTATION c restart 2
RULE Phi
  POLICIES WARNING
  TRIGGER phi(/b) > 5
    STRATEGY s 50 10
      ADAPTATION c restart 2
RULE Mean
  POLICIES WARNING HOLD 2/4
  TRIGGER mean(s, 1s) > 0.5
    STRATEGY s 50 10
      ADAPTATION c restart 2
RULE Signal
  POLICIES NON_CRITICAL COOLDOWN 500ms
  TRIGGER s > 0.8 || changed(s) && stddev(s, 2s) > 0.4
    STRATEGY s 50 10
      ADAPTATION c restart 2
)";

struct Line {
  Time at;
  std::string text;
  bool operator==(const Line&) const = default;
};

// Drives a dry-running manager over `observations`, at its own deadlines and at `extra` times.
std::vector<Line> run(const RuleSet& rules, const std::vector<Observation>& observations,
                      std::vector<Time> extra) {
  Manager manager(rules, std::make_unique<BayesPlanner>(), {Autonomy::kAdvise});
  std::vector<Line> lines;
  const Time end = observations.empty() ? Time{} : observations.back().at + 10s;
  std::size_t next = 0;
  std::size_t next_extra = 0;
  Time now{};
  while (now < end) {
    Time step = std::min(end, std::max(now, manager.next_deadline()));
    if (next < observations.size()) step = std::min(step, observations[next].at);
    if (next_extra < extra.size()) step = std::min(step, std::max(now, extra[next_extra]));
    now = step;
    while (next_extra < extra.size() && extra[next_extra] <= now) ++next_extra;
    std::vector<Observation> batch;
    while (next < observations.size() && observations[next].at <= now)
      batch.push_back(observations[next++]);
    manager.step(now, batch);
    for (const Event& event : manager.events()) lines.push_back({event.at, describe(event, rules)});
    if (manager.next_deadline() <= now) {
      // A deadline that does not move on would be an endless loop in the live runtime.
      const Time before = now;
      manager.step(now, {});
      RC_ASSERT(manager.next_deadline() > before);
    }
  }
  return lines;
}

std::vector<Observation> random_observations() {
  std::vector<Observation> all;
  Time now{};
  const int count = *rc::gen::inRange(20, 300);
  for (int i = 0; i < count; ++i) {
    now += std::chrono::milliseconds(
        *rc::gen::weightedElement<int>({{20, 10}, {20, 33}, {10, 70}, {1, 900}, {1, 3000}}));
    switch (*rc::gen::inRange(0, 3)) {
      case 0:
        all.push_back({now, SampleArrived{TopicId(0), *rc::gen::inRange<std::uint32_t>(1, 3)}});
        break;
      case 1:
        all.push_back({now, SampleArrived{TopicId(1), 1}});
        break;
      default:
        all.push_back({now, SignalRead{SignalId(0), Value(*rc::gen::element(0.0, 0.3, 0.6, 0.9))}});
        break;
    }
  }
  return all;
}

RC_GTEST_PROP(Manager, DoesTheSameHoweverOftenItIsStepped, ()) {
  const Checked checked = check(Source("test.rules", kRules));
  const std::vector<Observation> observations = random_observations();
  std::vector<Time> extra;
  Time t{};
  for (int i = *rc::gen::inRange(0, 400); i > 0; --i)
    extra.push_back(t += std::chrono::milliseconds(*rc::gen::inRange(1, 60)));
  const auto calm = run(*checked.rules, observations, {});
  const auto busy = run(*checked.rules, observations, extra);
  for (std::size_t i = 0; i < std::min(calm.size(), busy.size()); ++i) {
    if (!(calm[i] == busy[i])) {
      RC_LOG() << seconds(calm[i].at.time_since_epoch()) << " " << calm[i].text << "\n"
               << seconds(busy[i].at.time_since_epoch()) << " " << busy[i].text << "\n";
      break;
    }
  }
  RC_ASSERT(calm == busy);
}

}  // namespace
}  // namespace culprit::test
