#include "demo/sunset_world.h"

#include <stdlib.h>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "demo/demo_setup.h"

namespace culprit::lab {
namespace {

constexpr const char* kExtras = R"(
COMPONENT world     LAUNCH "sunset-node world"
COMPONENT evaluator LAUNCH "sunset-node evaluator"
)";

}  // namespace

Expected<std::unique_ptr<SunsetWorld>> SunsetWorld::make(const Options& options) {
  auto domain = make_own_domain(options.domain);
  if (!domain) return Error{domain.error()};
  auto state = make_state_folder();
  if (!state) return Error{state.error()};
  setenv("SUNSET_SPEED", fmt::format("{}", options.speed).c_str(), 1);
  setenv("SUNSET_SEED", std::to_string(options.seed).c_str(), 1);
  setenv("SUNSET_STATE", state->c_str(), 1);
  return std::unique_ptr<SunsetWorld>(
      new SunsetWorld(std::move(*domain), options.speed, std::move(*state)));
}

SunsetWorld::SunsetWorld(ros2::DomainLock domain, double speed, std::filesystem::path state)
    : domain_(std::move(domain)),
      speed_(speed),
      state_(std::move(state)),
      extras_rules_(embedded_rules("extras.rules", kExtras)) {}

SunsetWorld::~SunsetWorld() {
  end();
  std::error_code error;
  if (!keeps_state_) std::filesystem::remove_all(state_, error);
}

const std::filesystem::path& SunsetWorld::keep_state() {
  keeps_state_ = true;
  return state_;
}

Expected<live::LiveRobot::Options> SunsetWorld::robot() const {
  const auto participant = ros2::options_from_environment();
  if (!participant) return Error{participant.error()};
  live::LiveRobot::Options options;
  options.link.participant = *participant;
  options.supervisor = demo_processes(state_);
  return options;
}

Expected<void> SunsetWorld::begin(owners::Supervisor& robot, const RuleSet& rules) {
  const auto participant = ros2::options_from_environment();
  if (!participant) return Error{participant.error()};
  extras_ =
      std::make_unique<owners::Supervisor>(extras_rules_, demo_processes(state_), extras_inbox_);
  start_all(*extras_, extras_rules_);
  robot_ = &robot;
  start_all(robot, rules);
  auto experiment = sunset::Experiment::start({speed_, state_, *participant});
  if (!experiment) return Error{experiment.error()};
  experiment_ = std::move(*experiment);
  return {};
}

void SunsetWorld::end() {
  experiment_.reset();
  if (robot_ != nullptr) std::exchange(robot_, nullptr)->stop_all();
  if (extras_) extras_->stop_all();
}

}  // namespace culprit::lab
