// Requests to systemd, and how its answers are read. The server is a stand-in that speaks systemd's
// published interface on a real dbus-daemon and really runs a process for each unit;
// units_live_test.cpp asks systemd itself.
#include "owners/service_units.h"

#include <csignal>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "owners/proc.h"
#include "owners/test_asked_owner.h"
#include "owners/test_process.h"
#include "owners/test_systemd.h"

namespace culprit::owners {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr ComponentId kLidar{0};

struct UnitsOnAStandInForSystemd : AsksAnOwner {
  void SetUp() override {
    systemd.add("lidar.service");
    ask();
  }
  void TearDown() override { units.reset(); }  // before the bus that it asks
  void ask(const std::string& clauses = "UNIT lidar.service") {
    manage("lidar", clauses, Units::Of::kSystemd);
  }
  int running() { return systemd.start("lidar.service"); }
  int now_running() { return systemd.pid_of("lidar.service"); }

  TestBus bus;
  TestSystemd systemd{bus};
};

TEST_F(UnitsOnAStandInForSystemd, AreStartedAndSayWhichProcess) {
  const Reply reply = start();
  EXPECT_EQ(reply.outcome, Outcome::kDone) << reply.text;
  EXPECT_EQ(reply.value, decltype(Reply::value)(Value(std::int64_t{now_running()})));
  EXPECT_TRUE(is_alive(now_running()));
  EXPECT_EQ(start().outcome, Outcome::kDone) << "it runs already";
  EXPECT_THAT(systemd.asked(), ElementsAre("StartUnit lidar.service"));
}

TEST_F(UnitsOnAStandInForSystemd, RunWhileTheyReloadOrRefresh) {
  const int pid = running();
  for (const char* active : {"reloading", "refreshing"}) {
    systemd.say(active, static_cast<std::uint32_t>(pid));
    const Reply reply = start();
    EXPECT_EQ(reply.outcome, Outcome::kDone) << reply.text;
  }
  EXPECT_THAT(systemd.asked(), IsEmpty());
}

TEST_F(UnitsOnAStandInForSystemd, AreReplacedByOneRequest) {
  const int old = running();
  const Reply reply = stop(old);
  EXPECT_EQ(reply.outcome, Outcome::kDone) << reply.text;
  EXPECT_FALSE(is_alive(old));
  EXPECT_EQ(start().outcome, Outcome::kDone);
  EXPECT_TRUE(is_alive(now_running()));
  EXPECT_NE(now_running(), old);
  EXPECT_THAT(systemd.asked(), ElementsAre("RestartUnit lidar.service"));
}

TEST_F(UnitsOnAStandInForSystemd, ThatSystemdStartedAgainAreNotEndedNorDoubled) {
  systemd.add("lidar.service", {.restarts = true});
  const int old = running();
  end(old);
  EXPECT_EQ(stop(old).outcome, Outcome::kDone);
  EXPECT_EQ(start().outcome, Outcome::kDone);
  EXPECT_TRUE(is_alive(now_running()));
  EXPECT_THAT(systemd.asked(), IsEmpty());
}

TEST_F(UnitsOnAStandInForSystemd, ThatAreDeadAreStartedOnce) {
  const int old = running();
  end(old);
  EXPECT_EQ(stop(old).outcome, Outcome::kDone);
  EXPECT_EQ(start().outcome, Outcome::kDone);
  EXPECT_TRUE(is_alive(now_running()));
  EXPECT_THAT(systemd.asked(), ElementsAre("StartUnit lidar.service"));
}

TEST_F(UnitsOnAStandInForSystemd, ThatDoNotEndPolitelyAreKilled) {
  systemd.add("lidar.service", {.heeds_signals = false});
  const int old = running();
  EXPECT_EQ(stop(old).outcome, Outcome::kDone);
  EXPECT_TRUE(start().outcome == Outcome::kDone && now_running() != old);
  EXPECT_THAT(systemd.asked(), ElementsAre("RestartUnit lidar.service", "KillUnit lidar.service"));
}

TEST_F(UnitsOnAStandInForSystemd, ThatHangAreKilledSoon) {
  systemd.add("lidar.service", {.heeds_signals = false});
  const int old = running();
  const Time before = live_now();
  EXPECT_EQ(stop(old, Ending::kToStartAgain, Hangs::kYes).outcome, Outcome::kDone);
  EXPECT_LT(live_now() - before, Units::kPolite);
  EXPECT_TRUE(start().outcome == Outcome::kDone && now_running() != old);
  EXPECT_THAT(systemd.asked(), ElementsAre("RestartUnit lidar.service", "KillUnit lidar.service"));
}

TEST_F(UnitsOnAStandInForSystemd, ThatAreStoppedAreKilledAtOnce) {
  const int old = running();
  kill(old, SIGSTOP);
  while (state_letter(old) != 'T') std::this_thread::sleep_for(5ms);
  const Time before = live_now();
  EXPECT_EQ(stop(old).outcome, Outcome::kDone);
  EXPECT_LT(live_now() - before, Units::kPolite);
  EXPECT_THAT(systemd.asked(), ElementsAre("RestartUnit lidar.service", "KillUnit lidar.service"));
}

// A person looks at it.
TEST_F(UnitsOnAStandInForSystemd, ThatADebuggerHoldsAreNotReplaced) {
  const int held = running();
  const int debugger = fork();
  if (debugger == 0) {
    if (ptrace(PTRACE_SEIZE, held, nullptr, nullptr) != 0) _exit(1);
    ptrace(PTRACE_INTERRUPT, held, nullptr, nullptr);
    while (true) pause();
  }
  bool may_trace = true;
  while (may_trace && state_letter(held) != 't') {
    std::this_thread::sleep_for(5ms);
    may_trace = waitpid(debugger, nullptr, WNOHANG) == 0;
  }
  if (!may_trace) GTEST_SKIP() << "no process may be traced here";
  const Reply refused = stop(held, Ending::kToStartAgain, Hangs::kYes);
  EXPECT_EQ(refused.outcome, Outcome::kRefused);
  EXPECT_THAT(refused.text, HasSubstr("is not replaced while a debugger holds it"));
  EXPECT_TRUE(is_alive(held));
  EXPECT_THAT(systemd.asked(), IsEmpty());
  kill(debugger, SIGKILL);  // and it goes on
  waitpid(debugger, nullptr, 0);
  EXPECT_EQ(stop(held).outcome, Outcome::kDone);
  EXPECT_THAT(systemd.asked(), ElementsAre("RestartUnit lidar.service"));
}

TEST_F(UnitsOnAStandInForSystemd, AreEndedForGood) {
  systemd.add("lidar.service", {.restarts = true});
  const int old = running();
  EXPECT_EQ(stop(old, Ending::kForGood).outcome, Outcome::kDone);
  EXPECT_FALSE(is_alive(old));
  EXPECT_EQ(now_running(), 0);
  EXPECT_THAT(systemd.asked(), ElementsAre("StopUnit lidar.service"));
}

// `ros2 run` is the unit's main process, and the node a child of it that it may outlive.
TEST_F(UnitsOnAStandInForSystemd, OfWhichAChildWasTheNodeAreRestartedIfOnlyThatEnded) {
  const int main = running();
  const int node = fork();
  if (node == 0) {
    pause();
    _exit(0);
  }
  units->found(kLidar, node);
  start();  // what was found before is known by now
  kill(node, SIGKILL);
  waitpid(node, nullptr, 0);
  EXPECT_EQ(stop(node).outcome, Outcome::kDone);
  EXPECT_FALSE(is_alive(main));
  EXPECT_EQ(start().outcome, Outcome::kDone);
  EXPECT_THAT(systemd.asked(), ElementsAre("RestartUnit lidar.service"));
}

TEST_F(UnitsOnAStandInForSystemd, DoNotEndWhatIsNotTheirs) {
  const int main = running();
  const int other = fork();
  if (other == 0) {
    pause();
    _exit(0);
  }
  const Reply reply = stop(other);
  EXPECT_EQ(reply.outcome, Outcome::kRefused);
  EXPECT_THAT(reply.text, HasSubstr("is not of lidar.service"));
  EXPECT_TRUE(is_alive(main));
  EXPECT_TRUE(is_alive(other));
  EXPECT_THAT(systemd.asked(), IsEmpty());
  kill(other, SIGKILL);
  waitpid(other, nullptr, 0);
}

TEST_F(UnitsOnAStandInForSystemd, ThatRunAnotherComponentTooAreNotEndedForOne) {
  const int main = running();
  units->found(ComponentId(1), main);
  const Reply reply = stop(main);
  EXPECT_EQ(reply.outcome, Outcome::kRefused);
  EXPECT_THAT(reply.text, HasSubstr("lidar.service runs camera, too"));
  EXPECT_TRUE(is_alive(main));
  EXPECT_THAT(systemd.asked(), IsEmpty());
}

TEST_F(UnitsOnAStandInForSystemd, ThatSystemdRefusesAreLeftAsTheyAre) {
  const int old = running();
  for (const char* error : {"org.freedesktop.DBus.Error.AccessDenied",
                            "org.freedesktop.DBus.Error.InteractiveAuthorizationRequired"}) {
    systemd.refuse(error);
    const Reply reply = stop(old);
    EXPECT_EQ(reply.outcome, Outcome::kRefused);
    EXPECT_THAT(reply.text, HasSubstr("culprit may not: not you; give its user the right"));
    EXPECT_TRUE(is_alive(old));
  }
  EXPECT_EQ(stop(old, Ending::kForGood).outcome, Outcome::kRefused);
  EXPECT_TRUE(is_alive(old));
  EXPECT_THAT(
      could_manage({"lidar.service", false}).error(),
      testing::AllOf(HasSubstr("culprit may not"), HasSubstr("set-property for this look")));
}

TEST_F(UnitsOnAStandInForSystemd, ThatDoNotExistAreToldWithTheNameThatWasMeant) {
  ask("UNIT lydar.service");
  EXPECT_THAT(start().text, HasSubstr("systemd has no lydar.service; did you mean lidar.service?"));
  EXPECT_THAT(stop(0).text, HasSubstr("has no lydar.service"));
  EXPECT_THAT(could_manage({"lydar.service", false}).error(), HasSubstr("did you mean"));
  EXPECT_TRUE(could_manage({"lidar.service", true}));
}

TEST_F(UnitsOnAStandInForSystemd, ThatCannotBeStartedSayWhatSystemdSays) {
  systemd.add("lidar.service", {.is_broken = true});
  running();
  const auto seen = wait_for<ProcessSeen>([](const auto&) { return true; });
  ASSERT_TRUE(seen) << "a failed unit has exited, also without a discovered node";
  EXPECT_EQ(seen->state, ProcessState::kGone);
  EXPECT_EQ(seen->remark, "lidar.service failed: exit-code");
}

// Also in a step before its main process (ExecStartPre=).
TEST_F(UnitsOnAStandInForSystemd, ThatFailedBeforeAnybodyLookedAreDead) {
  systemd.add("lidar.service", {.active = "failed", .result = "exit-code"});
  ask();
  const auto seen = wait_for<ProcessSeen>([](const auto&) { return true; });
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->state, ProcessState::kGone);
  EXPECT_EQ(seen->pid, 0);
  EXPECT_EQ(seen->remark, "lidar.service failed: exit-code");
}

