#include "demo/sunset_demo.h"

#include <chrono>

#include "demo/demo_setup.h"
#include "demo/embedded_rules.h"

namespace culprit::lab {
namespace {

using namespace std::chrono_literals;

}  // namespace

Expected<std::unique_ptr<SunsetDemo>> SunsetDemo::start(Options options,
                                                        const std::atomic<bool>& stop) {
  std::unique_ptr<SunsetDemo> demo(new SunsetDemo(std::move(options), stop));
  if (auto opened = demo->open(); !opened) return Error{opened.error()};
  return demo;
}

SunsetDemo::SunsetDemo(Options options, const std::atomic<bool>& stop)
    : options_(std::move(options)), stop_(stop), keeper_(kForgets) {}

SunsetDemo::~SunsetDemo() {
  if (session_) session_->leave();
  if (thread_.joinable()) thread_.join();
  if (world_) world_->end();
}

const char* SunsetDemo::rule_text() { return kSunsetRules; }

Expected<void> SunsetDemo::open() {
  auto world = SunsetWorld::make({options_.speed, options_.seed, options_.domain});
  if (!world) return Error{world.error()};
  world_ = std::move(*world);
  auto robot = world_->robot();
  if (!robot) return Error{robot.error()};
  how_ = demo_session("sunset.rules", std::move(*robot), options_.planner, world_->state());
  how_.discovery = SunsetWorld::kStarting;
  auto opened = live::LiveSession::open({.options = how_,
                                         .records = false,
                                         .lease = {},
                                         .orders = keeper_,
                                         .listener = *this,
                                         .observer = options_.observer,
                                         .start = live_now()},
                                        embedded_file("sunset.rules", kSunsetRules));
  if (!opened) return Error{opened.error()};
  session_ = std::move(*opened);
  if (auto begun = world_->begin(session_->supervisor(), rules()); !begun) return begun;
  session_->begin(stop_);
  thread_ = std::thread([this] { session_->run(kNever); });
  if (wait_until_well(SunsetWorld::kPatience)) return {};
  if (stop_) return Error{"interrupted"};
  return Error{"the robot does not come up: " + world_->experiment().measure().complaint +
               "; its logs are in " + (keep_state() / "log").string()};
}

void SunsetDemo::on_event(const Event& event, const RuleSet& rules, Time start) {
  const MutexLock lock(mutex_);
  last_event_ = event.at;
  if (episode_) episode_->add(event);
  if (options_.on_event) options_.on_event(event, rules, start);
}

bool SunsetDemo::wait_until_well(Duration patience) {
  constexpr Duration kCalm = 500ms;
  for (const Time end = live_now() + patience; live_now() < end && !stop_;) {
    std::this_thread::sleep_for(50ms);
    const bool is_well = world_->experiment().measure().complaint.empty();
    const MutexLock lock(mutex_);
    const bool is_quiet = !episode_ || (episode_->open() == 0 && !episode_->failures().empty());
    if (episode_ && episode_->is_exhausted()) return false;
    if (is_well && is_quiet && live_now() >= later(last_event_, kCalm)) return true;
  }
  return false;
}

Expected<void> SunsetDemo::inject(const Play& play) {
  for (const sunset::Fault* fault : play.faults) {
    if (auto injected = world_->experiment().inject(*fault); !injected)
      return Error{std::string(fault->name) + ": " + injected.error()};
  }
  for (const auto& [fault, member] : play.process_faults) {
    if (auto injected = world_->experiment().inject(fault, member); !injected) {
      return Error{std::string(sunset::name_of(member)) + ": " + injected.error()};
    }
  }
  return {};
}

Expected<void> SunsetDemo::inject(const std::string& fault) {
  if (const sunset::Fault* known = sunset::find_fault(fault))
    return world_->experiment().inject(*known);
  const auto play = find_play(fault);
  return play ? inject(*play) : Error{play.error()};
}

Expected<PlayOutcome> SunsetDemo::play(const Play& play) {
  {
    const MutexLock lock(mutex_);
    episode_.emplace(rules());
  }
  world_->experiment().restart_measuring();
  if (auto injected = inject(play); !injected) return Error{"cannot inject " + injected.error()};
  const bool is_well = wait_until_well(kPatience);
  if (stop_) return Error{"interrupted"};

  const sunset::Measurements measured = world_->experiment().measure();
  PlayOutcome outcome;
  {
    const MutexLock lock(mutex_);
    outcome = episode_->outcome();
    outcome.unnecessary_redeployments =
        std::max(0, episode_->redeployments() - play.redeployments_needed());
  }
  outcome.name = play.name;
  outcome.faults = play.fault_names();
  outcome.downtime = measured.downtime_sec / options_.speed;
  outcome.mean_iou = measured.mean_iou;
  if (!is_well)
    outcome.complaint = measured.complaint.empty() ? "no failure was seen" : measured.complaint;
  if (auto cleared = clear(); !cleared) return Error{cleared.error()};
  return outcome;
}

// Effects of adaptations (an enhancement that is on) and faults that no failure showed (depth
// noise) would change the next play.
Expected<void> SunsetDemo::clear() {
  {
    const MutexLock lock(mutex_);
    episode_.reset();
  }
  if (auto cleared = world_->experiment().clear(); !cleared) return cleared;
  if (wait_until_well(kPatience)) return {};
  if (stop_) return Error{"interrupted"};
  return Error{"the robot did not recover after its faults were cleared: " +
               world_->experiment().measure().complaint};
}

}  // namespace culprit::lab
