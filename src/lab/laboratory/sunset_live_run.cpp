#include "laboratory/sunset_live_run.h"

#include <algorithm>
#include <thread>

#include "base/live_clock.h"
#include "base/mutex.h"
#include "demo/episode.h"
#include "demo/sunset_world.h"
#include "exemplars/sunset/health_watch.h"
#include "manager/runtime.h"
#include "simulation/random.h"

namespace culprit::lab {
namespace {

using namespace std::chrono_literals;

// A gap counts from the last picture before the fault.
constexpr Duration kWatchedBefore = 1s;

class LiveRun {
 public:
  LiveRun(const study::SunsetStudy& study, study::RunId id, const std::atomic<bool>& stop)
      : study_(study), id_(id), stop_(stop), rules_(study.rules(id.row)), episode_(rules_) {}
  ~LiveRun() {
    end_managing();
    if (world_) world_->end();
  }

  Expected<study::RunMetrics> play() {
    if (auto begun = begin(); !begun) return Error{begun.error()};
    if (auto broken = break_robot(); !broken) return Error{broken.error()};
    watch();
    if (stop_) return Error{"interrupted"};
    measure();
    end_managing();
    const MutexLock lock(mutex_);
    return study_.measured(id_, run_);
  }

 private:
  Expected<void> begin();
  Expected<void> break_robot();
  void watch();
  void measure();
  void end_managing();
  void on_events(std::span<const Event> events);
  bool is_well_and_quiet();
  std::string complaint() { return world_->experiment().measure().complaint; }
  void wait(Duration time) {
    for (const Time end = live_now() + time; live_now() < end && !stop_;)
      std::this_thread::sleep_for(std::min<Duration>(50ms, end - live_now()));
  }

  const study::SunsetStudy& study_;
  const study::RunId id_;
  const std::atomic<bool>& stop_;
  const RuleSet& rules_;
  std::unique_ptr<SunsetWorld> world_;
  std::unique_ptr<live::LiveRobot> robot_;
  std::unique_ptr<ManagingSystem> manager_;
  std::unique_ptr<Runtime> runtime_;
  Time begin_ = kLongAgo;  // when the robot is broken
  Time last_unwell_ = kLongAgo;

  Mutex mutex_;
  Episode episode_ CULPRIT_GUARDED_BY(mutex_);  // until the robot is broken
  Time last_event_ CULPRIT_GUARDED_BY(mutex_) = kLongAgo;
  bool is_broken_ CULPRIT_GUARDED_BY(mutex_) = false;
  std::vector<const sunset::Fault*> present_ CULPRIT_GUARDED_BY(mutex_);
  study::SunsetRun run_ CULPRIT_GUARDED_BY(mutex_);

  std::atomic<bool> is_ending_ = false;
  std::thread thread_;  // runs the runtime
};

Expected<void> LiveRun::begin() {
  SunsetWorld::Options options;
  options.seed = study_.seed_of(id_);
  auto world = SunsetWorld::make(options);
  if (!world) return Error{world.error()};
  world_ = std::move(*world);
  auto how = world_->robot();
  if (!how) return Error{how.error()};
  auto robot = live::LiveRobot::open(rules_, std::move(*how));
  if (!robot) return Error{robot.error()};
  robot_ = std::move(*robot);
  if (auto begun = world_->begin(robot_->supervisor(), rules_); !begun) return begun;
  Manager::Options manager;
  manager.start = live_now();
  manager.discovery = SunsetWorld::kStarting;
  manager_ = study_.manager(id_, manager);
  runtime_ = std::make_unique<Runtime>(*manager_, *robot_);
  runtime_->on_events = [this](std::span<const Event> events) { on_events(events); };
  thread_ = std::thread([this] { runtime_->run(is_ending_); });
  for (const Time end = live_now() + SunsetWorld::kPatience; live_now() < end && !stop_;) {
    if (is_well_and_quiet()) return {};
    wait(50ms);
  }
  if (stop_) return Error{"interrupted"};
  return Error{"the robot does not come up: " + complaint()};
}

bool LiveRun::is_well_and_quiet() {
  constexpr Duration kCalm = 500ms;
  if (!complaint().empty()) return false;
  const MutexLock lock(mutex_);
  return episode_.open() == 0 && live_now() >= later(last_event_, kCalm);
}

Expected<void> LiveRun::break_robot() {
  // As long after the manager as on the model, whose manager comes to a robot that is well.
  const sunset::model::Profile& profile = study_.profile(id_.row);
  simulation::Random random(study_.seed_of(id_));
  wait(profile.injection.draw(random) - profile.manager_start - kWatchedBefore);
  world_->experiment().restart_measuring();
  wait(kWatchedBefore);
  const auto scenario = study::SunsetStudy::scenario_of(id_);
  begin_ = live_now();
  {
    const MutexLock lock(mutex_);
    if (!episode_.strategies().empty() || episode_.open() > 0)
      return Error{"the manager found something wrong before anything was broken"};
    run_.scenario = scenario;
    run_.begin = begin_;
    for (const sunset::Fault* fault : scenario.faults) run_.injections.push_back({begin_, fault});
    present_.assign(scenario.faults.begin(), scenario.faults.end());
    is_broken_ = true;
  }
  for (const auto& [fault, outcome] : world_->experiment().inject(scenario)) {
    if (!outcome)
      return Error{"cannot inject " + std::string(fault->name) + ": " + outcome.error()};
  }
  return {};
}

void LiveRun::watch() {
  const Time end = later(begin_, study_.profile(id_.row).end_of_run);
  while (live_now() < end && !stop_) {
    if (!complaint().empty()) last_unwell_ = live_now();
    wait(50ms);
  }
}

void LiveRun::measure() {
  const sunset::Measurements measured = world_->experiment().measure();
  const MutexLock lock(mutex_);
  run_.end = live_now();
  run_.downtime = from_seconds(measured.downtime_between_outputs_sec);
  run_.honest_downtime = from_seconds(measured.downtime_sec);
  run_.is_recovered = measured.complaint.empty();
  if (!run_.is_recovered) {
    run_.recovery = run_.end - run_.begin;
  } else if (last_unwell_ != kLongAgo) {
    // A robot counts as unwell until it was well for a while.
    const Duration calm = from_seconds(sunset::kCalmSec);
    run_.recovery = std::max(Duration::zero(), last_unwell_ - calm - run_.begin);
  }
}

void LiveRun::end_managing() {
  is_ending_ = true;
  if (robot_) robot_->interrupt();
  if (thread_.joinable()) thread_.join();
}

void LiveRun::on_events(std::span<const Event> events) {
  const MutexLock lock(mutex_);
  for (const Event& event : events) {
    last_event_ = event.at;
    if (!is_broken_) {
      episode_.add(event);
      continue;
    }
    run_.events.push_back(event);
    if (const auto* chosen = std::get_if<StrategyChosen>(&event.what))
      run_.choices.push_back(study::judge(chosen->strategy, rules_, present_));
    if (const auto* done = std::get_if<AdaptationDone>(&event.what)) {
      const Strategy& strategy = rules_[done->strategy];
      if (done->adaptation + 1 < strategy.adaptations.size()) continue;
      std::erase_if(present_, [&](const sunset::Fault* fault) {
        const auto& remedies = fault->resolved_by;
        return std::find(remedies.begin(), remedies.end(), strategy.name) != remedies.end();
      });
    }
  }
}

}  // namespace

Expected<study::RunMetrics> play_live(const study::SunsetStudy& study, study::RunId id,
                                      const std::atomic<bool>& stop) {
  return LiveRun(study, id, stop).play();
}

}  // namespace culprit::lab
