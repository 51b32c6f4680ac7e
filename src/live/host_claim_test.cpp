#include "live/host_claim.h"

#include <csignal>
#include <sys/wait.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::live {
namespace {

using testing::HasSubstr;

// A name of our own.
std::string name() { return "test-" + std::to_string(getpid()); }

// Another process, of this user, that holds the name that culprits of `user` claim by.
class Holder {
 public:
  Holder(uid_t self, uid_t user) {
    int ready[2];
    if (pipe(ready) != 0) return;
    pid_ = fork();
    if (pid_ == 0) {
      const bool is_changed = self == geteuid() || setuid(self) == 0;
      const auto lock = ros2::NamedLock::take("culprit-" + std::to_string(user) + "-test-" +
                                              std::to_string(getppid()));
      const char has_it = is_changed && lock && *lock ? 1 : 0;
      [[maybe_unused]] const auto written = write(ready[1], &has_it, 1);
      pause();
      _exit(0);
    }
    char has_it = 0;
    holds_ = read(ready[0], &has_it, 1) == 1 && has_it == 1;
    close(ready[0]);
    close(ready[1]);
  }
  ~Holder() {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  bool holds() const { return holds_; }
  pid_t pid() const { return pid_; }

 private:
  pid_t pid_ = 0;
  bool holds_ = false;
};

TEST(HostClaim, IsOursWhenNobodyHasItAndStaysSo) {
  HostClaim claim(name());
  EXPECT_TRUE(claim.look());
  EXPECT_TRUE(claim.look());
  HostClaim later(name());
  EXPECT_FALSE(later.look());
  EXPECT_EQ(later.holder(), "process " + std::to_string(getpid()));
}

TEST(HostClaim, PassesOnWhenItsHolderIsKilled) {
  HostClaim claim(name());
  {
    const Holder other(geteuid(), geteuid());
    ASSERT_TRUE(other.holds());
    EXPECT_FALSE(claim.look());
    EXPECT_EQ(claim.holder(), "process " + std::to_string(other.pid()));
    // It does not answer, however often it is asked.
    for (int i = 0; i < 200; ++i) EXPECT_FALSE(claim.look());
  }
  EXPECT_TRUE(claim.look());
  EXPECT_EQ(claim.holder(), "");
}

TEST(HostClaim, IsNotLostToAStranger) {
  if (geteuid() != 0) GTEST_SKIP() << "takes root, to be somebody else";
  constexpr uid_t kStranger = 65534;
  HostClaim claim(name());
  const Holder stranger(kStranger, geteuid());
  ASSERT_TRUE(stranger.holds());
  EXPECT_TRUE(claim.look());
  EXPECT_EQ(claim.stranger(),
            "process " + std::to_string(stranger.pid()) + " of user " + std::to_string(kStranger));
}

}  // namespace
}  // namespace culprit::live
