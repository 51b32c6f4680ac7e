// A node whose only thread hangs in a callback. Its process runs, and so do the threads of its middleware: only its silent topics and unanswered requests
// distinguish it from a healthy one. A node that is only slow, or held by a debugger, is left alone. Times are the journal's.
#include <csignal>
#include <fstream>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/environment.h"
#include "base/live_clock.h"
#include "cli/test_rows.h"
#include "owners/proc.h"
#include "owners/supervisor.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

template <class Done>
bool comes_true(Done done) {
  for (const Time end = later(live_now(), TestProgram::kPatience); !done();) {
    if (live_now() > end) return false;
    std::this_thread::sleep_for(10ms);
  }
  return true;
}

struct AHungNode : testing::Test {
  ~AHungNode() override {
    for (const int pid : all_) kill(pid, SIGKILL);
  }
  // Watches a node that publishes each `period`, started by culprit, until it was heard a few times.
  void watch(const std::string& trigger, const std::string& period = "0.1",
             const std::vector<std::string>& more = {}) {
    const std::string text = R"(
ROBOT hung
SIGNAL ticks TOPIC /lidar/value FIELD data
COMPONENT lidar NODE /lidar LIFECYCLE self LAUNCH "ros2_peer_node )" +
                             environment("ROS_DOMAIN_ID") + " --active --period " + period +
                             " --stalls-if " + stalls_ + R"( /lidar"
RULE Heard
  POLICIES NON_CRITICAL REPORT
  TRIGGER ticks > 4
RULE Silent
  POLICIES ERROR
  TRIGGER )" + trigger + R"(
    STRATEGY again 90 10
      ADAPTATION lidar redeploy 5
)";
    std::vector<std::string> arguments{"culprit",   "run",     world.write("hung.rules", text),
                                       "--launch",  "--quiet", "0",
                                       "--backoff", "0",       "--state-dir",
                                       state_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    run_.emplace(world, std::move(arguments));
    ASSERT_TRUE(run_->prints("Heard")) << run_->output();
    pid_ = pid_in(run_->output(), "lidar");
    all_.push_back(pid_);
  }
  // From when this returns on the node's thread does nothing for so many seconds.
  void stall(const std::string& seconds) {
    std::ofstream(stalls_ + ".new") << seconds << "\n";
    std::filesystem::rename(stalls_ + ".new", stalls_);
    ASSERT_TRUE(comes_true([&] { return !std::filesystem::exists(stalls_); })) << run_->output();
    stalled_ = std::chrono::system_clock::now().time_since_epoch();
  }
  void expect_replaced() {
    EXPECT_TRUE(run_->prints("Silent resolved by again")) << run_->output();
    const int now = pid_in(run_->output(), "lidar");
    EXPECT_NE(now, pid_);
    all_.push_back(now);
    EXPECT_EQ(owners::state_letter(pid_).value_or('Z'), 'Z') << "the hung one goes on";
  }
  void expect_left_alone() const {
    EXPECT_THAT(run_->output(), Not(HasSubstr("lidar is lost")));
    EXPECT_EQ(pid_in(run_->output(), "lidar"), pid_);
    EXPECT_EQ(rows().requests("lidar: stop process"), 0u) << rows().all();
  }
  Rows rows() const { return Rows(state_ + "/hung.journal"); }
  // The journal after culprit has ended.
  Rows rows_at_the_end() {
    run_->signal(SIGINT);
    EXPECT_EQ(run_->wait(), 0);
    return rows();
  }

  TestWorld world;
  const std::string state_ = (world.folder() / "state").string();
  const std::string stalls_ = (world.folder() / "stalls").string();
  std::optional<TestProgram> run_;
  std::chrono::nanoseconds stalled_{};
  int pid_ = 0;
  std::vector<int> all_;
};

constexpr const char* kProof =
    "lidar is lost: its process runs, but it does not answer and is silent";

