// Random sequences of faults, for each kind of owner, with culprit killed in between. The test
// requests the same things as the manager. At no time do two processes run that culprit started.
// Once it has settled, exactly one runs, also if somebody else starts one. The sequences of
// composed nodes are in composed_nodes_test.cpp.
//
// CULPRIT_SEQUENCES sets how many of each kind (12 unless set), CULPRIT_SEQUENCES_SEED with which
// the first begins.
#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <random>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "base/test_folder.h"
#include "language/checker.h"
#include "owners/mark.h"
#include "owners/service_units.h"
#include "owners/spawn.h"
#include "owners/test_engine.h"
#include "owners/test_process.h"
#include "owners/test_systemd.h"

namespace culprit::owners {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

constexpr ComponentId kOne{0};

unsigned number_from(const char* variable, unsigned otherwise) {
  const char* value = std::getenv(variable);
  return value == nullptr ? otherwise : static_cast<unsigned>(std::atoi(value));
}

// Processes that run `program`, stopped ones included.
std::vector<int> running(const std::string& program) {
  std::vector<int> pids;
  for (const auto& each : fs::directory_iterator("/proc")) {
    const int pid = std::atoi(each.path().filename().c_str());
    if (pid == 0 || !is_alive(pid)) continue;
    std::error_code error;
    if (fs::read_symlink(each.path() / "exe", error) == program) pids.push_back(pid);
  }
  return pids;
}

// A program to be kept running, with the owner that keeps it running.
class Kept {
 public:
  virtual ~Kept() = default;
  virtual std::vector<int> processes() = 0;
  virtual void begin_culprit() = 0;
  virtual void kill_culprit() = 0;  // whatever it is doing
  virtual void order_redeploy() = 0;
  virtual bool redeploy() = 0;
  virtual bool start() = 0;
  virtual void break_it(bool is_broken) = 0;
  // Another program than culprit starts one beside.
  virtual void start_by_another() {}
  // Culprit receives the present processes.
  virtual void hear() {}
  // The invariant that is broken now; empty: none.
  virtual std::string wrong() { return ""; }
};

template <class Asked>
Reply reply_to(Asked& inbox, CommandId command) {
  for (const Time end = later(live_now(), 20s); live_now() < end;) {
    std::vector<Observation> seen;
    inbox.take(end, seen);
    for (const Observation& each : seen) {
      const auto* reply = std::get_if<Reply>(&each.what);
      if (reply != nullptr && reply->command == command) return *reply;
    }
  }
  return {command, Outcome::kTimedOut, {}, "no reply"};
}

// By LAUNCH, while a launch file starts one, too, now and then.
class Launched : public Kept {
 public:
  explicit Launched(const std::string& clauses = "") {
    fs::copy_file("/bin/sleep", program_);
    rules_ = *check(Source("one.rules", "COMPONENT one NODE /one LAUNCH \"" + program_ +
                                            " 1000\" " + clauses + "\n"))
                  .rules;
  }
  ~Launched() override {
    supervisor_.reset();
    for (const int pid : running(program_)) end(pid);
    while (waitpid(-1, nullptr, WNOHANG) > 0) {
    }
  }
  std::vector<int> processes() override { return running(program_); }
  void begin_culprit() override {
    supervisor_ = std::make_unique<Supervisor>(
        rules_, Supervisor::Options{folder_.path() / "log", {}, robot_}, inbox_);
  }
  void kill_culprit() override { supervisor_.reset(); }
  void hear() override {
    for (const int pid : processes()) supervisor_->adopt(kOne, pid, live_now());
    const std::set<int> ours = supervisor_->started(kOne);
    const auto is_others = [&](int pid) {
      return !ours.contains(pid) && !carries_mark(pid, robot_ + "/one") && state_letter(pid) != 'T';
    };
    const std::vector<int> all = processes();
    if (!ours.empty() && std::any_of(all.begin(), all.end(), is_others))
      supervisor_->withdraw(kOne);
  }
  void order_redeploy() override {
    supervisor_->stop(CommandId{++commands_}, kOne, 0, Ending::kToStartAgain, Hangs::kYes);
  }
  bool redeploy() override {
    order_redeploy();
    const Reply stopped = reply_to(inbox_, CommandId{commands_});
    return stopped.outcome == Outcome::kDone && start();
  }
  bool start() override {
    supervisor_->start(CommandId{++commands_}, kOne);
    return reply_to(inbox_, CommandId{commands_}).outcome == Outcome::kDone;
  }
  void break_it(bool is_broken) override {
    fs::permissions(program_, is_broken ? fs::perms(0644) : fs::perms(0755));
  }
  // Its parent exits, so init is its parent. If several ran, only a person could end one of them.
  void start_by_another() override {
    if (!are_all_culprits()) return;
    // Closed when it is the program: before that, the test could not find it to end it.
    std::array<int, 2> begun{};
    ASSERT_EQ(pipe2(begun.data(), O_CLOEXEC), 0);
    const pid_t parent = fork();
    if (parent == 0) {
      if (fork() == 0) {
        setsid();
        execl(program_.c_str(), "sleep", "1000", nullptr);
      }
      _exit(0);
    }
    close(begun[1]);
    char nothing = 0;
    EXPECT_EQ(read(begun[0], &nothing, 1), 0);
    close(begun[0]);
    waitpid(parent, nullptr, 0);
  }
  std::string wrong() override {
    const std::size_t ours = launched_as(robot_ + "/one").size();
    return ours > 1 ? "culprit started " + std::to_string(ours) : "";
  }

