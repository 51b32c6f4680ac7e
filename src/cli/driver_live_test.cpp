// Detects the driver of a node's lifecycle after its start, where neither a declaration nor a rule names a state: the node itself by a timer, or none. If the
// node's timer finds that another driver came first, the node exits with an error, as nodes in Python do.
#include <csignal>
#include <thread>

#include <gtest/gtest.h>

#include "base/environment.h"
#include "base/live_clock.h"
#include "cli/test_rows.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;

// The impact is 3 s.
struct ADriver : testing::Test {
  ~ADriver() override {
    for (const int pid : all_) kill(pid, SIGKILL);
  }
  // Watches a node that runs already, of which culprit sees only that it is active.
  void watch(const std::string& options) {
    if (!first_)
      first_.emplace(world, std::vector<std::string>{"ros2_peer_node", environment("ROS_DOMAIN_ID"),
                                                     "--active", "/lidar"});
    const std::string text = R"(
ROBOT driven
COMPONENT lidar NODE /lidar LAUNCH "ros2_peer_node )" +
                             environment("ROS_DOMAIN_ID") + options + R"( /lidar"
RULE Read
  POLICIES NON_CRITICAL REPORT
  TRIGGER lifecycle(lidar) == "active" || lifecycle(lidar) == "inactive"
RULE Down
  POLICIES ERROR
  TRIGGER alive(lidar) == false || lifecycle(lidar) == "finalized"
    STRATEGY again 90 10
      ADAPTATION lidar redeploy 15
)";
    run_.emplace(world, std::vector<std::string>{
                            "culprit", "run", world.write("driven.rules", text), "--quiet", "0",
                            "--backoff", "0", "--settle", "1", "--state-dir", state_});
    ASSERT_TRUE(run_->prints("lidar is there (process ")) << run_->output();
    ASSERT_TRUE(run_->prints("Read detected"))
        << run_->output();  // it says nothing of where it must be
    note();
  }
  void note() { all_.push_back(pid_in(run_->output(), "lidar")); }
  // Waits until culprit has said so often that it works again.
  void await(int times) {
    const auto is_resolved = [&] {
      const std::string said = run_->output();
      int count = 0;
      for (auto at = said.find(kResolved); at != said.npos; at = said.find(kResolved, at + 1))
        ++count;
      return count >= times;
    };
    const Time end = later(live_now(), TestProgram::kPatience);
    while (!is_resolved() && live_now() < end) std::this_thread::sleep_for(10ms);
    EXPECT_TRUE(is_resolved()) << run_->output();
    note();
  }
  void kill_and_await(int times) {
    kill(pid_in(run_->output(), "lidar"), SIGKILL);
    await(times);
  }
  Rows rows_at_the_end() {
    run_->signal(SIGINT);
    EXPECT_EQ(run_->wait(), 0);
    return Rows(state_ + "/driven.journal");
  }

  static constexpr const char* kResolved = "Down resolved by again";
  TestWorld world;
  const std::string state_ = (world.folder() / "state").string();
  std::optional<TestProgram> first_;
  std::optional<TestProgram> run_;
  std::vector<int> all_;
};

TEST_F(ADriver, OfWhichNothingIsKnownIsWaitedFor) {
  watch(" --activates-after 1");
  kill_and_await(1);
  kill_and_await(2);
  const Rows journal = rows_at_the_end();
  EXPECT_EQ(journal.requests("lidar: start process"), 2u) << journal.all();
  EXPECT_EQ(journal.requests("lidar: configure"), 0u) << journal.all();
  EXPECT_EQ(journal.requests("lidar: activate"), 0u) << journal.all();
}

// It would crash if it were activated before its timer. There is no history at its first start, so culprit only watches; the next culprit knows how long it
// takes.
TEST_F(ADriver, ThatComesLaterThanTheImpactIsLearned) {
  watch(" --activates-after 5");
  kill_and_await(1);
  rows_at_the_end();
  watch(" --activates-after 5");
  kill_and_await(1);
  const Rows journal = rows_at_the_end();
  EXPECT_EQ(journal.requests("lidar: start process"), 2u) << journal.all();
  EXPECT_EQ(journal.requests("lidar: configure"), 0u) << journal.all();
}

TEST_F(ADriver, ThatDoesNotExistIsReplacedWhenTheImpactIsOver) {
  watch("");
  kill_and_await(1);
  kill_and_await(2);
  const Rows journal = rows_at_the_end();
  const auto begun = journal.first("lidar: start process");
  const auto asked = journal.first("lidar: configure", begun);
  const auto again = journal.first("lidar: start process", asked);
  const auto at_once = journal.first("lidar: configure", again);
  ASSERT_TRUE(begun && asked && again && at_once) << journal.all();
  EXPECT_GE(asked->at - begun->at, 2500ms) << "somebody may come" << journal.all();
  EXPECT_LT(at_once->at - again->at, asked->at - begun->at) << "that nobody does is known";
}

}  // namespace
}  // namespace culprit::cli