// As systemctl stop leaves them; an end by culprit itself is not a person's order.
TEST_F(UnitsOnAStandInForSystemd, ThatEndInAnOrderlyWayAreToldAsAnOrder) {
  for (const bool by_culprit : {false, true}) {
    const int pid = by_culprit ? now_running() : running();
    std::this_thread::sleep_for(2 * Units::kIdlePeriod);  // Units has noticed that it runs
    if (by_culprit) {
      units->stop(CommandId{++count}, ComponentId(0), pid, Ending::kForGood, Hangs::kNo);
    } else {
      systemd.say("inactive", 0);
    }
    const auto seen = wait_for<ProcessSeen>(
        [](const ProcessSeen& each) { return each.state == ProcessState::kGone; });
    ASSERT_TRUE(seen) << by_culprit;
    EXPECT_EQ(seen->cause, by_culprit ? Cause::kUnknown : Cause::kOrder);
    systemd.say("", 0);
  }
}

// The successor of a process that culprit has ended, before anybody looked at the unit again.
TEST_F(UnitsOnAStandInForSystemd, ThatAPersonEndsRightAfterCulpritReplacedThemAreToldAsAnOrder) {
  const int pid = running();
  std::this_thread::sleep_for(2 * Units::kIdlePeriod);  // Units has noticed that it runs
  ASSERT_EQ(stop(pid).outcome, Outcome::kDone);
  systemd.say("inactive", 0);
  const auto seen = wait_for<ProcessSeen>(
      [](const ProcessSeen& each) { return each.state == ProcessState::kGone; });
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->cause, Cause::kOrder);
}

