#include "demo/rover_demo.h"

#include <algorithm>
#include <fstream>
#include <stdlib.h>
#include <system_error>

#include <fmt/core.h>

#include "demo/demo_setup.h"
#include "demo/embedded_rules.h"
#include "exemplars/node_process.h"
#include "exemplars/rover/nodes.h"

namespace culprit::lab {
namespace {

using namespace std::chrono_literals;

constexpr Duration kRoverComesUp = 120s;
constexpr const char* kProgram = "rover-node";
constexpr const char* kStray = "stray_";  // begins the names of processes that only a fault starts
constexpr const char* kRespawned = "imu_driver";  // as rover.rules declares it

std::string launches(bool has_robot) {
  std::string text;
  for (const rover::Process& process : rover::processes()) {
    const bool is_started = has_robot || process.name == kRespawned;
    if (!process.is_robot || is_started)
      text += fmt::format("COMPONENT {0} LAUNCH \"{1} {0}\"\n", process.name, kProgram);
  }
  for (const rover::Fault& fault : rover::faults()) {
    if (fault.way == rover::Way::kStray)
      text += fmt::format("COMPONENT {0}{1} LAUNCH \"{2} {1}\"\n", kStray, fault.process, kProgram);
  }
  return text;
}

// As the installation of a package with components does. culprit loads none that the container could not find.
Expected<void> register_plugins(const std::filesystem::path& prefix) {
  const auto index = prefix / "share/ament_index/resource_index/rclcpp_components";
  std::error_code error;
  std::filesystem::create_directories(index, error);
  if (!(std::ofstream(index / "rover") << "rover::CameraDriver;rover\nrover::CloudMaker;rover\n"))
    return Error{"cannot write in " + index.string()};
  const char* others = std::getenv("AMENT_PREFIX_PATH");
  const std::string all = prefix.string() + (others != nullptr ? std::string(":") + others : "");
  setenv("AMENT_PREFIX_PATH", all.c_str(), 1);
  return {};
}

}  // namespace

Expected<std::unique_ptr<RoverDemo>> RoverDemo::start(Options options,
                                                      const std::atomic<bool>& stop) {
  auto domain = make_own_domain(options.domain);
  if (!domain) return Error{domain.error()};
  auto state = make_state_folder();
  if (!state) return Error{state.error()};
  std::unique_ptr<RoverDemo> demo(
      new RoverDemo(std::move(options), stop, std::move(*domain), std::move(*state)));
  if (auto opened = demo->open(); !opened) return Error{opened.error()};
  return demo;
}

RoverDemo::RoverDemo(Options options, const std::atomic<bool>& stop, ros2::DomainLock domain,
                     std::filesystem::path state)
    : options_(std::move(options)),
      stop_(stop),
      domain_(std::move(domain)),
      state_(std::move(state)),
      rules_of_processes_(embedded_rules("processes.rules",
                                         launches(options_.manager != Manager::kCulprit).c_str())),
      keeper_(kForgets) {}

RoverDemo::~RoverDemo() {
  is_over_ = true;
  if (session_) session_->leave();
  for (std::thread* each : {&thread_, &respawner_}) {
    if (each->joinable()) each->join();
  }
  experiment_.reset();
  if (session_) session_->supervisor().stop_all();
  if (processes_) processes_->stop_all();
  session_.reset();
  processes_.reset();
  std::error_code error;
  if (!keeps_state_) std::filesystem::remove_all(state_, error);
}

const std::filesystem::path& RoverDemo::keep_state() {
  keeps_state_ = true;
  return state_;
}

const char* RoverDemo::rule_text() { return kRoverRules; }

Expected<void> RoverDemo::open() {
  setenv("ROVER_SEED", std::to_string(options_.seed).c_str(), 1);
  setenv("ROVER_STATE", state_.c_str(), 1);
  if (auto registered = register_plugins(state_); !registered) return registered;
  const auto participant = ros2::options_from_environment();
  if (!participant) return Error{participant.error()};
  auto experiment = rover::Experiment::start(*participant, state_);
  if (!experiment) return Error{experiment.error()};
  experiment_ = std::move(*experiment);
  processes_ = std::make_unique<owners::Supervisor>(rules_of_processes_, demo_processes(state_),
                                                    processes_inbox_);
  for (std::size_t c = 0; c < rules_of_processes_.components.size(); ++c) {
    if (!rules_of_processes_.components[c].name.starts_with(kStray))
      processes_->start({}, ComponentId(c));
  }
  if (options_.manager == Manager::kCulprit) {
    if (auto opened = open_session(*participant); !opened) return opened;
  }
  respawner_ = std::thread([this] { respawn(); });
  if (wait_until_well({}, kRoverComesUp)) return {};
  if (stop_) return Error{"interrupted"};
  return Error{"the rover does not come up: " + experiment_->measure().complaint +
               "; its logs are in " + (keep_state() / "log").string()};
}

Expected<void> RoverDemo::open_session(const ros2::ParticipantOptions& participant) {
  live::LiveRobot::Options robot;
  robot.link.participant = participant;
  robot.supervisor = demo_processes(state_);
  how_ = demo_session("rover.rules", std::move(robot), options_.planner, state_);
  how_.launches = true;  // as the launch file that has the container load its components
  auto opened = live::LiveSession::open({.options = how_,
                                         .records = false,
                                         .lease = {},
                                         .orders = keeper_,
                                         .listener = *this,
                                         .observer = options_.observer,
                                         .start = live_now()},
                                        embedded_file("rover.rules", kRoverRules));
  if (!opened) return Error{opened.error()};
  session_ = std::move(*opened);
  start_all(session_->supervisor(), rules());
  session_->begin(stop_);
  thread_ = std::thread([this] { session_->run(kNever); });
  return {};
}

// As `respawn=True, respawn_delay=2.0` of a launch file.
void RoverDemo::respawn() {
  std::vector<Time> missing(rules_of_processes_.components.size(), kNever);
  for (; !is_over_; std::this_thread::sleep_for(100ms)) {
    for (std::size_t c = 0; c < missing.size(); ++c) {
      const std::string& name = rules_of_processes_.components[c].name;
      const bool is_kept = options_.manager == Manager::kRespawn && !name.starts_with(kStray);
      if (!is_kept && name != kRespawned) continue;
      if (!processes_of(kProgram, name, domain()).empty()) {
        missing[c] = kNever;
      } else if (missing[c] == kNever) {
        missing[c] = live_now();
      } else if (live_now() > later(missing[c], 2s)) {
        processes_->start({}, ComponentId(c));
        missing[c] = live_now();
      }
    }
  }
}

void RoverDemo::on_event(const Event& event, const RuleSet& rules, Time start) {
  const MutexLock lock(mutex_);
  if (episode_) episode_->add(event);
  if (options_.on_event) options_.on_event(event, rules, start);
}

std::optional<Time> RoverDemo::wait_until_well(const std::vector<const rover::Fault*>& faults,
                                               Duration patience) {
  constexpr Duration kCalm = 2s;
  Time well = kNever;
  for (const Time end = later(live_now(), patience); live_now() < end && !stop_;) {
    std::this_thread::sleep_for(100ms);
    bool is_well = experiment_->measure().complaint.empty() &&
                   std::ranges::all_of(faults, [this](const rover::Fault* fault) {
                     return experiment_->is_over(*fault);
                   });
    if (is_well) {
      const MutexLock lock(mutex_);
      is_well = !episode_ || episode_->open() == 0;
    }
    if (!is_well) {
      well = kNever;
    } else if (well == kNever) {
      well = live_now();
    } else if (live_now() >= later(well, kCalm)) {
      return well;
    }
  }
  return std::nullopt;
}

bool RoverDemo::wait_for_safe_stop() {
  for (const Time end = later(live_now(), 20s); live_now() < end && !stop_;) {
    std::this_thread::sleep_for(100ms);
    if (experiment_->measure().stood_s > 3) return true;
  }
  return false;
}

Expected<void> RoverDemo::inject(const std::string& fault) {
  const auto play = rover::find_play(fault);
  return play ? inject(*play) : Error{play.error()};
}

Expected<void> RoverDemo::inject(const rover::Play& play) {
  for (const rover::Fault* fault : play.faults) {
    if (fault->way == rover::Way::kStray) {
      processes_->start({}, stray(fault->process));
      continue;
    }
    if (auto injected = experiment_->inject(*fault); !injected)
      return Error{fault->name + ": " + injected.error()};
  }
  return {};
}

ComponentId RoverDemo::stray(const std::string& process) const {
  const auto& all = rules_of_processes_.components;
  const auto found = std::ranges::find(all, kStray + process, &Component::name);
  return ComponentId(static_cast<std::size_t>(found - all.begin()));
}

Expected<void> RoverDemo::clear_faults() {
  for (const rover::Fault& fault : rover::faults()) {
    if (fault.way == rover::Way::kStray) processes_->withdraw(stray(fault.process));
  }
  experiment_->clear();
  return {};
}

Expected<PlayOutcome> RoverDemo::play(const rover::Play& play, Duration patience) {
  if (session_) {
    const MutexLock lock(mutex_);
    episode_.emplace(rules());
  }
  const rover::Measurements before = experiment_->measure();
  experiment_->restart_measuring();
  const Time begin = live_now();
  if (auto injected = inject(play); !injected) return Error{injected.error()};
  const bool is_fixable = play.is_fixable();
  const auto well = is_fixable ? wait_until_well(play.faults, patience) : std::nullopt;
  const bool stands = !is_fixable && wait_for_safe_stop();
  if (stop_) return Error{"interrupted"};

  const rover::Measurements measured = experiment_->measure();
  PlayOutcome outcome;
  {
    const MutexLock lock(mutex_);
    if (episode_) outcome = episode_->outcome();
    episode_.reset();
  }
  outcome.name = play.name;
  outcome.faults = play.fault_names();
  outcome.is_for_a_person = !is_fixable;
  outcome.downtime = measured.stood_s;
  outcome.goals = measured.goals_reached - before.goals_reached;
  outcome.collisions = measured.collisions - before.collisions;
  if (!is_fixable) outcome.unresolved = 0;
  if (well) outcome.healed_s = seconds(*well - begin);
  if (stands)
    outcome.stands_after_s = std::max(0.0, seconds(live_now() - begin) - measured.standing_s);
  outcome.unnecessary_redeployments = static_cast<int>(std::ranges::count_if(
      outcome.redeployed, [&](const std::string& each) { return !play.is_cause(each); }));
  if (!is_fixable) {
    outcome.complaint = stands ? "" : "the rover does not stop";
  } else if (!well) {
    outcome.complaint =
        measured.complaint.empty() ? "the fault is still there" : measured.complaint;
  }
  (void)clear_faults();
  return outcome;
}

}  // namespace culprit::lab
