// Requests to owners on another computer go over ssh. ssh and that computer are a stand-in
// (test_ssh.h). Behind it a real systemd-stdio-bridge speaks to the stand-in for systemd on a real
// dbus-daemon, or the stand-in for docker's dial-stdio to the one for its engine.
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "owners/remote_program.h"
#include "owners/test_asked_owner.h"
#include "owners/test_engine.h"
#include "owners/test_process.h"
#include "owners/test_ssh.h"
#include "owners/test_systemd.h"

namespace culprit::owners {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kHost = "robot@rover2";

struct Remote : AsksAnOwner {
  TestSsh ssh;
};

TEST_F(Remote, SshIsToldToAskNobody) {
  EXPECT_TRUE(could_reach(kHost));
  EXPECT_THAT(ssh.asked(),
              ElementsAre(AllOf(HasSubstr("-oBatchMode=yes"), HasSubstr("-oConnectTimeout="),
                                HasSubstr("-- robot@rover2 true"))));
}

// The other computer gets no terminal, agent or port of ours, and no name is an option.
TEST_F(Remote, SshGivesTheOtherComputerNothing) {
  EXPECT_TRUE(could_reach(kHost));
  EXPECT_TRUE(could_reach("-oProxyCommand=touch")) << "the stand-in goes on behind --";
  EXPECT_THAT(ssh.asked(), Each(AllOf(HasSubstr("-axT "), HasSubstr("-oClearAllForwardings=yes"),
                                      HasSubstr("-oPermitLocalCommand=no"),
                                      HasSubstr("-oServerAliveInterval="))));
  EXPECT_THAT(ssh.asked().back(), HasSubstr("-- -oProxyCommand=touch true"));
}

TEST_F(Remote, ThatRefusesUsIsToldWithWhatToDo) {
  ssh.refuse("robot@rover2: Permission denied (publickey,password).");
  EXPECT_THAT(could_reach(kHost).error(),
              AllOf(HasSubstr("Permission denied"), HasSubstr("give culprit's user a key")));
  ssh.refuse("No ED25519 host key is known\nHost key verification failed.");
  EXPECT_THAT(could_reach(kHost).error(),
              AllOf(HasSubstr("Host key verification failed"), HasSubstr("accept it once")));
  ssh.refuse("ssh: Could not resolve hostname rover2: Name or service not known");
  EXPECT_THAT(could_reach(kHost).error(), HasSubstr("is HOST its name?"));
  ssh.refuse("\x1b[31mred\x07");
  EXPECT_THAT(could_reach(kHost).error(), testing::Not(HasSubstr("\x1b")))
      << "it is shown to people";
}

TEST_F(Remote, ThatHangsIsGivenUpInTime) {
  ssh.hang();
  const Time before = live_now();
  EXPECT_THAT(could_reach(kHost).error(), HasSubstr("it does not answer"));
  EXPECT_LT(live_now() - before, RemoteProgram::kPatience + 5s);
}

TEST_F(Remote, ThatComplainsWithoutAnEndIsGivenUpInTime) {
  ssh.babble();
  const Time before = live_now();
  EXPECT_THAT(could_reach(kHost).error(), HasSubstr("it does not answer"));
  EXPECT_LT(live_now() - before, RemoteProgram::kPatience + 5s);
}

TEST_F(Remote, ThatLacksTheProgramIsToldWhich) {
  ssh.be_bare();
  EXPECT_THAT(could_manage(SystemdUnit{"lidar.service", false, kHost}).error(),
              HasSubstr("it has no systemd-stdio-bridge"));
  EXPECT_THAT(
      could_manage(EngineContainer{EngineContainer::Engine::kPodman, "slam", kHost}).error(),
      HasSubstr("it has no podman"));
}

TEST_F(Remote, WithoutAnySshThisIsSaid) {
  setenv("PATH", "/nowhere", 1);
  EXPECT_THAT(could_reach(kHost).error(), HasSubstr("install an ssh client"));
}

struct RemoteUnits : Remote {
  void SetUp() override {
    systemd.add("lidar.service");
    manage("lidar", "UNIT lidar.service HOST robot@rover2", Units::Of::kSystemd, kHost);
  }
  void TearDown() override { units.reset(); }  // before the bus that it asks

