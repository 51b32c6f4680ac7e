// Requests to a container engine, and how its answers are read. The server is a stand-in that
// speaks the Docker Engine API on a unix socket, and really runs a process for each container; no
// engine was asked.
#include "owners/engine.h"

#include <ctime>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "language/checker.h"
#include "owners/proc.h"
#include "owners/service_units.h"
#include "owners/test_asked_owner.h"
#include "owners/test_engine.h"
#include "owners/test_process.h"

namespace culprit::owners {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr ComponentId kSlam{0};

// As docker writes it; in seconds since 1970.
std::string date_of(std::int64_t at) {
  const std::time_t seconds = at;
  std::tm day{};
  char text[sizeof "2024-05-01T12:00:00Z"];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&seconds, &day));
  return text;
}

struct ContainersOnAStandInForDocker : AsksAnOwner {
  void SetUp() override {
    engine.add("slam");
    ask("slam");
  }
  void TearDown() override { units.reset(); }  // before the engine that it asks
  void ask(const std::string& container) {
    manage("slam", "CONTAINER docker " + container, Units::Of::kEngines);
  }

  TestEngine engine;
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
  // Once it looks again it has made something of the look before.
  for (const int looks = engine.looks(); engine.looks() < looks + 2;)
    std::this_thread::sleep_for(1ms);
  end(engine.pid_of("slam"));
  const auto seen = wait_for<ProcessSeen>(
      [](const ProcessSeen& each) { return each.state == ProcessState::kGone; });
  ASSERT_TRUE(seen);
}

// Exit codes as docker stop leaves them. A container that was killed may have hung.
TEST_F(ContainersOnAStandInForDocker, ThatEndInAnOrderlyWayAreToldAsAnOrder) {
  for (const int code : {0, 143, 137}) {
    engine.add("slam");
    engine.start("slam");
    for (const int looks = engine.looks(); engine.looks() < looks + 2;)
      std::this_thread::sleep_for(1ms);
    engine.add("slam", {.status = "exited", .code = code});
    const auto seen = wait_for<ProcessSeen>(
        [](const ProcessSeen& each) { return each.state == ProcessState::kGone; });
    ASSERT_TRUE(seen) << code;
    EXPECT_EQ(seen->cause, code == 137 ? Cause::kUnknown : Cause::kOrder) << code;
  }
}

// It did not end within the grace of docker stop, or answers it with an error, as nodes in Python do. Its own end after
// a restart is none of these, nor is one on a signal that asks for something else.
TEST_F(ContainersOnAStandInForDocker, ThatAStopEndsAreToldAsAnOrderWhateverTheirExitCode) {
  struct Case {
    int code;
    std::string events;
    bool is_order;
  };
  const std::string stop = event_of("kill", "15") + event_of("stop");
  for (const Case& each :
       {Case{137, stop, true}, Case{1, stop, true}, Case{139, stop, true},
        Case{1, event_of("kill", "15"), true}, Case{1, "", false},
        Case{1, event_of("kill", "1"), false}, Case{137, event_of("kill", "9"), false},
        Case{1, stop + event_of("start"), false}, Case{1, "no JSON\n", false}}) {
    engine.add("slam");
    engine.start("slam");
    for (const int looks = engine.looks(); engine.looks() < looks + 2;)
      std::this_thread::sleep_for(1ms);
    engine.add("slam", {.status = "exited", .code = each.code, .events = each.events});
    const auto seen = wait_for<ProcessSeen>(
        [](const ProcessSeen& one) { return one.state == ProcessState::kGone; });
    ASSERT_TRUE(seen) << each.code << each.events;
    EXPECT_EQ(seen->cause, each.is_order ? Cause::kOrder : Cause::kUnknown)
        << each.code << each.events;
  }
}

