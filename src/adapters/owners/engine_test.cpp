// What is asked of a container engine, and what its answers are taken for. The server is a stand-in
// that speaks the Docker Engine API on a unix socket, and really runs a process for each container; no
// engine was asked.
#include "owners/engine.h"

#include <csignal>
#include <optional>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "language/checker.h"
#include "owners/proc.h"
#include "owners/test_engine.h"
#include "owners/test_process.h"
#include "owners/units.h"

namespace culprit::owners {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr Duration kLongEnough = 20s;
constexpr ComponentId kSlam{0};

struct ContainersOnAStandInForDocker : testing::Test {
  void SetUp() override {
    engine.add("slam");
    ask("slam");
  }
  void ask(const std::string& container) {
    units.reset();
    rules = *check(Source("test.rules", "COMPONENT slam NODE /slam CONTAINER docker " + container +
                                            "\nCOMPONENT camera NODE /camera\n"))
                 .rules;
    units.emplace(rules, inbox, Units::Of::kEngines);
  }
  template <class What, class Fits>
  std::optional<What> wait_for(Fits fits) {
    for (const Time end = later(live_now(), kLongEnough); live_now() < end;) {
      std::vector<Observation> seen;
      inbox.take(std::min(end, later(live_now(), 1s)), seen);
      for (const Observation& each : seen) {
        const auto* what = std::get_if<What>(&each.what);
        if (what != nullptr && fits(*what)) return *what;
      }
    }
    return std::nullopt;
  }
  Reply answer() {
    const auto reply =
        wait_for<Reply>([&](const Reply& each) { return each.command == CommandId{count}; });
    return reply ? *reply : Reply{{}, Outcome::kTimedOut, {}, "nothing was answered"};
  }
  Reply start() {
    units->start(CommandId{++count}, kSlam);
    return answer();
  }
  Reply stop(int pid, Ending ending = Ending::kToStartAgain) {
    units->stop(CommandId{++count}, kSlam, pid, ending);
    return answer();
  }

