// How soon a culprit that is started again judges: from exec to the first silence that it finds, on a
// robot that its journal knows.
#include <chrono>
#include <csignal>
#include <string>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>

#include "claims.h"
#include "live.h"

namespace culprit::bench {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr const char* kRules = R"(
ROBOT start
COMPONENT quiet NODE /quiet
COMPONENT other NODE /node_0
RULE QuietSilent
  POLICIES ERROR
  TRIGGER age(/quiet/value) > 350ms
    STRATEGY quiet_restart 90 10
      ADAPTATION quiet restart 5
RULE OtherSilent
  POLICIES ERROR
  TRIGGER age(/node_0/value_0) > 350ms
    STRATEGY other_restart 90 10
      ADAPTATION other restart 5
)";

bool says_within(const Child& culprit, const std::string& words, Clock::duration patience) {
  for (const auto end = Clock::now() + patience; Clock::now() < end;) {
    if (culprit.output().find(words) != std::string::npos) return true;
    std::this_thread::sleep_for(5ms);
  }
  return false;
}

void kill_hard(Child& child) {
  kill(child.pid(), SIGKILL);
  child.wait();
}

// One of two nodes falls silent while culprit is away; its process runs on.
void known_start(benchmark::State& state) {
  const World world;
  const std::string rules = world.write("start.rules", kRules);
  const std::vector<std::string> run{"run", rules, "--dry-run", "--state-dir", world.folder()};
  const Child other(world, "culprit-bench-peer", {"fleet", "0", "2"});
  const Child quiet(world, "culprit-bench-peer", {"quiet"});
  std::vector<double> all;
  for (auto _ : state) {
    Child before(world, "culprit", run);
    std::this_thread::sleep_for(8s);  // it sees the robot whole, and writes that down
    kill_hard(before);
    kill(quiet.pid(), SIGUSR1);
    std::this_thread::sleep_for(500ms);
    const auto began = Clock::now();
    Child again(world, "culprit", run);
    if (!says_within(again, "QuietSilent detected", 10s)) {
      state.SkipWithError("the silence was not found");
      return;
    }
    all.push_back(std::chrono::duration<double>(Clock::now() - began).count());
    if (again.output().find("OtherSilent detected") != std::string::npos) {
      state.SkipWithError("who speaks was taken for silent");
      return;
    }
    kill_hard(again);
    kill(quiet.pid(), SIGUSR1);
  }
  state.counters["p50_s"] = quantile(all, 0.5);
  state.counters["slowest_s"] = quantile(all, 1);
  claim("started again: exec to the first silence that is found, slowest of three",
        quantile(all, 1), 1.5, "s");
}
BENCHMARK(known_start)->Iterations(3)->Unit(benchmark::kSecond);

}  // namespace
}  // namespace culprit::bench
