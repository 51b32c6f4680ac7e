// What a planning step of the bayes planner costs: many failures at once on a large robot, and a
// few on a usual one.
#include <chrono>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "claims.h"
#include "language/checker.h"
#include "live.h"
#include "plan/bayes/bayes_planner.h"
#include "simulation/random.h"

namespace culprit::bench {
namespace {

using Clock = std::chrono::steady_clock;

std::string name(std::size_t i) { return "c" + std::to_string(i); }

RuleSet rules_for(std::size_t components) {
  std::string text;
  for (std::size_t i = 0; i < components; ++i) {
    text += "COMPONENT " + name(i) + " NODE /" + name(i) + " LAUNCH \"" + name(i) + "\"\nRULE R" +
            name(i) + "\nPOLICIES ERROR\nTRIGGER s" + name(i) +
            " > 1\nSTRATEGY restart 40 10\nADAPTATION " + name(i) +
            " restart 5\nSTRATEGY redeploy 60 10\nADAPTATION " + name(i) + " redeploy 20\n";
  }
  return *check(Source("bench.rules", text)).rules;
}

// A layered pipeline: each component reads `inputs` of the ten layers' width before it, and one in
// a hundred also feeds an earlier one, so that there are circles.
void connect(Knowledge& knowledge, std::size_t components, std::size_t inputs) {
  simulation::Random random(1);
  const std::size_t width = std::max<std::size_t>(inputs, components / 10);
  const auto link = [&](std::size_t producer, std::size_t consumer) {
    const std::string topic = "/" + name(producer) + "/out";
    knowledge.graph.endpoint_appeared("/" + name(producer), EndpointKind::kPublisher, topic);
    knowledge.graph.endpoint_appeared("/" + name(consumer), EndpointKind::kSubscriber, topic);
  };
  for (std::size_t i = 0; i < components; ++i) {
    knowledge.graph.node_appeared("/" + name(i));
    ComponentState& state = knowledge.components[ComponentId(i)];
    state.alive = true;
    state.lifecycle = Lifecycle::kActive;
    const auto earlier = std::min(i, width);
    for (std::size_t k = 0; k < inputs && earlier > 0; ++k)
      link(i - 1 - random.next() % earlier, i);
    if (i % 100 == 99) link(i, i - 1 - random.next() % earlier);
  }
}

void planning_step(benchmark::State& state) {
  const auto components = static_cast<std::size_t>(state.range(0));
  const auto failing = static_cast<std::size_t>(state.range(1));
  const RuleSet rules = rules_for(components);
  Knowledge knowledge(rules);
  connect(knowledge, components, 5);
  knowledge.now = Time(std::chrono::seconds(100));
  for (std::size_t r = 0; r < components; ++r)
    knowledge.states.state(RuleId(r)).trigger = Slot::of(false);
  std::vector<RuleId> failures;
  for (std::size_t f = 0; f < failing; ++f) {
    failures.emplace_back(f * components / failing);
    knowledge.states.state(failures.back()).trigger = Slot::of(true);
    knowledge.states.state(failures.back()).failing_since = Time(std::chrono::seconds(90));
    knowledge.states.enter(failures.back(), RulePhase::kFailing);
  }
  const BayesPlanner planner;
  const auto seconds_of_a_step = [&] {
    const auto begin = Clock::now();
    benchmark::DoNotOptimize(planner.plan(failures, knowledge));
    return std::chrono::duration<double>(Clock::now() - begin).count();
  };
  for (auto _ : state) seconds_of_a_step();

  std::vector<double> warm(50);
  for (double& each : warm) each = seconds_of_a_step();
  std::vector<double> cold(50);  // an edge of the graph has just changed
  for (double& each : cold) {
    knowledge.graph.endpoint_appeared("/" + name(0), EndpointKind::kSubscriber, "/extra");
    knowledge.graph.endpoint_vanished("/" + name(0), EndpointKind::kSubscriber, "/extra");
    each = seconds_of_a_step();
  }
  const bool is_large = components > 1000;
  const double unit = is_large ? 1e3 : 1e6;
  const std::string what = "a plan for " + std::to_string(failing) + " failures on " +
                           std::to_string(components) + " components";
  claim(what + ", median", unit * quantile(warm, 0.5), is_large ? 10 : 50, is_large ? "ms" : "us");
  claim(what + ", the graph has just changed: median", unit * quantile(cold, 0.5),
        is_large ? 10 : 50, is_large ? "ms" : "us");
}
BENCHMARK(planning_step)->Args({50, 5})->Args({10000, 1000});

}  // namespace
}  // namespace culprit::bench