TEST_F(UnitsOnAStandInForSystemd, OfWhichAPersonIsEndingTheSuccessorAreToldAsAnOrder) {
  systemd.add("lidar.service", {.heeds_signals = false});
  const int pid = running();
  std::this_thread::sleep_for(2 * Units::kIdlePeriod);  // Units has noticed that it runs
  units->stop(CommandId{++count}, kLidar, pid, Ending::kToStartAgain, Hangs::kNo);
  while (systemd.asked().empty()) std::this_thread::sleep_for(5ms);
  systemd.say("deactivating", static_cast<std::uint32_t>(getpid()), true);
  kill(pid, SIGTERM);
  EXPECT_EQ(answer().outcome, Outcome::kDone);
  systemd.say("inactive", 0);
  const auto seen = wait_for<ProcessSeen>(
      [](const ProcessSeen& each) { return each.state == ProcessState::kGone; });
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->cause, Cause::kOrder);
  EXPECT_THAT(systemd.asked(), ElementsAre("RestartUnit lidar.service"));
}

// Its node hangs, or has ended before the main process.
TEST_F(UnitsOnAStandInForSystemd, ThatAPersonIsEndingAreNotRestarted) {
  const int pid = running();
  std::this_thread::sleep_for(2 * Units::kIdlePeriod);  // Units has noticed that it runs
  systemd.say("deactivating", static_cast<std::uint32_t>(pid), true);
  const Reply reply = stop(pid, Ending::kToStartAgain, Hangs::kYes);
  EXPECT_EQ(reply.outcome, Outcome::kRefused);
  EXPECT_THAT(reply.text, HasSubstr("was told to end lidar.service"));
  systemd.say("inactive", 0);
  const auto seen = wait_for<ProcessSeen>(
      [](const ProcessSeen& each) { return each.state == ProcessState::kGone; });
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->cause, Cause::kOrder);
  EXPECT_TRUE(is_alive(pid));
  EXPECT_THAT(systemd.asked(), IsEmpty());
}

