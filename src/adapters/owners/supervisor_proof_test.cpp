#include <csignal>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <poll.h>
#include <string>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "base/test_folder.h"
#include "owners/file_descriptor.h"
#include "owners/mark.h"
#include "owners/proc.h"
#include "owners/spawn.h"
#include "owners/supervisor.h"
#include "owners/test_process.h"
#include "owners/test_supervised.h"

namespace culprit::owners {
namespace {

using namespace std::chrono_literals;

// No more than `count` while this exists.
class DescriptorsLeft {
 public:
  explicit DescriptorsLeft(std::size_t count) {
    getrlimit(RLIMIT_NOFILE, &before_);
    rlimit few = before_;
    few.rlim_cur = 200;
    setrlimit(RLIMIT_NOFILE, &few);
    for (int fd = 0; (fd = fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0)) >= 0;) taken_.emplace_back(fd);
    taken_.resize(taken_.size() - count);
  }
  ~DescriptorsLeft() { setrlimit(RLIMIT_NOFILE, &before_); }

 private:
  rlimit before_{};
  std::vector<FileDescriptor> taken_;
};

TEST(Supervisor, EndsAndStartsAgainWhatCanBeStartedAgain) {
  Supervised c("sleep 1000");
  const int pid = c.start();
  EXPECT_EQ(c.stop_to_start_again().outcome, Outcome::kDone);
  EXPECT_FALSE(exists(pid));
  EXPECT_NE(c.start(), pid);
}

TEST(Supervisor, DoesNotEndWhatItCannotStartAgain) {
  const test::TestFolder folder;
  std::filesystem::copy_file("/bin/sleep", folder / "node");
  {
    Supervised c((folder / "node").string() + " 1000", "test/again/" + std::to_string(getpid()));
    const int pid = c.start();
    {
      const DescriptorsLeft none(0);
      const Reply reply = c.stop_to_start_again();
      EXPECT_EQ(reply.outcome, Outcome::kRefused);
      EXPECT_NE(reply.text.find("Too many open files"), std::string::npos) << reply.text;
    }
    EXPECT_TRUE(exists(pid));

    std::ofstream(folder / "no folder") << "";
    c.supervise(folder / "no folder");  // where no log can be written
    const Reply no_log = c.stop_to_start_again();
    EXPECT_EQ(no_log.outcome, Outcome::kRefused);
    EXPECT_NE(no_log.text.find("cannot be made: Not a directory"), std::string::npos)
        << no_log.text;
    EXPECT_TRUE(exists(pid));

    c.supervise();
    std::filesystem::remove(folder / "node");
    const Reply no_program = c.stop_to_start_again();
    EXPECT_EQ(no_program.outcome, Outcome::kRefused);
    EXPECT_EQ(no_program.text,
              "c is not ended, because it could not be started again: there is no program '" +
                  (folder / "node").string() + "', or it is not executable");
    EXPECT_TRUE(exists(pid));

    std::ofstream(folder / "node") << "#!/no/such/interpreter\n";
    std::filesystem::permissions(folder / "node", std::filesystem::perms::owner_all);
    EXPECT_EQ(c.stop_to_start_again().outcome, Outcome::kRefused);
    EXPECT_TRUE(exists(pid));
    c.stop();
    EXPECT_FALSE(exists(pid)) << "for good, it is ended all the same";
  }
}

TEST(Supervisor, EndsNothingThatCouldNotBeStartedAgainForItsSetupOrItsFolder) {
  Supervised c(Supervised::Declared{"LAUNCH \"sleep 1000\" CWD /does/not/exist"});
  const int other = *spawn(Program{{"sleep", "1000"}, {}, "/dev/null"});
  c.supervisor->adopt(ComponentId(0), other, live_now());
  EXPECT_NE(c.stop_to_start_again().text.find("its folder /does/not/exist cannot be entered"),
            std::string::npos);
  c.environment = {Error{"SETUP /x failed"}};
  c.supervise();
  c.supervisor->adopt(ComponentId(0), other, live_now());
  const Reply refused = c.stop_to_start_again();
  EXPECT_EQ(refused.outcome, Outcome::kRefused);
  EXPECT_NE(refused.text.find("could not be started again: SETUP /x failed"), std::string::npos);
  EXPECT_TRUE(exists(other));
  c.supervisor.reset();
  kill(other, SIGKILL);
  waitpid(other, nullptr, 0);
}

// A process that others started is recognized by the program that it ran when it was found first.
TEST(Supervisor, DoesNotEndAnotherProgramThanTheComponentWas) {
  Supervised c("sleep 1000");
  const int node = start_by_others("exec sleep 1000");
  const int victim = start_by_others("exec tail -f /dev/null");
  ASSERT_TRUE(becomes(node, "sleep"));
  ASSERT_TRUE(becomes(victim, "tail"));
  c.supervisor->adopt(ComponentId(0), node, live_now());
  c.supervisor->stop({2}, ComponentId(0), 0, Ending::kForGood);
  EXPECT_EQ(c.reply_to({2}).outcome, Outcome::kDone);
  EXPECT_FALSE(is_alive(node));

  c.supervisor->adopt(ComponentId(0), victim, live_now());
  c.supervisor->stop({3}, ComponentId(0), 0, Ending::kForGood);
  const Reply reply = c.reply_to({3});
  EXPECT_EQ(reply.outcome, Outcome::kRefused);
  EXPECT_NE(reply.text.find("tail of user"), std::string::npos) << reply.text;
  EXPECT_NE(reply.text.find("sleep of user"), std::string::npos) << reply.text;
  EXPECT_TRUE(is_alive(victim));
  kill(victim, SIGKILL);
}

TEST(Supervisor, LeavesTheGroupOfSomebodyElseAloneAndSaysWhatStays) {
  Supervised c("sleep 1000");
  const int node = start_by_others("sleep 1000 & wait");
  std::vector<Relative> started;
  for (int tries = 0; tries < 3000 && started.empty(); ++tries) {
    started = descendants_of(node);
    std::this_thread::sleep_for(10ms);
  }
  ASSERT_EQ(started.size(), 1u);
  const int child = started.front().pid;
  ASSERT_TRUE(becomes(child, "sleep"));
  c.supervisor->adopt(ComponentId(0), node, live_now());
  c.supervisor->stop({2}, ComponentId(0), 0, Ending::kForGood);
  const std::string told = c.trouble();
  EXPECT_EQ(told, "c was ended and left running: process " + std::to_string(child) + " (sleep)");
  EXPECT_FALSE(is_alive(node));
  EXPECT_TRUE(is_alive(child));
  kill(child, SIGKILL);
}

// A culprit that was killed had started it: its parent has exited, and the group is ours.
TEST(Supervisor, EndsTheGroupThatAnEarlierOneHadMade) {
  const std::string robot = "test/group/" + std::to_string(getpid());
  Supervised c("sleep 1000", robot);
  std::string marks = "CULPRIT_COMPONENT=" + robot + "/c CULPRIT_PROCESS_COUNTS_IN='" +
                      pid_namespace_of(getpid()) + "' ";
  const int node = start_by_others("exec env " + marks +
                                   "sh -c 'export CULPRIT_PROCESS=$$; exec sh -c \"sleep 1000 & "
                                   "sleep 1000 & wait\"'");
  std::vector<Relative> started;
  for (int tries = 0; tries < 3000 && started.size() < 2; ++tries) {
    started = descendants_of(node);
    std::this_thread::sleep_for(10ms);
  }
  ASSERT_EQ(started.size(), 2u);
  c.supervise();
  EXPECT_EQ(c.state(ProcessState::kRunning).pid, node);
  kill(node, SIGKILL);  // by itself, as a node crashes
  EXPECT_EQ(c.state(ProcessState::kGone).pid, node);
  for (const Relative& each : started) {
    for (int tries = 0; tries < 3000 && is_alive(each.pid); ++tries)
      std::this_thread::sleep_for(10ms);
    EXPECT_FALSE(is_alive(each.pid)) << "it would go on beside the successor";
  }
}

// In another PID namespace the same number is another process.
TEST(Supervisor, AMarkCountsOnlyWhereItsNumberDoes) {
  const std::string robot = "test/namespace/" + std::to_string(getpid());
  Supervised c("sleep 1000", robot);
  const int stranger = start_by_others(
      "exec env CULPRIT_COMPONENT=" + robot +
      "/c CULPRIT_PROCESS_COUNTS_IN='pid:[1]' sh -c 'export CULPRIT_PROCESS=$$; exec sleep 1000'");
  ASSERT_TRUE(becomes(stranger, "sleep"));
  c.supervise();
  EXPECT_NE(c.start(), stranger);
  EXPECT_TRUE(is_alive(stranger));
  kill(stranger, SIGKILL);
}

// Two simulated robots of one name and domain, each in a network of its own, are two robots.
TEST(Supervisor, AMarkCountsOnlyInItsNetwork) {
  const std::string robot = "test/network/" + std::to_string(getpid());
  const auto started_in = [&](const std::string& network) {
    return start_by_others("exec env CULPRIT_COMPONENT=" + robot +
                           "/c CULPRIT_PROCESS_COUNTS_IN='" + pid_namespace_of(getpid()) +
                           "' CULPRIT_NETWORK='" + network +
                           "' sh -c 'export CULPRIT_PROCESS=$$; exec sleep 1000'");
  };
  const int other = started_in("net:[1]");
  ASSERT_TRUE(becomes(other, "sleep"));
  EXPECT_FALSE(carries_mark(other, robot + "/c"));
  EXPECT_TRUE(launched_as(robot + "/c").empty());
  EXPECT_TRUE(marked_processes(robot + "/").empty());
  const int own = started_in(network_namespace_of(getpid()));
  ASSERT_TRUE(becomes(own, "sleep"));
  EXPECT_EQ(launched_as(robot + "/c"), std::vector{own});
  kill(other, SIGKILL);
  kill(own, SIGKILL);
}

// Any user can start a process with these variables.
TEST(Supervisor, AMarkOfAnotherUsersProcessDoesNotCount) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become somebody else";
  const std::string robot = "test/stranger/" + std::to_string(getpid());
  Supervised c("sleep 1000", robot);
  const std::string variables = "env CULPRIT_COMPONENT=" + robot +
                                "/c CULPRIT_PROCESS_COUNTS_IN=\"$(readlink /proc/self/ns/pid)\" "
                                "sh -c 'export CULPRIT_PROCESS=$$; exec sleep 1000'";
  const int stranger =
      start_by_others("exec setpriv --reuid=65534 --regid=65534 --clear-groups " + variables);
  const int own = start_by_others("exec " + variables);
  ASSERT_TRUE(becomes(stranger, "sleep") && becomes(own, "sleep"));
  EXPECT_EQ(launched_as(robot + "/c"), std::vector{own}) << "and of our user it does";
  end(own);
  c.supervise();
  EXPECT_NE(c.start(), stranger);
  EXPECT_TRUE(is_alive(stranger));
  kill(stranger, SIGKILL);
}