  TestBus bus;
  TestSystemd systemd{bus};
};

TEST_F(RemoteUnits, AreStartedAndNameNoProcess) {
  const Reply reply = start();
  EXPECT_EQ(reply.outcome, Outcome::kDone) << reply.text;
  EXPECT_EQ(reply.value, decltype(Reply::value)()) << "its number means another process here";
  EXPECT_TRUE(is_alive(systemd.pid_of("lidar.service")));
  EXPECT_THAT(systemd.asked(), ElementsAre("StartUnit lidar.service"));
  EXPECT_THAT(ssh.asked(), Each(HasSubstr("-- robot@rover2 systemd-stdio-bridge")));
}

TEST_F(RemoteUnits, AreReplacedByOneRequest) {
  const int old = systemd.start("lidar.service");
  const Reply reply = stop(0);
  EXPECT_EQ(reply.outcome, Outcome::kDone) << reply.text;
  EXPECT_FALSE(is_alive(old));
  EXPECT_EQ(start().outcome, Outcome::kDone);
  EXPECT_NE(systemd.pid_of("lidar.service"), old);
  EXPECT_THAT(systemd.asked(), ElementsAre("RestartUnit lidar.service"));
}

TEST_F(RemoteUnits, ThatDoNotEndPolitelyAreKilledOverThere) {
  systemd.add("lidar.service", {.heeds_signals = false});
  const int old = systemd.start("lidar.service");
  EXPECT_EQ(stop(0).outcome, Outcome::kDone);
  EXPECT_FALSE(is_alive(old));
  EXPECT_THAT(systemd.asked(), ElementsAre("RestartUnit lidar.service", "KillUnit lidar.service"));
}

TEST_F(RemoteUnits, ThatSystemdStartedAgainMeanwhileAreNotReplaced) {
  systemd.add("lidar.service", {.restarts = true});
  const int old = systemd.start("lidar.service");
  ASSERT_EQ(start().outcome, Outcome::kDone) << "it is known what runs";
  end(old);
  while (!is_alive(systemd.pid_of("lidar.service")) || systemd.pid_of("lidar.service") == old)
    std::this_thread::sleep_for(5ms);
  EXPECT_EQ(stop(0).outcome, Outcome::kDone);
  EXPECT_THAT(systemd.asked(), IsEmpty());
}

TEST_F(RemoteUnits, ProcessesOfThisComputerAreNotEndedForThem) {
  systemd.start("lidar.service");
  const Reply reply = stop(getpid());
  EXPECT_EQ(reply.outcome, Outcome::kRefused);
  EXPECT_THAT(reply.text, AllOf(HasSubstr("is of this computer"), HasSubstr("on robot@rover2")));
  EXPECT_THAT(systemd.asked(), IsEmpty());
}

TEST_F(RemoteUnits, ThatFailedAreDeadWithoutAProcessOfOurs) {
  systemd.add("lidar.service", {.is_broken = true});
  systemd.start("lidar.service");
  const auto seen = wait_for<ProcessSeen>([](const auto&) { return true; });
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->state, ProcessState::kGone);
  EXPECT_EQ(seen->pid, 0);
}

TEST_F(RemoteUnits, AreAskedAnewWhenTheConnectionWasLost) {
  systemd.start("lidar.service");
  ASSERT_EQ(start().outcome, Outcome::kDone);
  ssh.cut();
  ssh.allow();
  const Reply reply = stop(0);
  EXPECT_EQ(reply.outcome, Outcome::kDone) << reply.text;
  EXPECT_THAT(systemd.asked(), ElementsAre("RestartUnit lidar.service"));
}

TEST_F(RemoteUnits, AreRefusedWithCauseAndRemedyIfSshIs) {
  const int old = systemd.start("lidar.service");
  ssh.refuse("robot@rover2: Permission denied (publickey).");
  manage("lidar", "UNIT lidar.service HOST robot@rover2", Units::Of::kSystemd, kHost);
  for (const Reply& reply : {start(), stop(0), stop(0, Ending::kForGood)}) {
    EXPECT_EQ(reply.outcome, Outcome::kRefused);
    EXPECT_THAT(reply.text, AllOf(HasSubstr("Permission denied"), HasSubstr("a key")));
  }
  EXPECT_TRUE(is_alive(old));
  EXPECT_THAT(systemd.asked(), IsEmpty());
}

TEST_F(RemoteUnits, OfAComputerThatHangsAreRefusedInTimeAndHoldUpNoOther) {
  units.reset();
  ssh.hang();
  rules = *check(Source("test.rules",
                        "COMPONENT lidar NODE /lidar UNIT lidar.service HOST robot@rover2\n"
                        "COMPONENT camera NODE /camera UNIT camera.service\n"))
               .rules;
  systemd.add("camera.service");
  AllUnits all(rules, inbox);
  const Time before = live_now();
  all.of(ComponentId(0))->stop(CommandId{1}, ComponentId(0), 0, Ending::kToStartAgain);
  all.of(ComponentId(1))->start(CommandId{2}, ComponentId(1));
  std::vector<std::uint64_t> answered;
  while (answered.size() < 2 && live_now() < later(before, 30s)) {
    const auto reply = wait_for<Reply>([](const auto&) { return true; });
    ASSERT_TRUE(reply);
    answered.push_back(reply->command.number);
    EXPECT_EQ(reply->outcome, reply->command.number == 1 ? Outcome::kRefused : Outcome::kDone);
  }
  EXPECT_THAT(answered, ElementsAre(2u, 1u));
  EXPECT_LT(live_now() - before, 12s) << "what a StopProcess has (execute/pursuit.cpp)";
}

