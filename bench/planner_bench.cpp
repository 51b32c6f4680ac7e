// The cost of a planning step of the bayes planner: many failures at once on a large robot, and a
// few on a usual one. Processor time is measured, so other programs on this machine do not count.
#include <algorithm>
#include <chrono>
#include <ctime>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "claims.h"
#include "language/checker.h"
#include "plan/bayes/bayes_planner.h"
#include "simulation/random.h"

namespace culprit::bench {
namespace {

// The processor time of this thread.
double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

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
    knowledge.discovered.note(ComponentId(i), Time());
    const auto earlier = std::min(i, width);
    for (std::size_t k = 0; k < inputs && earlier > 0; ++k)
      link(i - 1 - random.next() % earlier, i);
    if (i % 100 == 99) link(i, i - 1 - random.next() % earlier);
  }
}

// The cost of updating the graph's condensation (feedback loops included) after an edge has
// changed.
double seconds_of_condensing(DependencyGraph& graph) {
  constexpr int kTimes = 100;
  double least = 1;
  for (int i = 0; i < kTimes; ++i) {
    graph.endpoint_appeared("/" + name(0), EndpointKind::kSubscriber, "/" + name(1) + "/out");
    const double begin = processor_seconds();
    benchmark::DoNotOptimize(graph.condensation());
    least = std::min(least, processor_seconds() - begin);
    graph.endpoint_vanished("/" + name(0), EndpointKind::kSubscriber, "/" + name(1) + "/out");
  }
  return least;
}

void planning_step(benchmark::State& state) {
  const auto components = static_cast<std::size_t>(state.range(0));
  const auto failing = static_cast<std::size_t>(state.range(1));
  const RuleSet rules = rules_for(components);
  Knowledge knowledge(rules);
  connect(knowledge, components, 5);
  knowledge.now = Time(std::chrono::seconds(100));
  for (std::size_t r = 0; r < components; ++r) {
    Detection& detection = knowledge.states.state(RuleId(r)).detection;
    detection.trigger = Slot::of(false);
    detection.last_false = knowledge.now;
  }
  std::vector<RuleId> failures;
  for (std::size_t f = 0; f < failing; ++f) {
    failures.emplace_back(f * components / failing);
    knowledge.states.state(failures.back()).detection.trigger = Slot::of(true);
    knowledge.states.state(failures.back()).failing_since = Time(std::chrono::seconds(90));
    knowledge.states.enter(failures.back(), RulePhase::kFailing);
  }
  const BayesPlanner planner;
  const auto seconds_of_a_step = [&] {
    const double begin = processor_seconds();
    benchmark::DoNotOptimize(planner.plan(failures, knowledge));
    return processor_seconds() - begin;
  };
  for (auto _ : state) seconds_of_a_step();

  const auto change_an_edge = [&, node = "/" + name(0), topic = "/" + name(1) + "/out"] {
    knowledge.graph.endpoint_appeared(node, EndpointKind::kSubscriber, topic);
    knowledge.graph.endpoint_vanished(node, EndpointKind::kSubscriber, topic);
  };
  // The least of several repetitions: what caches and clocks that others keep busy add is not ours.
  constexpr int kRepetitions = 50;
  double warm = seconds_of_a_step();
  double cold = warm + 1;  // an edge of the graph has just changed
  for (int i = 0; i < kRepetitions; ++i) {
    warm = std::min(warm, seconds_of_a_step());
    change_an_edge();
    cold = std::min(cold, seconds_of_a_step());
  }
  constexpr int kChanges = 1000;
  double change = 1;
  for (int i = 0; i < kRepetitions; ++i) {
    const double begin = processor_seconds();
    for (int c = 0; c < kChanges; ++c) change_an_edge();
    change = std::min(change, (processor_seconds() - begin) / (2 * kChanges));
  }
  const bool is_large = components > 1000;
  const double unit = is_large ? 1e3 : 1e6;
  const double limit = is_large ? 10 : static_cast<double>(components);
  const std::string what = "a plan for " + std::to_string(failing) + " failures on " +
                           std::to_string(components) + " components, processor";
  claim(what, unit * warm, limit, is_large ? "ms" : "us");
  claim(what + ", new graph", unit * cold, limit, is_large ? "ms" : "us");
  claim("an edge of the graph of " + std::to_string(components) + " components changes, processor",
        1e9 * change, 1000, "ns");
  claim("who depends on whom among " + std::to_string(components) +
            " components, found anew, processor",
        1e6 * seconds_of_condensing(knowledge.graph),
        is_large ? 2500 : static_cast<double>(components) / 10, "us");
}
BENCHMARK(planning_step)->Args({50, 5})->Args({200, 10})->Args({10000, 1000});

}  // namespace
}  // namespace culprit::bench