// As on a file system that does not answer: a script whose interpreter is a pipe without a writer
// would hang; so does a program on a stopped server. Here the log is what the child waits for.
TEST(Supervisor, WaitsForNoFileSystemOfAProgram) {
  Supervised c("sleep 1000");
  Program program{{"sleep", "1000"}, {}, c.folder() / "pipe", {}, {}};
  std::filesystem::create_directories(c.folder());
  ASSERT_EQ(mkfifo(program.log.c_str(), 0600), 0);  // opening it waits for a reader
  auto launch = Launch::begin(program, Until::kItRuns);
  ASSERT_TRUE(launch) << launch.error();
  pollfd report{launch->descriptor(), POLLIN, 0};
  EXPECT_EQ(poll(&report, 1, 100), 0) << "it is not there yet, and we are here";
  const int pid = launch->pid();
  *launch = std::move(*Launch::begin({{"true"}, {}, c.folder() / "log"}, Until::kItCouldRun));
  for (int tries = 0; tries < 3000 && is_alive(pid); ++tries) std::this_thread::sleep_for(10ms);
  EXPECT_FALSE(is_alive(pid)) << "what is given up is killed";
  EXPECT_TRUE(launch->outcome());
}

TEST(Supervisor, NothingRunsThatCannotBeWatched) {
  while (waitpid(-1, nullptr, WNOHANG) > 0) continue;  // what other tests gave up
  Supervised c("sleep 1000");
  for (const std::size_t left : {0, 1, 2, 3, 4, 5}) {
    const DescriptorsLeft few(left);
    c.supervisor->start({4}, ComponentId(0));
    if (c.reply_to({4}).outcome == Outcome::kDone) {
      c.stop();
    } else {
      EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1) << "there is no child with " << left;
    }
  }
}

}  // namespace
}  // namespace culprit::owners
