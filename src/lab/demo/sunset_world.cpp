#include "demo/sunset_world.h"

#include <stdlib.h>
#include <system_error>

#include <fmt/core.h>

#include "demo/demo_setup.h"

namespace culprit::lab {
namespace {

constexpr const char* kExtras = R"(
COMPONENT world     LAUNCH "sunset-node world"
COMPONENT evaluator LAUNCH "sunset-node evaluator"
)";

}  // namespace

Expected<std::unique_ptr<SunsetWorld>> SunsetWorld::start(const Options& options,
                                                          const RuleSet& rules) {
  auto domain = make_own_domain(options.domain);
  if (!domain) return Error{domain.error()};
  std::unique_ptr<SunsetWorld> world(new SunsetWorld(std::move(*domain)));
  if (auto opened = world->open(options, rules); !opened) return Error{opened.error()};
  return world;
}

SunsetWorld::SunsetWorld(ros2::DomainLock domain)
    : domain_(std::move(domain)), extras_rules_(embedded_rules("extras.rules", kExtras)) {}

SunsetWorld::~SunsetWorld() {
  experiment_.reset();
  if (robot_) robot_->supervisor().stop_all();
  if (extras_) extras_->stop_all();
  robot_.reset();
  extras_.reset();
  std::error_code error;
  if (!keeps_state_ && !state_.empty()) std::filesystem::remove_all(state_, error);
}

const std::filesystem::path& SunsetWorld::keep_state() {
  keeps_state_ = true;
  return state_;
}

Expected<void> SunsetWorld::open(const Options& options, const RuleSet& rules) {
  auto state = make_state_folder();
  if (!state) return Error{state.error()};
  state_ = *state;
  setenv("SUNSET_SPEED", fmt::format("{}", options.speed).c_str(), 1);
  setenv("SUNSET_SEED", std::to_string(options.seed).c_str(), 1);
  setenv("SUNSET_STATE", state_.c_str(), 1);
  const auto participant = ros2::options_from_environment();
  if (!participant) return Error{participant.error()};

  const owners::Supervisor::Options processes = demo_processes(state_);
  LiveRobot::Options robot;
  robot.link.participant = *participant;
  robot.supervisor = processes;
  auto opened = LiveRobot::open(rules, std::move(robot));
  if (!opened) return Error{opened.error()};
  robot_ = std::move(*opened);
  extras_ = std::make_unique<owners::Supervisor>(extras_rules_, processes, extras_inbox_);
  start_all(*extras_, extras_rules_);
  start_all(robot_->supervisor(), rules);

  auto experiment = sunset::Experiment::start({options.speed, state_, *participant});
  if (!experiment) return Error{experiment.error()};
  experiment_ = std::move(*experiment);
  return {};
}

}  // namespace culprit::lab
