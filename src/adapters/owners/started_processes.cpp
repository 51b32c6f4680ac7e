#include "owners/started_processes.h"

#include <algorithm>
#include <csignal>
#include <poll.h>
#include <thread>
#include <unistd.h>

#include "base/live_clock.h"
#include "base/units.h"
#include "owners/mark.h"
#include "owners/proc.h"
#include "owners/supervisor.h"
#include "owners/watched_process.h"

namespace culprit::owners {
namespace {

struct Ended {
  WatchedProcess process;
  StartedProcess what;
};

bool is_running(const Ended& each) { return each.process.state() != ProcessState::kGone; }

// Until all have ended, or `until`.
void wait_for(const std::vector<Ended>& all, Time until) {
  constexpr int kAtOnce = 100;  // milliseconds
  while (live_now() < until) {
    std::vector<pollfd> open;
    for (const Ended& each : all) {
      if (is_running(each)) open.push_back({each.process.descriptor(), POLLIN, 0});
    }
    if (open.empty()) return;
    poll(open.data(), open.size(), kAtOnce);
  }
}

}  // namespace

std::vector<StartedProcess> started_processes(const std::string& robot) {
  std::vector<StartedProcess> all;
  for (const MarkedProcess& each : marked_processes(robot.ends_with('/') ? robot : robot + "/")) {
    const auto began = started_at(each.pid);
    const std::size_t slash = each.component.rfind('/');
    all.push_back({each.component.substr(0, slash), each.component.substr(slash + 1), each.pid,
                   place_held_by(each.pid).launcher, began.value_or(live_now())});
  }
  std::ranges::sort(all, {}, [](const StartedProcess& p) { return std::pair(p.since, p.pid); });
  return all;
}

std::string to_string(const StartedProcess& process, Time now) {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(now - process.since);
  return process.component + " (process " + std::to_string(process.pid) + ", for " +
         culprit::to_string(Duration(std::max(seconds, std::chrono::seconds(0)))) +
         (process.launcher == 0
              ? ""
              : ", in place of one of process " + std::to_string(process.launcher)) +
         ")";
}

std::vector<StartedProcess> end_processes(const std::vector<StartedProcess>& processes) {
  constexpr Duration kSame = std::chrono::milliseconds(100);  // of two readings of one start
  std::vector<Ended> all;
  for (const StartedProcess& each : processes) {
    auto process = WatchedProcess::watch(each.pid, Relation::kMarked);
    const auto began = started_at(each.pid);
    const bool is_it = process && began && std::chrono::abs(*began - each.since) < kSame &&
                       carries_mark(each.pid, each.robot + "/" + each.component);
    if (is_it) all.push_back({std::move(*process), each});
  }
  for (const int signal : {SIGINT, SIGTERM, SIGKILL}) {
    for (const Ended& each : all) {
      // A stopped process acts on nothing else.
      const bool is_stopped = each.process.state() == ProcessState::kStopped;
      if (is_running(each)) each.process.signal(is_stopped ? SIGKILL : signal);
    }
    wait_for(all, later(live_now(), Supervisor::kOfLaunch));
  }
  std::vector<StartedProcess> left;
  for (const Ended& each : all) {
    if (is_running(each)) left.push_back(each.what);
  }
  return left;
}

std::vector<int> others_of_own_launch() {
  const Origin own = origin_of(getpid());
  if (own.what != Origin::What::kKnown) return {};
  std::vector<int> others = children_of(own.pid);
  // `ros2 run` may be between the launcher and this process.
  std::erase_if(others, [](int child) {
    return child == getpid() || child == getppid() || state_letter(child).value_or('Z') == 'Z';
  });
  return others;
}

std::vector<StartedProcess> end_with_own_launch(const std::string& robot,
                                                const std::vector<int>& others, Duration patience) {
  constexpr Duration kLook = std::chrono::milliseconds(50);
  const Origin own = origin_of(getpid());
  if (own.what != Origin::What::kKnown || others.empty()) return {};
  std::vector<StartedProcess> started = started_processes(robot);
  std::erase_if(started, [&](const StartedProcess& p) { return p.launcher != own.pid; });
  if (started.empty()) return {};
  const auto runs = [](int child) { return state_letter(child).value_or('Z') != 'Z'; };
  for (const Time until = later(live_now(), patience); std::ranges::any_of(others, runs);) {
    if (live_now() >= until) return {};
    std::this_thread::sleep_for(kLook);
  }
  for (const StartedProcess& each : started) {
    if (auto process = WatchedProcess::watch(each.pid, Relation::kMarked)) process->signal(SIGINT);
  }
  return started;
}

}  // namespace culprit::owners
