#include "demo/test_live_sunset.h"

#include <algorithm>
#include <csignal>
#include <iterator>
#include <stdexcept>
#include <thread>

#include "base/environment.h"
#include "demo/play.h"
#include "exemplars/sunset/node_process.h"
#include "language/checker.h"

namespace culprit::lab {
namespace {

using namespace std::chrono_literals;

constexpr double kSpeed = 1;

Source members() {
  std::string text;
  for (const sunset::Member member : sunset::kMembers) {
    const std::string name(name_of(member));
    text += "COMPONENT " + name + " LAUNCH \"sunset-node " + name + "\"\n";
  }
  return Source("members.rules", text);
}

}  // namespace

LiveSunset::LiveSunset(const TestWorld& world)
    : domain_(ros2::options_from_environment()->domain), members_(*check(members()).rules) {
  const owners::Supervisor::Options options{world.folder() / "log", {own_folder()}};
  processes_ = std::make_unique<owners::Supervisor>(members_, options, inbox_);
  for (std::size_t c = 0; c < members_.components.size(); ++c)
    processes_->start({}, ComponentId(c));
  auto experiment =
      sunset::Experiment::start({kSpeed, world.folder(), *ros2::options_from_environment()});
  if (!experiment) throw std::runtime_error(experiment.error());
  experiment_ = std::move(*experiment);
}

LiveSunset::~LiveSunset() {
  slow_ = {};
  experiment_.reset();
  processes_->stop_all();
  for (const sunset::Member member : sunset::kMembers) {
    for (const int pid : processes(member)) kill(pid, SIGKILL);
  }
}

std::vector<int> LiveSunset::processes(sunset::Member member) const {
  return sunset::processes_of(member, domain_);
}

std::string LiveSunset::complaint() const { return experiment_->measure().complaint; }

bool LiveSunset::is_well_within(Duration patience) const {
  int calm = 0;  // a robot that is only just ill does not know it yet
  for (const Time end = live_now() + patience; live_now() < end && calm < 20;) {
    std::this_thread::sleep_for(50ms);
    calm = complaint().empty() ? calm + 1 : 0;
  }
  return calm == 20;
}

Expected<void> LiveSunset::inject(const std::string& fault) {
  if (const sunset::Fault* known = sunset::find_fault(fault)) return experiment_->inject(*known);
  const auto play = find_play(fault);
  if (!play) return Error{play.error()};
  for (const auto& [what, member] : play->process_faults) {
    if (auto done = experiment_->inject(what, member); !done) return done;
  }
  return {};
}

void LiveSunset::slow_down(sunset::Member member) {
  const std::vector<int> all = processes(member);
  slow_ = std::jthread([all](const std::stop_token& stop) {
    const auto tell = [&](int signal) {
      for (const int pid : all) kill(pid, signal);
    };
    for (const Time end = live_now() + 3s; live_now() < end && !stop.stop_requested();) {
      tell(SIGSTOP);
      std::this_thread::sleep_for(400ms);
      tell(SIGCONT);
      std::this_thread::sleep_for(100ms);
    }
  });
}

std::vector<std::string> LiveSunset::faults_of_processes() {
  std::vector<std::string> faults;
  for (const sunset::Member member : sunset::kManagedMembers) {
    for (const char* what : {"kill:", "stop:", "crash:"})
      faults.push_back(what + std::string(name_of(member)));
  }
  return faults;
}

void LiveSunset::break_something(std::mt19937& random) {
  std::vector<std::string> faults;
  for (const sunset::Fault& fault : sunset::faults()) {
    if (!fault.resolved_by.empty()) faults.emplace_back(fault.name);
  }
  std::ranges::copy(faults_of_processes(), std::back_inserter(faults));
  break_something(random, faults);
}

void LiveSunset::break_something(std::mt19937& random, const std::vector<std::string>& faults) {
  const std::size_t members = std::size(sunset::kManagedMembers);
  const std::size_t choice = random() % (faults.size() + members);
  if (choice < faults.size()) {
    (void)inject(faults[choice]);
  } else {
    slow_down(sunset::kManagedMembers[choice - faults.size()]);
  }
}

}  // namespace culprit::lab