// A node in Python answers systemctl stop with exit code 1, others crash on it, or are killed after their time. By itself a
// process ends before its unit ceases to be active; and a unit may fail before it is active at all.
TEST_F(UnitsOnAStandInForSystemd, ThatFailWhenTheyAreToldToStopAreToldAsAnOrder) {
  struct Case {
    std::string result;
    std::uint64_t began, left_active, ended;
    bool is_order;
  };
  for (const Case& each :
       {Case{"exit-code", 100, 200, 300, true}, Case{"signal", 100, 200, 300, true},
        Case{"core-dump", 100, 200, 300, true}, Case{"timeout", 100, 200, 300, true},
        Case{"watchdog", 100, 200, 300, false}, Case{"oom-kill", 100, 200, 300, false},
        Case{"exit-code", 100, 300, 300, false}, Case{"exit-code", 250, 200, 300, false}}) {
    systemd.add("lidar.service", {.active = "failed",
                                  .result = each.result,
                                  .began = each.began,
                                  .left_active = each.left_active,
                                  .ended = each.ended});
    ask();
    const auto seen = wait_for<ProcessSeen>([](const auto&) { return true; });
    ASSERT_TRUE(seen) << each.result;
    EXPECT_EQ(seen->cause, each.is_order ? Cause::kOrder : Cause::kUnknown) << each.result;
  }
}

// systemd stops it then, and a person may stop it before: a process that outlives its time to end is a timeout, too.
TEST_F(UnitsOnAStandInForSystemd, ThatHaveRunForRuntimeMaxSecAreNotToldAsAnOrder) {
  for (const std::uint64_t limit : {50u, 100u, 101u}) {
    systemd.add("lidar.service", {.active = "failed",
                                  .result = "timeout",
                                  .began = 100,
                                  .entered_active = 100,
                                  .left_active = 200,
                                  .ended = 300,
                                  .runtime_max = limit});
    ask();
    const auto seen = wait_for<ProcessSeen>([](const auto&) { return true; });
    ASSERT_TRUE(seen) << limit;
    EXPECT_EQ(seen->cause, limit > 100 ? Cause::kOrder : Cause::kUnknown) << limit;
  }
}