// Two questions without an answer and a second of silence prove it, before anything is asked of it.
TEST_F(AHungNode, IsReplacedOnceItIsProvenToHang) {
  watch("alive(lidar) == false || age(/lidar/value) > 300ms");
  stall("1000");
  expect_replaced();
  const Rows journal = rows_at_the_end();
  const auto proof = journal.first(kProof);
  const auto asked = journal.first("lidar: stop process");
  ASSERT_TRUE(proof && asked) << journal.all();
  const auto ended = journal.first("lidar: stop process: done", asked);
  const auto begun = journal.first("lidar: start process", asked);
  ASSERT_TRUE(ended && begun) << journal.all();
  EXPECT_GE(asked->at, proof->at) << journal.all();
  EXPECT_EQ(journal.requests("lidar: stop process"), 1u) << journal.all();
  EXPECT_LT(ended->at - asked->at, owners::Supervisor::kPolite) << journal.all();
  // 1.2 to 1.6 s on a quiet machine.
  EXPECT_LT(begun->at - stalled_, 4s) << journal.all();
  RecordProperty("from_the_hang_to_the_start_ms", static_cast<int>((begun->at - stalled_) / 1ms));
}

// Its rule does not wait for the proof: it was asked to end by a signal that it does not obey.
TEST_F(AHungNode, ThatIsProvenToHangAfterItWasAskedToEndIsKilledAtOnce) {
  watch("age(/lidar/value) > 600ms", "0.1", {"--no-evidence"});
  stall("1000");
  expect_replaced();
  const Rows journal = rows_at_the_end();
  const auto proof = journal.first(kProof);
  const auto asked = journal.first("lidar: stop process");
  ASSERT_TRUE(proof && asked) << journal.all();
  const auto ended = journal.first("lidar: stop process: done", asked);
  ASSERT_TRUE(ended) << journal.all();
  const bool is_late = asked->at < proof->at;  // on a machine that is busy enough it is not
  EXPECT_EQ(journal.requests("lidar: stop process"), is_late ? 2u : 1u) << journal.all();
  EXPECT_LT(ended->at - std::max(asked->at, proof->at), 1s) << journal.all();
}

// It pauses for 1.5 s when it is well, and now for a moment answers nothing: that is no longer than ever.
TEST_F(AHungNode, IsNotOneThatIsSlowOnceButWithinItsPauses) {
  watch("alive(lidar) == false", "1.5");
  stall("1.3");
  std::this_thread::sleep_for(4s);  // that nothing happens takes time
  expect_left_alone();
}

// Its rule is true, and its answer is awaited; it comes.
TEST_F(AHungNode, IsNotOneThatAnswersLate) {
  watch("alive(lidar) == false || age(/lidar/value) > 400ms");
  stall("0.7");
  EXPECT_TRUE(run_->prints("culprit checks whether lidar still answers")) << run_->output();
  EXPECT_TRUE(run_->prints("Silent cleared")) << run_->output();
  expect_left_alone();
}

TEST_F(AHungNode, IsNotOneThatADebuggerHolds) {
  watch("alive(lidar) == false || age(/lidar/value) > 500ms");
  if (ptrace(PTRACE_SEIZE, pid_, nullptr, nullptr) != 0)
    GTEST_SKIP() << "no process may be traced here";
  ptrace(PTRACE_INTERRUPT, pid_, nullptr, nullptr);
  EXPECT_TRUE(run_->prints("is not replaced while a debugger holds it")) << run_->output();
  EXPECT_EQ(owners::state_letter(pid_), 't');
  waitpid(pid_, nullptr, __WALL);
  ptrace(PTRACE_DETACH, pid_, nullptr, nullptr);
  EXPECT_TRUE(run_->prints("Silent cleared")) << run_->output();
  EXPECT_THAT(run_->output(), Not(HasSubstr("lidar is lost")));
  EXPECT_EQ(pid_in(run_->output(), "lidar"), pid_);
}

}  // namespace
}  // namespace culprit::cli
