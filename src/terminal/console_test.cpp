#include "terminal/console.h"

#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit {
namespace {

using namespace std::chrono_literals;

TEST(Line, HasTheTimeTheLabelAndTheSentence) {
  const RuleSet rules = *check(Source("test",
                                      "COMPONENT camera NODE /camera\n"
                                      "RULE R\nPOLICIES ERROR\nTRIGGER alive(camera) == false\n"
                                      "STRATEGY s 50 10\nADAPTATION camera restart 3\n"))
                             .rules;
  const Event detected{Time(4s), FailureDetected{RuleId(0)}};
  EXPECT_EQ(line(detected, rules, Time(1s), Colour::kOff),
            "   3.000  detected    R detected (ERROR)");
  EXPECT_EQ(line(detected, rules, Time(1s), Colour::kOn),
            "   3.000  \033[1;31mdetected  \033[0m  R detected (ERROR)");
  EXPECT_EQ(line({Time(4s), ComponentFound{ComponentId(0), 7}}, rules, Time(1s), Colour::kOn),
            "   3.000  \033[32mfound     \033[0m  camera is there (process 7)");
  EXPECT_EQ(line({Time(4s), CameUp{}}, rules, Time(1s), Colour::kOn), "") << "of no interest";
}

// A disk that stalls, say: the threads that wait for it hold locks, and one of them is that which was to end it all.
TEST(StopSignals, EndTheProgramThoughEveryThreadWaits) {
  const pid_t child = fork();
  if (child == 0) {
    StopSignals signals;
    signals.end_within(100ms);
    signals.on_stop([] {
      flockfile(stdout);
      flockfile(stderr);
      pause();
    });
    kill(getpid(), SIGTERM);
    while (true) pause();
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == EXIT_FAILURE) << status;
}

// culprit run my.rules | tee log
TEST(StopSignals, StopOnAHangupIfTheTerminalIsGoneThatOnlyTheInputWas) {
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_TRUE(terminal >= 0 && grantpt(terminal) == 0 && unlockpt(terminal) == 0);
  const int ours = open(ptsname(terminal), O_RDWR | O_NOCTTY);
  int output[2];
  ASSERT_EQ(pipe(output), 0);
  const pid_t child = fork();
  if (child == 0) {
    dup2(ours, STDIN_FILENO);
    dup2(output[1], STDOUT_FILENO);
    dup2(output[1], STDERR_FILENO);
    close(ours);
    close(terminal);
    StopSignals signals(Hangup::kReloads);
    if (::write(STDOUT_FILENO, "x", 1) != 1) _exit(2);
    signals.wait_until_stopped();
    _exit(0);
  }
  char ready = 0;
  ASSERT_EQ(read(output[0], &ready, 1), 1);
  close(ours);
  close(terminal);
  kill(child, SIGHUP);
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
}

// A drill whose terminal is closed still has to undo its fault.
TEST(StopSignals, StopOnAHangupUnlessItIsIgnored) {
  for (const bool ignored : {false, true}) {
    const pid_t child = fork();
    if (child == 0) {
      ::signal(SIGHUP, ignored ? SIG_IGN : SIG_DFL);
      StopSignals signals(Hangup::kStops);
      kill(getpid(), SIGHUP);
      if (ignored) _exit(signals.stopped() ? 1 : 0);
      signals.wait_until_stopped();
      _exit(0);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  }
}

}  // namespace
}  // namespace culprit
