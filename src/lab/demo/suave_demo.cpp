#include "demo/suave_demo.h"

#include <chrono>
#include <stdlib.h>
#include <system_error>

#include <fmt/core.h>

#include "base/text_file.h"
#include "demo/demo_setup.h"
#include "demo/embedded_rules.h"

namespace culprit::lab {
namespace {

using namespace std::chrono_literals;

constexpr double kMissionSec = 300;  // of robot time, at most

constexpr const char* kModesFile = "suave-modes.yaml";

std::string processes_with(const std::filesystem::path& modes) {
  std::string text;
  for (const char* name : {"vehicle", "search", "follow", "motion", "recharge", "mission"})
    text += fmt::format("COMPONENT {0} LAUNCH \"suave-node {0}\"\n", name);
  return text + fmt::format("COMPONENT mode_manager LAUNCH \"culprit modes {}\"\n", modes.string());
}

const char* rule_text(bool is_extended) { return is_extended ? kSuaveExtendedRules : kSuaveRules; }

const char* rule_file(bool is_extended) {
  return is_extended ? "suave-extended.rules" : "suave.rules";
}

// The rules can start the exemplar's nodes; here they must start our own.
RuleSet rules_of(bool is_extended, const std::filesystem::path& modes) {
  RuleSet rules = embedded_rules(rule_file(is_extended), rule_text(is_extended));
  for (Component& component : rules.components) {
    if (component.launch.empty()) continue;
    const std::string function = component.name.substr(0, component.name.find("_node"));
    component.launch = {"suave-node", function};
    if (component.name == "mode_manager") component.launch = {"culprit", "modes", modes.string()};
  }
  return rules;
}

}  // namespace

Expected<std::unique_ptr<SuaveDemo>> SuaveDemo::start(Options options,
                                                      const std::atomic<bool>& stop) {
  auto domain = make_own_domain(options.domain);
  if (!domain) return Error{domain.error()};
  auto state = make_state_folder();
  if (!state) return Error{state.error()};
  std::unique_ptr<SuaveDemo> demo(
      new SuaveDemo(std::move(options), stop, std::move(*domain), std::move(*state)));
  if (auto opened = demo->open(); !opened) return Error{opened.error()};
  return demo;
}

SuaveDemo::SuaveDemo(Options options, const std::atomic<bool>& stop, ros2::DomainLock domain,
                     std::filesystem::path state)
    : options_(std::move(options)),
      stop_(stop),
      domain_(std::move(domain)),
      state_(std::move(state)),
      rules_(rules_of(options_.is_extended, state_ / kModesFile)),
      keeper_(kForgets),
      episode_(rules_) {}

SuaveDemo::~SuaveDemo() {
  if (session_) session_->leave();
  if (thread_.joinable()) thread_.join();
  observer_.reset();
  if (supervisor_) supervisor_->stop_all();
  if (session_) session_->supervisor().stop_all();  // what was started anew
  session_.reset();
  supervisor_.reset();
  std::error_code error;
  if (!keeps_state_) std::filesystem::remove_all(state_, error);
}

const std::filesystem::path& SuaveDemo::keep_state() {
  keeps_state_ = true;
  return state_;
}

Expected<void> SuaveDemo::open() {
  setenv("SUAVE_SPEED", fmt::format("{}", options_.speed).c_str(), 1);
  setenv("SUAVE_MISSION", options_.is_extended ? "extended" : "standard", 1);
  setenv("SUAVE_SEED", std::to_string(options_.seed).c_str(), 1);
  const auto participant = ros2::options_from_environment();
  if (!participant) return Error{participant.error()};
  live::LiveRobot::Options robot;
  robot.link.participant = *participant;
  robot.supervisor = demo_processes(state_);
  how_ = demo_session(rule_file(options_.is_extended), std::move(robot), options_.planner, state_);

  // The observer must be there before the mission can begin.
  auto observer = suave::MissionObserver::start(options_.speed, *participant);
  if (!observer) return Error{observer.error()};
  observer_ = std::move(*observer);
  auto opened = live::LiveSession::open(
      {.options = how_,
       .records = false,
       .lease = {},
       .orders = keeper_,
       .listener = *this,
       .start = live_now()},
      {rules_, Source(how_.rules_file, rule_text(options_.is_extended)), ""});
  if (!opened) return Error{opened.error()};
  session_ = std::move(*opened);
  if (auto started = start_processes(); !started) return started;
  session_->begin(stop_);
  thread_ = std::thread([this] { session_->run(kNever); });
  return {};
}

Expected<void> SuaveDemo::start_processes() {
  const auto modes = state_ / kModesFile;
  if (auto written = write_text(modes, kSuaveModes); !written) return written;
  processes_ = embedded_rules("processes.rules", processes_with(modes).c_str());
  supervisor_ =
      std::make_unique<owners::Supervisor>(processes_, demo_processes(state_), processes_inbox_);
  start_all(*supervisor_, processes_);
  return {};
}

void SuaveDemo::on_event(const Event& event, const RuleSet& rules, Time start) {
  const MutexLock lock(mutex_);
  episode_.add(event);
  if (options_.on_event) options_.on_event(event, rules, start);
}

Expected<MissionOutcome> SuaveDemo::fly() {
  constexpr Duration kComingUp = 60s;
  const Time end = later(live_now(), kComingUp + from_seconds(kMissionSec / options_.speed));
  while (!observer_->seen().done_s && live_now() < end && !stop_) std::this_thread::sleep_for(50ms);
  if (stop_) return Error{"interrupted"};
  MissionOutcome outcome;
  outcome.mission = observer_->seen();
  if (!outcome.mission.done_s) {
    const char* what = outcome.mission.has_begun ? "end" : "begin";
    return Error{fmt::format("the mission does not {}; the logs are in {}", what,
                             (keep_state() / "log").string())};
  }
  const MutexLock lock(mutex_);
  outcome.failures = episode_.failures();
  outcome.strategies = episode_.strategies();
  for (const Duration reaction : episode_.reactions())
    outcome.reaction_times.push_back(seconds(reaction));
  outcome.unresolved = episode_.open();
  return outcome;
}

}  // namespace culprit::lab