 private:
  test::TestFolder folder_;

 protected:
  bool are_all_culprits() {
    return std::ranges::all_of(processes(),
                               [&](int pid) { return carries_mark(pid, robot_ + "/one"); });
  }

  std::string program_ = fs::canonical(folder_.path()) / "one";
  std::string robot_ = "test/" + folder_.path().string();

 private:
  RuleSet rules_;
  Inbox inbox_;
  std::unique_ptr<Supervisor> supervisor_;
  std::uint64_t commands_ = 0;
};

// By a launcher that starts it again (RESPAWNED), and may itself end, or begin late.
class Respawned : public Launched {
 public:
  Respawned() : Launched("RESPAWNED") { begin_launcher(); }
  // With what it has forked and what is no process of the program yet: the test could not find that
  // later.
  ~Respawned() override {
    if (launcher_ != 0) kill(-launcher_, SIGKILL);
    end_launcher();
  }
  bool start() override {
    // A culprit that never saw the launcher waits for it: a person has to start that again.
    if (!is_alive(launcher_) && processes().empty()) begin_launcher();
    return Launched::start();
  }
  void break_it(bool is_broken) override {
    if (is_broken) {
      end_launcher();
    } else {
      start_by_another();
    }
  }
  // A process that an earlier launcher left behind has no launcher, and only a person could end one
  // of several.
  void start_by_another() override {
    if (!is_alive(launcher_) && are_all_culprits()) begin_launcher();
  }

 private:
  void begin_launcher() {
    launcher_ = fork();
    if (launcher_ == 0) {
      setsid();
      execl("/bin/sh", "sh", "-c", "while :; do \"$0\" 1000; sleep 0.02; done", program_.c_str(),
            nullptr);
      _exit(1);
    }
  }
  void end_launcher() {
    if (launcher_ == 0) return;
    kill(launcher_, SIGKILL);
    waitpid(launcher_, nullptr, 0);
    launcher_ = 0;
  }

  int launcher_ = 0;
};

// The owner is asked to start and end it.
class Asked : public Kept {
 public:
  Asked(const std::string& clauses, Units::Of whose)
      : rules_(*check(Source("one.rules", "COMPONENT one NODE /one " + clauses + "\n")).rules),
        whose_(whose) {}
  void begin_culprit() override { units_ = std::make_unique<Units>(rules_, inbox_, whose_); }
  void kill_culprit() override { units_.reset(); }
  void hear() override {
    for (const int pid : processes()) units_->found(kOne, pid);
  }
  void order_redeploy() override {
    const auto all = processes();
    units_->stop(CommandId{++commands_}, kOne, all.empty() ? 0 : all.front(),
                 Ending::kToStartAgain);
  }
  bool redeploy() override {
    order_redeploy();
    return reply_to(inbox_, CommandId{commands_}).outcome == Outcome::kDone && start();
  }
  bool start() override {
    units_->start(CommandId{++commands_}, kOne);
    return reply_to(inbox_, CommandId{commands_}).outcome == Outcome::kDone;
  }

 protected:
  std::unique_ptr<Units> units_;

 private:
  RuleSet rules_;
  Units::Of whose_;
  Inbox inbox_;
  std::uint64_t commands_ = 0;
};

class UnitKept : public Asked {
 public:
  explicit UnitKept(bool restarts) : Asked("UNIT one.service", Units::Of::kSystemd) {
    systemd_.add("one.service", {.restarts = restarts});
  }
  ~UnitKept() override { units_.reset(); }
  std::vector<int> processes() override {
    const int pid = systemd_.pid_of("one.service");
    return is_alive(pid) ? std::vector{pid} : std::vector<int>();
  }
  void break_it(bool is_broken) override { systemd_.refuse(is_broken ? kDenied : ""); }
  void start_by_another() override { systemd_.start("one.service"); }