TEST_F(RemoteUnits, OfAComputerThatIsLostAreOutOfReachAndNotDead) {
  systemd.start("lidar.service");
  ASSERT_EQ(start().outcome, Outcome::kDone);
  ssh.cut();
  std::vector<Observation> seen;
  for (const Time end = later(live_now(), 20s); live_now() < end;) {
    inbox.take(later(live_now(), 100ms), seen);
    if (!seen.empty() && std::holds_alternative<HostReached>(seen.back().what)) break;
  }
  ASSERT_FALSE(seen.empty());
  ASSERT_TRUE(std::holds_alternative<HostReached>(seen.back().what));
  EXPECT_FALSE(std::get<HostReached>(seen.back().what).is_reached);
  const auto says = [](const Observation& each) {
    const auto* trouble = std::get_if<LinkTrouble>(&each.what);
    return trouble != nullptr && trouble->text.find("No route to host") != std::string::npos;
  };
  EXPECT_EQ(std::count_if(seen.begin(), seen.end(), says), 1);
  for (const Observation& each : seen) {
    const auto* process = std::get_if<ProcessSeen>(&each.what);
    EXPECT_TRUE(process == nullptr || process->state == ProcessState::kRunning);
  }
  ssh.allow();
  const Time allowed = live_now();
  const auto back = wait_for<HostReached>([](const auto&) { return true; });
  ASSERT_TRUE(back);
  EXPECT_TRUE(back->is_reached);
  EXPECT_GE(live_now() - allowed, Units::kReturn) << "its nodes must be discovered again first";
}

TEST_F(RemoteUnits, ThatDoNotExistThereAreToldWithTheNameThatWasMeant) {
  EXPECT_THAT(
      could_manage(SystemdUnit{"lydar.service", false, kHost}).error(),
      HasSubstr("systemd on robot@rover2 has no lydar.service; did you mean lidar.service?"));
}

TEST_F(RemoteUnits, OfWhichForgedWordsComeAreNotEnded) {
  const int old = systemd.start("lidar.service");
  systemd.say("sleepy", 7);
  EXPECT_THAT(stop(0).text, HasSubstr("says that lidar.service is 'sleepy'"));
  EXPECT_TRUE(is_alive(old));
  EXPECT_THAT(systemd.asked(), IsEmpty());
}

// systemd itself, by way of its own bridge.
TEST_F(Remote, UnitsOfAUserAreFoundOnTheBusOfThatUser) {
  const auto systemd = UserSystemd::begin();
  if (!systemd) GTEST_SKIP() << "this machine runs no second instance of systemd";
  systemd->start("lidar.service", "/bin/sleep 300", "");
  const auto could = could_manage(SystemdUnit{"lidar.service", true, kHost});
  EXPECT_TRUE(could) << (could ? "" : could.error());
  EXPECT_THAT(could_manage(SystemdUnit{"lydar.service", true, kHost}).error(),
              HasSubstr("the user's systemd on robot@rover2 has no lydar.service; did you mean"));
}

struct RemoteContainers : Remote {
  void SetUp() override {
    engine.add("slam");
    manage("slam", "CONTAINER docker slam HOST robot@rover2", Units::Of::kEngines, kHost);
  }
  void TearDown() override { units.reset(); }

  TestEngine engine;
};

TEST_F(RemoteContainers, AreReplacedByOneRequest) {
  const int old = engine.start("slam");
  const Reply reply = stop(0);
  EXPECT_EQ(reply.outcome, Outcome::kDone) << reply.text;
  EXPECT_FALSE(is_alive(old));
  EXPECT_EQ(start().outcome, Outcome::kDone);
  EXPECT_NE(engine.pid_of("slam"), old);
  EXPECT_THAT(engine.asked(), ElementsAre("restart slam"));
  EXPECT_THAT(ssh.asked(), Each(HasSubstr("-- robot@rover2 docker system dial-stdio")));
}

TEST_F(RemoteContainers, ThatArePausedStayPausedAndAreNotOutOfReach) {
  engine.add("slam", {.status = "paused"});
  EXPECT_THAT(stop(0).text, HasSubstr("docker unpause slam"));
  std::vector<Observation> seen;
  inbox.take(live_now(), seen);
  for (const Observation& each : seen) EXPECT_FALSE(std::holds_alternative<HostReached>(each.what));
}

TEST_F(RemoteContainers, OfAnEngineThatIsNotThereAreRefused) {
  units.reset();
  setenv("DOCKER_HOST", "unix:///nowhere", 1);
  manage("slam", "CONTAINER docker slam HOST robot@rover2", Units::Of::kEngines, kHost);
  EXPECT_THAT(stop(0).text, AllOf(HasSubstr("robot@rover2: docker ended"), HasSubstr("/nowhere")));
}

}  // namespace
}  // namespace culprit::owners