  TestEngine engine;
  Inbox inbox;
  RuleSet rules;
  std::optional<Units> units;
  std::uint64_t count = 0;
};

TEST_F(ContainersOnAStandInForDocker, AreStartedAndSayWhichProcess) {
  const Reply reply = start();
  EXPECT_EQ(reply.outcome, Outcome::kDone) << reply.text;
  EXPECT_EQ(reply.value, decltype(Reply::value)(Value(std::int64_t{engine.pid_of("slam")})));
  EXPECT_TRUE(is_alive(engine.pid_of("slam")));
  EXPECT_EQ(start().outcome, Outcome::kDone) << "it runs already";
  EXPECT_THAT(engine.asked(), ElementsAre("start slam"));
}

TEST_F(ContainersOnAStandInForDocker, AreReplacedByOneRequest) {
  const int old = engine.start("slam");
  const Reply reply = stop(old);
  EXPECT_EQ(reply.outcome, Outcome::kDone) << reply.text;
  EXPECT_FALSE(is_alive(old));
  EXPECT_EQ(start().outcome, Outcome::kDone);
  EXPECT_NE(engine.pid_of("slam"), old);
  EXPECT_THAT(engine.asked(), ElementsAre("restart slam"));
}

TEST_F(ContainersOnAStandInForDocker, ThatTheEngineStartedAgainAreNotEndedNorDoubled) {
  for (const char* policy : {"always", "unless-stopped"}) {
    engine.add("slam", {.policy = policy});
    const int old = engine.start("slam");
    end(old);
    const Reply reply = stop(old);
    EXPECT_EQ(reply.outcome, Outcome::kDone) << reply.text;
    EXPECT_EQ(start().outcome, Outcome::kDone);
    EXPECT_NE(engine.pid_of("slam"), old);
    end(engine.pid_of("slam"));
  }
  EXPECT_THAT(engine.asked(), IsEmpty());
}

TEST_F(ContainersOnAStandInForDocker, OfOthersProcessesAreNotEnded) {
  const int own = engine.start("slam");
  EXPECT_THAT(stop(getpid()).text, HasSubstr("it is not of slam"));
  EXPECT_TRUE(is_alive(own));
  units->found(kSlam, own);
  units->found(ComponentId(1), own);
  EXPECT_THAT(stop(own).text, HasSubstr("slam runs camera, too"));
  EXPECT_TRUE(is_alive(own));
  EXPECT_THAT(engine.asked(), IsEmpty());
}

TEST_F(ContainersOnAStandInForDocker, ThatAreMistypedAreToldWithWhatWasMeant) {
  ask("slamm");
  EXPECT_THAT(start().text, HasSubstr("docker has no slamm; did you mean slam?"));
  EXPECT_THAT(could_manage(*rules[kSlam].engine).error(), HasSubstr("did you mean slam?"));
  EXPECT_TRUE(could_manage(EngineContainer{EngineContainer::Engine::kDocker, "slam"}));
}

TEST_F(ContainersOnAStandInForDocker, ThatExitedAreDead) {
  const int pid = engine.start("slam");
  ASSERT_TRUE(stop(0, Ending::kForGood).outcome == Outcome::kDone);
  EXPECT_FALSE(is_alive(pid));
  engine.start("slam");
  std::this_thread::sleep_for(2 * Units::kIdlePeriod);  // it was seen
  end(engine.pid_of("slam"));
  const auto seen = wait_for<ProcessSeen>(
      [](const ProcessSeen& each) { return each.state == ProcessState::kGone; });
  ASSERT_TRUE(seen);
}

TEST_F(ContainersOnAStandInForDocker, ThatSomebodyPausedAreLeftToHim) {
  engine.add("slam", {.status = "paused"});
  EXPECT_THAT(stop(0).text, HasSubstr("docker unpause slam"));
  EXPECT_THAT(engine.asked(), IsEmpty());
}

TEST_F(ContainersOnAStandInForDocker, ThatCannotStartSayWhereToLook) {
  engine.add("slam", {.is_broken = true});
  EXPECT_THAT(start().text, HasSubstr("docker logs slam says why"));
}

TEST_F(ContainersOnAStandInForDocker, AreNotEndedOnWordsThatMakeNoSense) {
  const int pid = engine.start("slam");
  for (const char* answer :
       {"hello", "HTTP/1.0 200 OK\r\n\r\n", "HTTP/1.0 200 OK\r\n\r\n[]",
        "HTTP/1.0 200 OK\r\n\r\n{\"State\": 7}",
        "HTTP/1.0 200 OK\r\n\r\n{\"State\": {\"Status\": \"running\", \"Pid\": -1, "
        "\"ExitCode\": 0}}",
        "HTTP/1.0 200 OK\r\n\r\n{\"State\": {\"Status\": \"sleepy\", \"Pid\": 7, "
        "\"ExitCode\": 0}}",
        "HTTP/1.0 500 X\r\n\r\n{\"message\": \"no\"}"}) {
    engine.say(answer);
    EXPECT_EQ(stop(pid).outcome, Outcome::kRefused) << answer;
  }
  engine.say("");
  EXPECT_TRUE(is_alive(pid));
  EXPECT_THAT(engine.asked(), IsEmpty());
}

TEST_F(ContainersOnAStandInForDocker, AreRefusedInTimeIfTheEngineHangsOrIsGone) {
  const int pid = engine.start("slam");
  engine.hang(true);
  const Time before = live_now();
  EXPECT_THAT(stop(pid).text, HasSubstr("does not answer"));
  EXPECT_LT(live_now() - before, Units::kEnd);
  engine.hang(false);
  std::filesystem::rename(engine.socket(), engine.socket() + "-away");
  EXPECT_THAT(stop(pid).text, HasSubstr("is it running?"));
  setenv("DOCKER_HOST", "tcp://elsewhere:2375", 1);
  EXPECT_THAT(stop(pid).text, HasSubstr("a socket of this machine"));
  EXPECT_TRUE(is_alive(pid));
}

}  // namespace
}  // namespace culprit::owners
