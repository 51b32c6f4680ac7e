// A component that is supervised, and processes that others started.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "inbox/inbox.h"
#include "language/checker.h"
#include "owners/proc.h"
#include "owners/spawn.h"
#include "owners/supervisor.h"
#include "owners/test_process.h"

namespace culprit::owners {

// Supervises component c with the given launch command and reports the results.
class Supervised {
 public:
  explicit Supervised(const std::string& launch, const std::string& robot = "")
      : Supervised(Declared{"LAUNCH \"" + launch + "\""}, robot) {}
  struct Declared {
    std::string clauses;
  };
  explicit Supervised(const Declared& component, const std::string& robot = "")
      : folder_(std::filesystem::temp_directory_path() /
                ("culprit-test-" + std::to_string(getpid()))),
        rules_(*check(Source("test.rules", "COMPONENT c " + component.clauses + "\n")).rules),
        robot_(robot) {
    supervise();
  }
  // Anew, as after a restart of culprit.
  void supervise(const std::filesystem::path& logs = {}) {
    supervisor.reset();
    Supervisor::Options options{logs.empty() ? folder_ : logs, {}, robot_};
    if (environment) options.environments = {*environment};
    supervisor.emplace(rules_, std::move(options), inbox);
  }
  ~Supervised() {
    if (supervisor) supervisor->stop_all();
    supervisor.reset();
    std::filesystem::remove_all(folder_);
  }

  int start() {
    supervisor->start({1}, ComponentId(0));
    const Reply reply = reply_to({1});
    EXPECT_EQ(reply.outcome, Outcome::kDone) << reply.text;
    const auto* pid = std::get_if<Value>(&reply.value);
    return pid == nullptr ? 0 : static_cast<int>(std::get<std::int64_t>(*pid));
  }
  void stop() {
    supervisor->stop({2}, ComponentId(0), 0, Ending::kForGood);
    EXPECT_EQ(reply_to({2}).outcome, Outcome::kDone);
  }
  std::string trouble() {
    return wait<LinkTrouble>([](const LinkTrouble&) { return true; }).text;
  }
  Reply stop_to_start_again() {
    supervisor->stop({7}, ComponentId(0), 0, Ending::kToStartAgain);
    return reply_to({7});
  }
  const std::filesystem::path& folder() const { return folder_; }
  Reply reply_to(CommandId command) {
    return wait<Reply>([&](const Reply& r) { return r.command == command; });
  }
  ProcessSeen state(ProcessState state) {
    return wait<ProcessSeen>([&](const ProcessSeen& s) { return s.state == state; });
  }
  LauncherSeen launcher() {
    return wait<LauncherSeen>([](const LauncherSeen&) { return true; });
  }
  StartedHere started() {
    return wait<StartedHere>([](const StartedHere&) { return true; });
  }
  std::string missing() {
    return wait<StartBarred>([](const StartBarred& s) { return !s.missing.empty(); }).missing;
  }
  void nothing_missing() {
    wait<StartBarred>([](const StartBarred& s) { return s.missing.empty(); });
  }
  int worked() {
    return wait<ProcessWorked>([](const ProcessWorked&) { return true; }).pid;
  }
  bool hears_of_no_work_for(Duration time) {
    std::vector<Observation> seen;
    inbox.take(live_now(), seen);
    seen.clear();
    for (const Time end = later(live_now(), time); live_now() < end;) inbox.take(end, seen);
    return std::none_of(seen.begin(), seen.end(), [](const Observation& o) {
      return std::holds_alternative<ProcessWorked>(o.what);
    });
  }
  std::filesystem::path log() const {
    std::string name = robot_.empty() ? "c" : robot_ + "/c";
    std::ranges::replace(name, '/', '-');
    return folder_ / (name + ".log");
  }
  std::string log_when(const std::string& part) {
    std::string text;
    for (int tries = 0; tries < 1000 && text.find(part) == std::string::npos; ++tries) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      std::ifstream file(log());
      text.assign(std::istreambuf_iterator<char>(file), {});
    }
    return text;
  }

  Inbox inbox;
  std::optional<Supervisor> supervisor;
  std::optional<Expected<std::vector<std::string>>> environment;  // of supervise()

 private:
  // The first observation of this kind that fits; waits up to half a minute, on any machine enough.
  template <class What, class Fits>
  What wait(Fits fits) {
    const Time end = live_now() + std::chrono::seconds(30);
    while (live_now() < end) {
      for (std::size_t i = 0; i < seen_.size(); ++i) {
        const auto* what = std::get_if<What>(&seen_[i].what);
        if (what == nullptr || !fits(*what)) continue;
        const What found = *what;
        seen_.erase(seen_.begin(), seen_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
        return found;
      }
      inbox.take(end, seen_);
    }
    ADD_FAILURE() << "nothing of the kind was observed";
    return {};
  }

  std::filesystem::path folder_;
  RuleSet rules_;
  std::string robot_;
  std::vector<Observation> seen_;
};

inline bool exists(int pid) { return kill(pid, 0) == 0; }

inline bool becomes(int pid, const std::string& program) {
  for (int tries = 0; tries < 3000; ++tries) {
    const auto identity = identity_of(pid);
    if (identity && identity->program.ends_with(program)) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

// Runs the program as somebody else's: neither our child nor marked.
inline int start_by_others(const std::string& command) {
  std::array<int, 2> told{};
  EXPECT_EQ(pipe(told.data()), 0);
  const int between = fork();
  if (between == 0) {
    const int pid = fork();
    if (pid == 0) {
      setsid();
      execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
      _exit(127);
    }
    [[maybe_unused]] const auto written = write(told[1], &pid, sizeof pid);
    _exit(0);
  }
  int pid = 0;
  EXPECT_EQ(read(told[0], &pid, sizeof pid), static_cast<ssize_t>(sizeof pid));
  close(told[0]);
  close(told[1]);
  waitpid(between, nullptr, 0);
  return pid;
}

// Somebody else's launcher, which starts a process again whenever it ends.
class Respawning {
 public:
  explicit Respawning(const std::string& command = "sleep 1000")
      : pid_(*spawn({{"sh", "-c", "while :; do " + command + "; done"}, {}, "/dev/null"})) {}
  ~Respawning() {
    const int left = child();
    end();
    if (left != 0) kill(left, SIGKILL);
  }
  // The process that runs now, another than `before`.
  int child(int before = 0) const {
    for (int tries = 0; tries < 1000; ++tries) {
      for (const Relative& each : descendants_of(pid_)) {
        if (each.pid != before && each.command == "sleep") return each.pid;
      }
      if (is_ended_) return 0;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return 0;
  }
  void end() {
    if (std::exchange(is_ended_, true)) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }

 private:
  int pid_;
  bool is_ended_ = false;
};

inline int a_child_of(int launcher) {
  int child = 0;
  while (child == 0) {
    for (const Relative& each : descendants_of(launcher)) child = each.pid;
  }
  return child;
}

}  // namespace culprit::owners
