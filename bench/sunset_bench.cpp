// SUNSET, the exemplar: what culprit costs it while nothing is wrong, and how soon it is well
// again.
#include <atomic>
#include <map>

#include <benchmark/benchmark.h>

#include "base/mutex.h"
#include "claims.h"
#include "demo/sunset_demo.h"
#include "live.h"

namespace culprit::bench {
namespace {

using namespace std::chrono_literals;

void idle(benchmark::State& state) {
  const World world;
  setenv("SUNSET_STATE", world.folder().c_str(), 1);
  std::vector<std::unique_ptr<Child>> robot;
  for (const char* name : {"world", "camera", "depth", "image_enhancement", "sensor_fusion",
                           "segmentation", "evaluator"})
    robot.push_back(std::make_unique<Child>(world, "sunset-node", std::vector<std::string>{name}));
  const Child culprit(world, "culprit", {"run", CULPRIT_SUNSET_RULES});
  std::this_thread::sleep_for(8s);
  double cpu = 0;
  for (auto _ : state) cpu = cpu_percent(culprit.pid(), 10s);
  state.counters["cpu_percent"] = cpu;
  claim("idle beside SUNSET: processor", cpu, 1.2, "% of a core");
  claim("idle beside SUNSET: memory", usage_of(culprit.pid()).resident_mib, 33, "MiB");
}
BENCHMARK(idle)->Iterations(1)->Unit(benchmark::kSecond);

// From the moment that a restart is found not to have helped to the end of the failure, with the
// redeployment in between: ordering it, the old process' end, the new one's start and first
// picture.
class RedeployClock {
 public:
  void on(const Event& event) {
    const MutexLock lock(mutex_);
    if (const auto* failed = std::get_if<StrategyFailed>(&event.what)) {
      failed_[rule_of(failed->strategy)] = event.at;
    } else if (const auto* resolved = std::get_if<FailureResolved>(&event.what)) {
      const auto found = failed_.find(resolved->rule);
      if (found != failed_.end()) seconds_.push_back(seconds(event.at - found->second));
      failed_.erase(resolved->rule);
    }
  }
  std::function<RuleId(StrategyId)> rule_of;
  std::vector<double> all() {
    const MutexLock lock(mutex_);
    return seconds_;
  }

 private:
  Mutex mutex_;
  std::map<RuleId, Time> failed_ CULPRIT_GUARDED_BY(mutex_);
  std::vector<double> seconds_ CULPRIT_GUARDED_BY(mutex_);
};

void redeploy(benchmark::State& state) {
  const std::atomic<bool> stop = false;
  RedeployClock clock;
  lab::SunsetDemo::Options options;
  options.on_event = [&clock](const Event& event, const RuleSet& rules, Time) {
    clock.rule_of = [&rules](StrategyId strategy) { return rules[strategy].rule; };
    clock.on(event);
  };
  auto demo = lab::SunsetDemo::start(std::move(options), stop);
  if (!demo) {
    state.SkipWithError(demo.error().c_str());
    return;
  }
  for (auto _ : state) {
    for (const sunset::Fault& fault : sunset::faults()) {
      const lab::Play play{std::string(fault.name), {&fault}, {}};
      if (play.redeployments_needed() == 0) continue;
      if (const auto outcome = (*demo)->play(play); !outcome || !outcome->is_resolved())
        state.SkipWithError("not healed");
    }
  }
  state.counters["healed"] = static_cast<double>(clock.all().size());
  state.counters["p50_s"] = quantile(clock.all(), 0.5);
  claim("redeploy-only fault: restart failed to healed, relaunch included, slowest",
        quantile(clock.all(), 1), 2, "s");
}
BENCHMARK(redeploy)->Iterations(1)->Unit(benchmark::kSecond);

}  // namespace
}  // namespace culprit::bench