// culprit looks at it long after, over a restart of its own or while the engine did not answer; or the clock was set.
TEST_F(ContainersOnAStandInForDocker, ThatAStopEndedLongAgoAreToldAsAnOrder) {
  constexpr std::int64_t kNoon = 1'714'564'800;  // 2024-05-01T12:00:00Z
  struct Case {
    std::string finished_at;
    std::int64_t asked_to_end;
    bool is_order;
  };
  const std::int64_t now = wall_now() / 1'000'000'000;
  for (const Case& each :
       {Case{"2024-05-01T12:00:00.123456789Z", kNoon - 29, true},
        Case{"2024-05-01T14:00:00+02:00", kNoon + 1, true},
        Case{"2024-05-01T12:00:00Z", kNoon - 31, false}, Case{"2024-05-01T12:00:00Z", now, false},
        Case{"9999-05-01T12:00:00Z", now - 1, true}, Case{"0001-01-01T00:00:00Z", now - 1, true},
        Case{"yesterday", now - 1, true}, Case{"yesterday", now - 60, false}}) {
    engine.add("slam", {.status = "exited",
                        .code = 1,
                        .events = event_of("kill", "15", each.asked_to_end),
                        .finished_at = each.finished_at});
    const auto state = Engine(EngineContainer::Engine::kDocker).state_of("slam");
    ASSERT_TRUE(state) << state.error();
    EXPECT_EQ(state->is_orderly, each.is_order) << each.finished_at << ' ' << each.asked_to_end;
  }
}

TEST_F(ContainersOnAStandInForDocker, ThatAStopHadEndedBeforeAnybodyLookedAreToldAsAnOrder) {
  engine.add("slam", {.status = "exited",
                      .code = 1,
                      .events = event_of("stop"),
                      .finished_at = "2024-05-01T12:00:00Z"});
  ask("slam");
  const auto seen = wait_for<ProcessSeen>(
      [](const ProcessSeen& each) { return each.state == ProcessState::kGone; });
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->cause, Cause::kOrder);
}

// Its policy may have started it between two looks.
TEST_F(ContainersOnAStandInForDocker, ThatCrashedAndWereStoppedAfterThatAreToldAsAnOrder) {
  Engine docker(EngineContainer::Engine::kDocker);
  for (const bool is_stopped : {false, true}) {
    engine.add("slam",
               {.status = "exited",
                .code = 1,
                .events = is_stopped ? event_of("stop") : "",
                .finished_at = is_stopped ? "2024-05-01T12:00:09Z" : "2024-05-01T12:00:00Z"});
    const auto state = docker.state_of("slam");
    ASSERT_TRUE(state) << state.error();
    EXPECT_EQ(state->is_orderly, is_stopped);
  }
}

