#include "rover_study/live.h"

#include <memory>
#include <thread>

#include "base/live_clock.h"
#include "demo/rover_demo.h"
#include "plan/paper_planner.h"

namespace culprit::study {
namespace {

using namespace std::chrono_literals;
using lab::RoverDemo;

RoverDemo::Options demo_of(const std::string& manager, std::uint64_t seed) {
  RoverDemo::Options demo;
  demo.seed = seed;
  if (manager == "none") demo.manager = RoverDemo::Manager::kNone;
  if (manager == "respawn") demo.manager = RoverDemo::Manager::kRespawn;
  if (manager == "paper") demo.planner = [] { return std::make_unique<PaperPlanner>(); };
  return demo;
}

bool is_well_soon(const RoverDemo& demo) {
  for (const Time end = later(live_now(), 15s); live_now() < end;) {
    if (demo.measure().complaint.empty()) return true;
    std::this_thread::sleep_for(100ms);
  }
  return false;
}

RoverResult result_of(const rover::Play& play, const lab::PlayOutcome& outcome) {
  RoverResult result{.healed_s = outcome.healed_s, .stands_after_s = outcome.stands_after_s};
  result.stood_s = outcome.downtime;
  result.goals = outcome.goals;
  result.collisions = outcome.collisions;
  result.blamed = right_of(play, outcome.blamed);
  result.wrong_restarts = outcome.unnecessary_redeployments;
  result.calls = outcome.calls;
  result.is_noticed = !outcome.failures.empty();
  result.names = outcome.blamed;
  result.strategies = outcome.strategies;
  result.complaint = outcome.complaint;
  return result;
}

}  // namespace

const std::vector<std::string>& live_rover_managers() {
  static const std::vector<std::string> kAll = {"none", "respawn", "paper", "bayes"};
  return kAll;
}

Expected<std::vector<RoverResult>> play_live(
    const std::vector<rover::Play>& plays, const std::string& manager, Duration patience,
    const std::atomic<bool>& stop,
    const std::function<void(const rover::Play&, const RoverResult&)>& on_result) {
  std::vector<RoverResult> results;
  std::unique_ptr<RoverDemo> demo;
  for (const rover::Play& play : plays) {
    if (!demo) {
      auto started = RoverDemo::start(demo_of(manager, play.seed), stop);
      if (!started) return Error{started.error()};
      demo = std::move(*started);
    }
    const Time begin = live_now();
    const auto outcome = demo->play(play, patience);
    if (!outcome) return Error{outcome.error()};
    results.push_back(result_of(play, *outcome));
    results.back().watched_s = seconds(live_now() - begin);
    on_result(play, results.back());
    if (!outcome->is_resolved() || !is_well_soon(*demo)) demo.reset();
  }
  return results;
}

}  // namespace culprit::study
