// The load that culprit puts on a robot, as a process beside it.
#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>

#include "claims.h"
#include "live.h"

namespace culprit::bench {
namespace {

using namespace std::chrono_literals;

// A component for each node, and a rule for each of the first topics of each that has some.
std::string fleet_rules(int nodes, int topics, int every = 1) {
  std::string text = "ROBOT fleet\n";
  for (int n = 0; n < nodes; ++n) {
    const std::string name = "node_" + std::to_string(n);
    text += "COMPONENT " + name + " NODE /" + name + "\n";
    for (int t = 0; n % every == 0 && t < topics; ++t) {
      const std::string topic = "/" + name + "/value_" + std::to_string(t);
      text += "RULE Silent_" + name + "_" + std::to_string(t) +
              "\n  POLICIES ERROR\n  TRIGGER age(" + topic + ") > 1s || rate(" + topic +
              ", 2s) > 1000\n    STRATEGY restart 50 10\n      ADAPTATION " + name + " restart 5\n";
    }
  }
  return text;
}

// Five processes of ten nodes each, four topics a node, all of them watched by a rule; then recorded, too.
void fleet(benchmark::State& state) {
  const World world;
  std::vector<std::unique_ptr<Child>> robots;
  for (int i = 0; i < 5; ++i)
    robots.push_back(
        std::make_unique<Child>(world, "culprit-bench-peer",
                                std::vector<std::string>{"fleet", std::to_string(i), "10", "4"}));
  const std::string rules = world.write("fleet.rules", fleet_rules(50, 4)).string();
  const std::string idle = world.write("idle.rules", fleet_rules(50, 0)).string();
  const auto load_of = [&](const std::string& file, std::vector<std::string> options) {
    options.insert(options.begin(), {"run", file, "--dry-run"});
    const Child culprit(world, "culprit", options);
    std::this_thread::sleep_for(7s);
    const double cpu = cpu_percent(culprit.pid(), 8s);
    return std::pair(cpu, usage_of(culprit.pid()).resident_mib);
  };
  std::pair<double, double> watched;
  std::pair<double, double> recorded;
  std::pair<double, double> reads_nothing;
  for (auto _ : state) {
    reads_nothing = load_of(idle, {});
    watched = load_of(rules, {});
    recorded =
        load_of(rules, {"--record", "--record-folder", (world.folder() / "recordings").string()});
  }
  state.counters["cpu_percent"] = watched.first;
  claim("idle beside 50 nodes, no topic read: processor", reads_nothing.first, 1, "% of a core");
  claim("50 nodes, 200 topics, 2,000 samples/s: processor", watched.first, 3, "% of a core");
  claim("50 nodes, 200 topics, 2,000 samples/s: memory", watched.second, 64, "MiB");
  claim("the same, all of it recorded: processor for that", recorded.first - watched.first, 2,
        "% of a core");
}
BENCHMARK(fleet)->Iterations(1)->Unit(benchmark::kSecond);

int count_of(std::string_view what, std::string_view text) {
  int count = 0;
  for (auto at = text.find(what); at != text.npos; at = text.find(what, at + 1)) ++count;
  return count;
}

// Ten processes of twenty nodes each, five topics a node, of which rules read a tenth.
void large_robot(benchmark::State& state) {
  constexpr int kNodes = 200;
  const World world;
  std::vector<std::unique_ptr<Child>> robots;
  for (int i = 0; i < 10; ++i)
    robots.push_back(
        std::make_unique<Child>(world, "culprit-bench-peer",
                                std::vector<std::string>{"fleet", std::to_string(i), "20", "5"}));
  const std::string rules = world.write("large.rules", fleet_rules(kNodes, 5, 10)).string();
  std::this_thread::sleep_for(6s);
  double found = 0;
  double used = 0;
  double memory = 0;
  for (auto _ : state) {
    const auto begin = std::chrono::steady_clock::now();
    const Child culprit(world, "culprit", {"run", rules, "--dry-run"});
    const auto elapsed = [&] {
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    };
    while (count_of(" is there", culprit.output()) < kNodes && elapsed() < 20)
      std::this_thread::sleep_for(20ms);
    found = elapsed();
    std::this_thread::sleep_for(2s);
    used = cpu_percent(culprit.pid(), 6s);
    memory = usage_of(culprit.pid()).resident_mib;
  }
  state.counters["cpu_percent"] = used;
  const std::string robot = "200 nodes, 1,000 topics, 10,000 samples/s, a tenth read: ";
  claim(robot + "all nodes found", found, 10, "s");
  claim(robot + "processor", used, 12, "% of a core");
  claim(robot + "memory", memory, 128, "MiB");
}
BENCHMARK(large_robot)->Iterations(1)->Unit(benchmark::kSecond);

// Ten processes of twenty nodes each, all of them well: each publishes, and reads what another does.
void doctor(benchmark::State& state) {
  const World world;
  std::vector<std::unique_ptr<Child>> robots;
  for (int i = 0; i < 10; ++i)
    robots.push_back(
        std::make_unique<Child>(world, "culprit-bench-peer",
                                std::vector<std::string>{"robot", std::to_string(i), "10", "20"}));
  std::this_thread::sleep_for(10s);
  double elapsed = 0;
  double used = 0;
  int exit_code = -1;
  for (auto _ : state) {
    const auto begin = std::chrono::steady_clock::now();
    Child doctor(world, "culprit", {"doctor"});
    const Child::Ended ended = doctor.wait();
    elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    used = ended.cpu_seconds;
    exit_code = ended.exit_code;
  }
  state.counters["cpu_percent"] = 100 * used / elapsed;
  claim("doctor, 200 nodes in ten processes: until it has spoken", elapsed, 10, "s");
  claim("the same: processor", 100 * used / elapsed, 5, "% of a core");
  claim("the same, all of them well: exit code", exit_code, 0, "");
}
BENCHMARK(doctor)->Iterations(1)->Unit(benchmark::kSecond);

constexpr const char* kImageRules = R"(
COMPONENT images NODE /images
RULE Silent
  POLICIES ERROR
  TRIGGER age(/bench/image) > 1s && rate(/bench/image, 2s) > 1000
    STRATEGY restart 50 10
      ADAPTATION images restart 5
)";

// The two readers take turns, so that neither pays for the other.
void big_pictures(benchmark::State& state) {
  const World world;
  const Child source(world, "culprit-bench-peer", {"images"});
  const std::string rules = world.write("image.rules", kImageRules).string();
  double bare = 0;
  double watched = 0;
  for (auto _ : state) {
    constexpr int kRounds = 2;
    for (int round = 0; round < kRounds; ++round) {
      {
        const Child reader(world, "culprit-bench-peer", {"bare-reader"});
        std::this_thread::sleep_for(2s);
        bare += cpu_percent(reader.pid(), 3s) / kRounds;
      }
      const Child culprit(world, "culprit", {"run", rules, "--dry-run"});
      std::this_thread::sleep_for(2s);
      watched += cpu_percent(culprit.pid(), 3s) / kRounds;
    }
  }
  state.counters["bare_reader_percent"] = bare;
  state.counters["culprit_percent"] = watched;
  claim("watching 1080p pictures at 30 Hz, beside a bare Fast DDS reader", watched / bare, 1.2,
        "times");
}
BENCHMARK(big_pictures)->Iterations(1)->Unit(benchmark::kSecond);

}  // namespace
}  // namespace culprit::bench
