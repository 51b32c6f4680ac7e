// The core alone: what a trigger costs, and what a step costs when one of many signals changed.
#include <chrono>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "allocations.h"
#include "claims.h"
#include "language/checker.h"
#include "language/evaluate.h"
#include "live.h"
#include "manager/manager.h"
#include "plan/paper_planner.h"

namespace culprit::bench {
namespace {

using Clock = std::chrono::steady_clock;

RuleSet many_rules(int count) {
  std::string text = "COMPONENT c NODE /c LAUNCH \"c\"\n";
  for (int i = 0; i < count; ++i) {
    const std::string n = std::to_string(i);
    text += "RULE R" + n + "\nPOLICIES ERROR\nTRIGGER s" + n + " > 0.06 && age(/t" + n +
            ") < 1s || s" + n + " > 100\nSTRATEGY s 50 10\nADAPTATION c restart 5\n";
  }
  return *check(Source("bench.rules", text)).rules;
}

// Claim: at most 100 ns for a trigger.
void trigger(benchmark::State& state) {
  const RuleSet rules = many_rules(1);
  std::vector<Slot> inputs(rules.inputs.size());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    inputs[i] = rules.inputs[i].type == Type::kDuration ? Slot::of(Duration(5)) : Slot::of(0.05);
  }
  const auto begin = Clock::now();
  std::uint64_t count = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(evaluate(rules.rules[0].trigger, inputs));
    ++count;
  }
  const double nanoseconds = std::chrono::duration<double, std::nano>(Clock::now() - begin).count();
  claim("a trigger, mean", nanoseconds / static_cast<double>(count), 100, "ns");
}
BENCHMARK(trigger);

// A step costs what changed, not what exists: 10,000 rules cost what 10 cost.
void step(benchmark::State& state) {
  const RuleSet rules = many_rules(static_cast<int>(state.range(0)));
  Manager manager(rules, std::make_unique<PaperPlanner>(), {});
  Time now{};
  double value = 0;
  std::vector<Observation> observation(1);
  const auto once = [&] {
    now += std::chrono::milliseconds(1);
    value = value == 0.01 ? 0.02 : 0.01;
    observation[0] = {now, SignalRead{SignalId(0), Value(value)}};
    benchmark::DoNotOptimize(manager.step(now, observation));
  };
  for (int i = 0; i < 100'000; ++i) once();  // until all was told that is told once
  const std::uint64_t before = allocations();
  for (auto _ : state) once();
  const auto made = static_cast<double>(allocations() - before);

  std::vector<double> nanoseconds(20'000);  // each with the clock's own cost
  for (double& each : nanoseconds) {
    const auto begin = Clock::now();
    once();
    each = std::chrono::duration<double, std::nano>(Clock::now() - begin).count();
  }
  const std::string what = "a manager step with " + std::to_string(state.range(0)) + " rules";
  claim(what + ", one signal changed: median", quantile(nanoseconds, 0.5), 2000, "ns");
  claim(what + ": allocations in all steps of the run", made, 2, "");
}
BENCHMARK(step)->Arg(10)->Arg(10000);

}  // namespace
}  // namespace culprit::bench
