#include "owners/supervisor.h"

#include <csignal>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <string>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "owners/bounded_log.h"
#include "owners/spawn.h"
#include "owners/test_supervised.h"

namespace culprit::owners {
namespace {

using namespace std::chrono_literals;

TEST(Supervisor, StartsAndStopsPolitely) {
  Supervised c("sleep 1000");
  const int pid = c.start();
  EXPECT_TRUE(exists(pid));
  EXPECT_EQ(getpgid(pid), pid) << "it leads its own process group";
  c.supervisor->stop({2}, ComponentId(0), 0, Ending::kForGood);
  EXPECT_EQ(c.state(ProcessState::kGone).remark, "killed by signal 2");
  EXPECT_EQ(c.reply_to({2}).outcome, Outcome::kDone);
}

TEST(Supervisor, TellsHowAProcessEnded) {
  Supervised c("sh -c 'exit 3'");
  c.start();
  EXPECT_EQ(c.state(ProcessState::kGone).remark, "exit code 3");
}

TEST(Supervisor, TellsThatAProcessWasKilled) {
  Supervised c("sleep 1000");
  kill(c.start(), SIGKILL);
  EXPECT_EQ(c.state(ProcessState::kGone).remark, "killed by signal 9");
}

TEST(Supervisor, NoticesThatAStoppedProcessGoesOn) {
  Supervised c("sleep 1000");
  const int pid = c.start();
  kill(pid, SIGSTOP);
  c.state(ProcessState::kStopped);
  kill(pid, SIGCONT);
  EXPECT_EQ(c.state(ProcessState::kRunning).pid, pid);
}

// As `ros2 run` starts a node: the child works.
TEST(Supervisor, TellsThatWhatItStartedWorksUntilItsNodeIsThere) {
  Supervised c("sh -c 'while :; do :; done & wait'");
  const int pid = c.start();
  EXPECT_EQ(c.worked(), pid);
  EXPECT_EQ(c.worked(), pid) << "again";
  c.supervisor->adopt(ComponentId(0), pid, live_now());
  EXPECT_TRUE(c.hears_of_no_work_for(2 * Supervisor::kWorkPeriod));
  c.stop();
}

// Checks the variables of SETUP and ENV, also PATH; and CWD.
TEST(Supervisor, StartsWithTheEnvironmentAndInTheFolderOfTheComponent) {
  Supervised c(Supervised::Declared{"LAUNCH \"my_node\" CWD /usr"});
  const std::filesystem::path program = c.folder() / "bin/my_node";
  std::filesystem::create_directories(program.parent_path());
  std::ofstream(program) << "#!/bin/sh\necho map $MAP in $(pwd)\nexec sleep 1000\n";
  std::filesystem::permissions(program, std::filesystem::perms(0755));
  c.environment = {{"MAP=yard", "PATH=" + program.parent_path().string() + ":/usr/bin:/bin"}};
  c.supervise();
  c.start();
  EXPECT_NE(c.log_when("\n").find("map yard in /usr\n"), std::string::npos);
  c.stop();
}

TEST(Supervisor, SaysWhenThereIsNoSuchProgram) {
  Supervised c("no-such-program-anywhere");
  c.supervisor->start({1}, ComponentId(0));
  const Reply reply = c.reply_to({1});
  EXPECT_EQ(reply.outcome, Outcome::kUnreachable);
  EXPECT_EQ(reply.text, "there is no program 'no-such-program-anywhere' in PATH");
}

TEST(Supervisor, StartsNoSecondProcessBesideALivingOne) {
  Supervised c("sleep 1000");
  const int pid = c.start();
  c.supervisor->adopt(ComponentId(0), pid, live_now());
  c.supervisor->start({3}, ComponentId(0));
  EXPECT_EQ(c.reply_to({3}).outcome, Outcome::kRefused);
}

// Its node is not there yet: by one that was killed, or on a slow machine.
TEST(Supervisor, AStartThatMeetsWhatIsComingUpIsThatStart) {
  const std::string robot = "test/" + std::to_string(getpid()) + "/meets";
  auto first = std::make_unique<Supervised>("sleep 1000", robot);
  const int pid = first->start();
  first->supervisor.reset();
  Supervised second("sleep 1000", robot);
  EXPECT_EQ(second.state(ProcessState::kRunning).pid, pid);
  second.supervisor->start({3}, ComponentId(0));
  const Reply reply = second.reply_to({3});
  EXPECT_EQ(reply.outcome, Outcome::kDone) << reply.text;
  EXPECT_EQ(std::get<Value>(reply.value), Value(std::int64_t{pid}));

  second.supervisor->adopt(ComponentId(0), pid, live_now());
  second.supervisor->start({4}, ComponentId(0));
  EXPECT_EQ(second.reply_to({4}).outcome, Outcome::kRefused) << "its node is there";
}

// Between fork() and execve() a process carries no mark yet.
TEST(Supervisor, StartsNothingWhileAnotherCulpritStartsIt) {
  Supervised c("sleep 1000");
  std::filesystem::create_directories(c.folder());
  const int lock = open((c.folder() / "c.start").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  ASSERT_EQ(flock(lock, LOCK_EX), 0);
  c.supervisor->start({1}, ComponentId(0));
  const Reply reply = c.reply_to({1});
  EXPECT_EQ(reply.outcome, Outcome::kUnreachable);
  EXPECT_NE(reply.text.find("is being started already"), std::string::npos) << reply.text;
  close(lock);
  EXPECT_NE(c.start(), 0);
}

TEST(Supervisor, RobotsThatShareAFolderDoNotWaitForOneAnothersStarts) {
  Supervised one("sleep 1000", "0/alpha");
  std::filesystem::create_directories(one.folder());
  const int lock =
      open((one.folder() / "0-beta-c.start").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  ASSERT_EQ(flock(lock, LOCK_EX), 0);
  EXPECT_NE(one.start(), 0);
  EXPECT_TRUE(std::filesystem::exists(one.folder() / "0-alpha-c.start"));
  close(lock);
}

// A reader of the log, for example an older culprit, may lock it for as long as it likes.
TEST(Supervisor, WaitsForNoLockOfAReaderOfItsLog) {
  Supervised c("sleep 1000");
  std::filesystem::create_directories(c.folder());
  const std::string log = c.folder() / "c.log";
  close(open(log.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644));
  const int reader = open(log.c_str(), O_RDONLY | O_CLOEXEC);
  ASSERT_EQ(flock(reader, LOCK_SH), 0);
  EXPECT_NE(c.start(), 0);
  for (const char* each : {"c.log", "c.start"}) {
    struct stat status {};
    ASSERT_EQ(stat((c.folder() / each).c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0600u) << each;
  }
  close(reader);
}

// The service is (OOMScoreAdjust=), so that it can heal what the kernel ends.
TEST(Supervisor, WhatItStartsIsNotSparedWhenMemoryRunsOut) {
  constexpr const char* kOwn = "/proc/self/oom_score_adj";
  std::string before;
  std::ifstream(kOwn) >> before;
  if (!(std::ofstream(kOwn) << "-100" << std::flush))
    GTEST_SKIP() << "only root may be spared more than before";
  Supervised c("sleep 1000");
  const int pid = c.start();
  std::ofstream(kOwn) << before << std::flush;
  ASSERT_TRUE(becomes(pid, "sleep"));
  std::string adjusted;
  std::ifstream("/proc/" + std::to_string(pid) + "/oom_score_adj") >> adjusted;
  EXPECT_EQ(adjusted, "0");
}

TEST(Supervisor, CapturesOutput) {
  Supervised c("sh -c 'echo out; echo err >&2'");
  c.start();
  const std::string log = c.log_when("err");
  EXPECT_EQ(log, "out\nerr\n");
}

// A node that writes megabytes a second, for ever.
TEST(Supervisor, KeepsTheEndOfALogAndNotAllOfIt) {
  Supervised c("sh -c 'while sleep 0.02; do seq 20000; done'");
  c.start();
  const std::filesystem::path older = c.folder() / "c.log.1";
  for (int tries = 0; tries < 6000 && !std::filesystem::exists(older); ++tries)
    std::this_thread::sleep_for(10ms);
  ASSERT_TRUE(std::filesystem::exists(older));
  std::filesystem::remove(older);
  for (int tries = 0; tries < 6000 && !std::filesystem::exists(older); ++tries)
    std::this_thread::sleep_for(10ms);
  ASSERT_TRUE(std::filesystem::exists(older)) << "again and again";
  c.stop();
  EXPECT_LE(std::filesystem::file_size(older), kMostOfLog);
}

TEST(Supervisor, RobotsThatShareAFolderHaveLogsOfTheirOwn) {
  Supervised one("sh -c 'echo of one; exec sleep 1000'", "0/one");
  Supervised two("sh -c 'echo of two; exec sleep 1000'", "0/two");
  ASSERT_EQ(one.folder(), two.folder());
  one.start();
  two.start();
  EXPECT_EQ(one.log_when("of one\n"), "of one\n");
  EXPECT_EQ(two.log_when("of two\n"), "of two\n");
}

// A log may be a device, which is everybody's.
TEST(Supervisor, LeavesADeviceAsItIs) {
  const auto mode_of_null = [] {
    struct stat status {};
    EXPECT_EQ(stat("/dev/null", &status), 0);
    return status.st_mode & 07777;
  };
  const mode_t before = mode_of_null();
  const int pid = *spawn(Program{{"true"}, {}, "/dev/null"});
  waitpid(pid, nullptr, 0);
  EXPECT_EQ(mode_of_null(), before);
}

}  // namespace
}  // namespace culprit::owners
