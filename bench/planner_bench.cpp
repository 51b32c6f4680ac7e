// What a planning step of the bayes planner costs: many failures at once on a large robot, and a
// few on a usual one. The processor's time: other programs on this machine do not count.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "claims.h"
#include "knowledge/condensation.h"
#include "language/checker.h"
#include "plan/bayes/bayes_planner.h"
#include "simulation/random.h"

namespace culprit::bench {
namespace {

// That this thread has had.
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
// a hundred also feeds an earlier one, so that there are circles. Gives who reads whose output.
struct Link {
  std::size_t producer;
  std::size_t consumer;
};
std::vector<Link> connect(Knowledge& knowledge, std::size_t components, std::size_t inputs) {
  std::vector<Link> links;
  simulation::Random random(1);
  const std::size_t width = std::max<std::size_t>(inputs, components / 10);
  const auto link = [&](std::size_t producer, std::size_t consumer) {
    const std::string topic = "/" + name(producer) + "/out";
    knowledge.graph.endpoint_appeared("/" + name(producer), EndpointKind::kPublisher, topic);
    knowledge.graph.endpoint_appeared("/" + name(consumer), EndpointKind::kSubscriber, topic);
    links.push_back({producer, consumer});
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
  return links;
}

// What it costs to know again who depends on whom when an edge goes and comes again, as a share of
// finding that from nothing.
void claim_incremental_updates(DependencyGraph& graph, const std::vector<Link>& links) {
  constexpr int kAnew = 20;
  double begin = processor_seconds();
  for (int i = 0; i < kAnew; ++i) {
    ChannelEdges edges(graph.size());
    graph.for_each_channel(
        [&](auto producers, auto consumers) { edges.add(producers, consumers); });
    benchmark::DoNotOptimize(Condensation(edges.vertices(), edges.edges()));
  }
  const double anew = (processor_seconds() - begin) / kAnew;

  constexpr int kChanges = 2000;
  simulation::Random random(2);
  graph.condensation();
  double seconds = 0;
  double slowest = 0;
  for (int i = 0; i < kChanges; ++i) {
    const Link& link = links[random.next() % links.size()];
    const std::string node = "/" + name(link.consumer);
    const std::string topic = "/" + name(link.producer) + "/out";
    begin = processor_seconds();
    graph.endpoint_vanished(node, EndpointKind::kSubscriber, topic);
    graph.condensation();
    graph.endpoint_appeared(node, EndpointKind::kSubscriber, topic);
    graph.condensation();
    const double now = (processor_seconds() - begin) / 2;
    seconds += now;
    slowest = std::max(slowest, now);
  }
  const std::string what = "an edge goes or comes, who depends on whom included, beside " +
                           std::to_string(std::lround(1e6 * anew)) + " us from nothing";
  claim(what + ", mean", 100 * seconds / kChanges / anew, 5, "%");
  claim(what + ", slowest", 100 * slowest / anew, 100, "%");
}

void planning_step(benchmark::State& state) {
  const auto components = static_cast<std::size_t>(state.range(0));
  const auto failing = static_cast<std::size_t>(state.range(1));
  const RuleSet rules = rules_for(components);
  Knowledge knowledge(rules);
  const std::vector<Link> links = connect(knowledge, components, 5);
  knowledge.now = Time(std::chrono::seconds(100));
  for (std::size_t r = 0; r < components; ++r)
    knowledge.states.state(RuleId(r)).detection.trigger = Slot::of(false);
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
  const std::string what = "a plan for " + std::to_string(failing) + " failures on " +
                           std::to_string(components) + " components, processor";
  claim(what, unit * warm, is_large ? 10 : 50, is_large ? "ms" : "us");
  claim(what + ", new graph", unit * cold, is_large ? 10 : 50, is_large ? "ms" : "us");
  claim("an edge of the graph of " + std::to_string(components) + " components changes, processor",
        1e9 * change, 1000, "ns");
  if (is_large) claim_incremental_updates(knowledge.graph, links);
}
BENCHMARK(planning_step)->Args({50, 5})->Args({10000, 1000});

}  // namespace
}  // namespace culprit::bench