 private:
  static constexpr const char* kDenied = "org.freedesktop.DBus.Error.AccessDenied";
  TestBus bus_;
  TestSystemd systemd_{bus_};
};

class ContainerKept : public Asked {
 public:
  explicit ContainerKept(const std::string& policy)
      : Asked("CONTAINER docker one", Units::Of::kEngines) {
    engine_.add("one", {.policy = policy});
  }
  ~ContainerKept() override { units_.reset(); }
  std::vector<int> processes() override {
    const int pid = engine_.pid_of("one");
    return is_alive(pid) ? std::vector{pid} : std::vector<int>();
  }
  void break_it(bool is_broken) override {
    engine_.say(is_broken ? "HTTP/1.0 500 X\r\n\r\n{\"message\": \"no\"}" : "");
  }
  void start_by_another() override {
    if (processes().empty()) engine_.start("one");
  }

 private:
  TestEngine engine_;
};

// Does as the manager does when too few or too many run.
void settle(Kept& kept) {
  kept.break_it(false);
  for (int tries = 0; tries < 10; ++tries) {
    kept.hear();
    const auto are_two = [&] {
      const std::vector<int> all = kept.processes();
      return all.size() > 1 &&
             std::ranges::none_of(all, [](int pid) { return state_letter(pid) == 'T'; });
    };
    for (const Time end = later(live_now(), 6s); are_two() && live_now() < end; kept.hear())
      std::this_thread::sleep_for(5ms);
    const std::vector<int> all = kept.processes();
    if (all.size() == 1 && state_letter(all.front()) != 'T') return;
    if (all.empty()) {
      kept.start();
      // The launcher that starts it again may take its time.
      for (const Time end = later(live_now(), 5s); kept.processes().empty() && live_now() < end;)
        std::this_thread::sleep_for(5ms);
    } else {
      kept.redeploy();
    }
  }
}

void play(Kept& kept, unsigned seed) {
  std::mt19937 random(seed);
  std::string played;
  const auto did = [&](const char* what) { played += std::string(" ") + what; };
  kept.begin_culprit();
  kept.start();
  for (int step = 0; step < 6; ++step) {
    kept.hear();
    const std::vector<int> all = kept.processes();
    switch (random() % 7) {
      case 0:
        did("killed");
        if (!all.empty()) end(all[random() % all.size()]);  // one that is about to end still runs
        break;
      case 1:
        did("stopped");
        if (!all.empty()) kill(all[random() % all.size()], SIGSTOP);
        break;
      case 2:
        did("culprit-killed-in-a-redeploy");
        kept.order_redeploy();
        if (random() % 2 == 0)
          std::this_thread::sleep_for(std::chrono::milliseconds(random() % 60));
        kept.kill_culprit();
        kept.begin_culprit();
        break;
      case 3:
        did("culprit-killed");
        kept.kill_culprit();
        if (!all.empty() && random() % 2 == 0) kill(all.front(), SIGKILL);
        kept.begin_culprit();
        break;
      case 4:
        did("broken");
        kept.break_it(true);
        kept.redeploy();
        kept.break_it(false);
        break;
      case 5:
        did("started-by-another");
        kept.start_by_another();
        break;
      default:
        did("redeployed");
        kept.redeploy();
    }
    ASSERT_EQ(kept.wrong(), "") << "seed " << seed << ":" << played;
  }
  settle(kept);
  EXPECT_EQ(kept.processes().size(), 1u) << "seed " << seed << ":" << played;
  EXPECT_EQ(kept.wrong(), "") << "seed " << seed << ":" << played;
}

template <class Make>
void play_all(Make make) {
  const unsigned first = number_from("CULPRIT_SEQUENCES_SEED", 1);
  const unsigned last = first + number_from("CULPRIT_SEQUENCES", 12);
  for (unsigned seed = first; seed < last && !testing::Test::HasFailure(); ++seed)
    play(*make(seed), seed);
}

TEST(AnySequenceOfFaults, LeavesOneOfWhatCulpritLaunches) {
  play_all([](unsigned) { return std::make_unique<Launched>(); });
}

TEST(AnySequenceOfFaults, LeavesOneOfWhatALauncherStartsAgain) {
  play_all([](unsigned) { return std::make_unique<Respawned>(); });
}

TEST(AnySequenceOfFaults, LeavesOneOfWhatAStandInForSystemdRuns) {
  play_all([](unsigned seed) { return std::make_unique<UnitKept>(seed % 2 == 0); });
}

TEST(AnySequenceOfFaults, LeavesOneOfWhatAStandInForDockerRuns) {
  play_all([](unsigned seed) {
    return std::make_unique<ContainerKept>(seed % 2 == 0 ? "always" : "no");
  });
}

}  // namespace
}  // namespace culprit::owners