// systemctl stop of a unit that crashes again and again leaves it inactive, with its Result. So does a start after
// RestartSec= that cannot happen.
TEST_F(UnitsOnAStandInForSystemd, ThatAreToldToStopBeforeTheirNextStartAreToldAsAnOrder) {
  for (const std::uint64_t became_inactive : {399u, 400u}) {
    systemd.add("lidar.service", {.active = "activating"});
    ask();
    std::this_thread::sleep_for(Units::kIdlePeriod);  // Units has noticed that
    systemd.add("lidar.service", {.result = "exit-code",
                                  .began = 100,
                                  .entered_active = 100,
                                  .left_active = 300,
                                  .ended = 300,
                                  .became_inactive = became_inactive,
                                  .restart_delay = 100});
    const auto seen = wait_for<ProcessSeen>(
        [](const ProcessSeen& each) { return each.state == ProcessState::kGone; });
    ASSERT_TRUE(seen) << became_inactive;
    EXPECT_EQ(seen->cause, became_inactive < 400 ? Cause::kOrder : Cause::kUnknown)
        << became_inactive;
  }
}

// RestartSteps= makes the wait longer than RestartSec= says. Once systemd has tried that start, the wait for the one after
// it is longer still.
TEST_F(UnitsOnAStandInForSystemd, ThatAreToldToStopInALongerWaitForTheirNextStartAreToldAsAnOrder) {
  struct Case {
    std::uint64_t became_inactive, conditions_checked;
    bool is_order;
  };
  for (const Case& each :
       {Case{400, 90, true}, Case{549, 90, true}, Case{550, 90, false}, Case{450, 451, false}}) {
    systemd.add("lidar.service", {.active = "activating"});
    ask();
    std::this_thread::sleep_for(Units::kIdlePeriod);  // Units has noticed that
    systemd.add("lidar.service", {.result = "exit-code",
                                  .began = 100,
                                  .entered_active = 100,
                                  .left_active = 300,
                                  .ended = 300,
                                  .became_inactive = each.became_inactive,
                                  .restart_delay = 100,
                                  .next_restart_delay = 250,
                                  .conditions_checked = each.conditions_checked});
    const auto seen = wait_for<ProcessSeen>(
        [](const ProcessSeen& one) { return one.state == ProcessState::kGone; });
    ASSERT_TRUE(seen) << each.became_inactive;
    EXPECT_EQ(seen->cause, each.is_order ? Cause::kOrder : Cause::kUnknown)
        << each.became_inactive << ' ' << each.conditions_checked;
  }
}

// As systemctl restart leaves it between its two halves.
TEST_F(UnitsOnAStandInForSystemd, ThatSystemdIsAboutToStartAreNotToldToHaveEnded) {
  running();
  std::this_thread::sleep_for(2 * Units::kIdlePeriod);  // Units has noticed that it runs
  systemd.say("inactive", 0, true);
  std::vector<Observation> seen;
  for (const Time end = later(live_now(), 2 * Units::kIdlePeriod); live_now() < end;)
    inbox.take(end, seen);
  EXPECT_TRUE(seen.empty());
  systemd.say("inactive", 0);
  const auto ended = wait_for<ProcessSeen>(
      [](const ProcessSeen& each) { return each.state == ProcessState::kGone; });
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->cause, Cause::kOrder);
}

// Somebody may have stopped it on purpose.
TEST_F(UnitsOnAStandInForSystemd, ThatWereInactiveFromTheBeginningProveNothing) {
  EXPECT_EQ(stop(0).outcome, Outcome::kDone);
  std::vector<Observation> seen;
  inbox.take(later(live_now(), 2 * Units::kIdlePeriod), seen);
  EXPECT_TRUE(seen.empty());
}

TEST_F(UnitsOnAStandInForSystemd, AreNotEndedOnWordsThatMakeNoSense) {
  const int old = running();
  systemd.say("sleepy", 7);
  EXPECT_THAT(stop(old).text, HasSubstr("says that lidar.service is 'sleepy'"));
  systemd.say("active", 4'000'000'000u);
  EXPECT_EQ(stop(old).outcome, Outcome::kRefused);
  EXPECT_TRUE(is_alive(old));
  EXPECT_THAT(systemd.asked(), IsEmpty());
}

TEST_F(UnitsOnAStandInForSystemd, AreRefusedInTimeIfTheBusHangsOrIsGone) {
  const int old = running();
  bus.signal(SIGSTOP);
  const Time before = live_now();
  EXPECT_EQ(stop(old).outcome, Outcome::kRefused);
  EXPECT_LT(live_now() - before, Units::kEnd);
  bus.signal(SIGCONT);
  EXPECT_EQ(start().outcome, Outcome::kDone) << "it is asked again";
  bus.signal(SIGKILL);
  EXPECT_THAT(stop(old).text, HasSubstr("is it running"));
  EXPECT_TRUE(is_alive(old));
}

}  // namespace
}  // namespace culprit::owners