// The engine writes the event of a stop once the container has ended, and a look may come between.
TEST_F(ContainersOnAStandInForDocker, ThatAStopHasJustEndedAreToldAsAnOrderOnceTheEngineSaysSo) {
  Engine docker(EngineContainer::Engine::kDocker);
  const auto is_orderly = [&](const std::string& finished_at, const std::string& events) {
    engine.add("slam",
               {.status = "exited", .code = 1, .events = events, .finished_at = finished_at});
    const auto state = docker.state_of("slam");
    return state && state->is_orderly;
  };
  const std::string just_now = date_of(wall_now() / 1'000'000'000);
  EXPECT_FALSE(is_orderly(just_now, ""));
  EXPECT_TRUE(is_orderly(just_now, event_of("stop")));
  EXPECT_TRUE(is_orderly(just_now, "")) << "it is not asked once more";
  EXPECT_FALSE(is_orderly("2024-05-01T12:00:00Z", ""));
  EXPECT_FALSE(is_orderly("2024-05-01T12:00:00Z", event_of("stop"))) << "it would have come";
}

TEST_F(ContainersOnAStandInForDocker, AreNotJudgedWhileTheEngineDoesNotSayWhatHappened) {
  Engine docker(EngineContainer::Engine::kDocker);
  engine.add("slam", {.status = "exited", .code = 1, .events = event_of("stop")});
  engine.withhold_events(true);
  EXPECT_FALSE(docker.state_of("slam"));
  engine.withhold_events(false);
  const auto state = docker.state_of("slam");
  EXPECT_TRUE(state && state->is_orderly);
}

TEST_F(ContainersOnAStandInForDocker, CountAsCrashedIfTheEngineNeverSaysWhatHappened) {
  Engine docker(EngineContainer::Engine::kDocker);
  engine.add("slam", {.status = "exited", .code = 1, .events = event_of("stop")});
  engine.withhold_events(true);
  EXPECT_FALSE(docker.state_of("slam"));
  EXPECT_FALSE(docker.state_of("slam"));
  const auto crashed = docker.state_of("slam");
  ASSERT_TRUE(crashed) << crashed.error();
  EXPECT_FALSE(crashed->is_orderly);
  engine.withhold_events(false);
  const auto state = docker.state_of("slam");
  EXPECT_TRUE(state && state->is_orderly) << "it says so late";
}

// The kernel reports the end to the manager before anybody has looked at the container.
TEST_F(ContainersOnAStandInForDocker, ThatAStopEndedAreNotStartedByAnErrandThatCameSooner) {
  const int pid = engine.start("slam");
  for (const int looks = engine.looks(); engine.looks() < looks + 2;)
    std::this_thread::sleep_for(1ms);
  engine.add("slam", {.status = "exited", .code = 1, .events = event_of("stop")});
  const Reply reply = stop(pid);
  EXPECT_EQ(reply.outcome, Outcome::kRefused);
  EXPECT_THAT(reply.text, HasSubstr("docker was told to end it"));
  EXPECT_THAT(engine.asked(), IsEmpty());
  EXPECT_EQ(start().outcome, Outcome::kDone) << "as a person orders after that";
  EXPECT_TRUE(is_alive(engine.pid_of("slam")));
}

// Signals are how somebody stops it on purpose, too.
TEST_F(ContainersOnAStandInForDocker, ThatHadExitedBeforeAnybodyLookedAreDeadIfTheyFailed) {
  for (const int code : {0, 137, 1}) {
    engine.add("slam", {.status = "exited", .code = code});
    ask("slam");
    for (const int looks = engine.looks(); engine.looks() < looks + 2;)
      std::this_thread::sleep_for(1ms);
    std::vector<Observation> seen;
    inbox.take(live_now(), seen);
    ASSERT_EQ(seen.size(), code == 1 ? 1u : 0u) << code;
    if (code == 1) {
      EXPECT_EQ(std::get<ProcessSeen>(seen[0].what).remark, "slam failed: exit code 1");
    }
  }
}

TEST_F(ContainersOnAStandInForDocker, ThatSomebodyPausedAreLeftToHim) {
  engine.add("slam", {.status = "paused"});
  EXPECT_THAT(stop(0).text, HasSubstr("docker unpause slam"));
  EXPECT_THAT(engine.asked(), IsEmpty());
}

TEST_F(ContainersOnAStandInForDocker, ThatCannotStartSayWhereToLook) {
  engine.add("slam", {.is_broken = true});
  EXPECT_THAT(start().text, HasSubstr("see docker logs slam"));
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

// It is being upgraded: no attempt helps until it is back, and its containers may run on (live-restore).
TEST_F(ContainersOnAStandInForDocker, CannotBeStartedUntilTheEngineAnswersAgain) {
  const int pid = engine.start("slam");
  engine.hang(true);
  const auto barred = [&](bool is_barred) {
    return wait_for<StartBarred>(
        [&](const StartBarred& b) { return b.missing.empty() != is_barred; });
  };
  units->stop(CommandId{++count}, kSlam, pid, Ending::kToStartAgain, Hangs::kNo);
  const auto away = barred(true);
  ASSERT_TRUE(away);
  EXPECT_EQ(away->missing, "docker: it does not answer");
  engine.hang(false);
  EXPECT_TRUE(barred(false));
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
