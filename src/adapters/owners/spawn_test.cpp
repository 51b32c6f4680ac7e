#include "owners/spawn.h"

#include <filesystem>
#include <fstream>
#include <linux/capability.h>
#include <string>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>

#include <gtest/gtest.h>

#include "base/test_folder.h"

namespace culprit::owners {
namespace {

TEST(Spawn, PassesArgumentsAsTheyAre) {
  const test::TestFolder own;
  const auto log = own / "log";
  const auto pid = spawn({{"printf", "%s|", "a b", "$HOME", "; rm", "*"}, {}, log});
  ASSERT_TRUE(pid) << pid.error();
  waitpid(*pid, nullptr, 0);
  std::ifstream file(log);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "a b|$HOME|; rm|*|");
}

TEST(Spawn, TellsTheProgramItsPid) {
  const test::TestFolder own;
  const auto log = own / "log";
  const auto pid =
      spawn({{"sh", "-c", "sh -c 'echo $CULPRIT_PROCESS'"}, {}, log, {}, "CULPRIT_PROCESS"});
  ASSERT_TRUE(pid) << pid.error();
  waitpid(*pid, nullptr, 0);
  std::ifstream file(log);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), std::to_string(*pid) + "\n");
}

TEST(Spawn, PassesNoCapabilityOn) {
  if (prctl(PR_CAPBSET_READ, CAP_KILL) != 1) GTEST_SKIP() << "there is none to pass on";
  __user_cap_header_struct who{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct has[2] = {};
  ASSERT_EQ(syscall(SYS_capget, &who, has), 0);
  has[0].inheritable |= 1U << CAP_KILL;
  if (syscall(SYS_capset, &who, has) != 0 ||
      prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_RAISE, CAP_KILL, 0, 0) != 0)
    GTEST_SKIP() << "this user cannot pass it on";
  const test::TestFolder own;
  const auto log = own / "log";
  const auto pid = spawn({{"grep", "CapAmb", "/proc/self/status"}, {}, log});
  prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0);
  ASSERT_TRUE(pid) << pid.error();
  waitpid(*pid, nullptr, 0);
  std::ifstream file(log);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "CapAmb:\t0000000000000000\n");
}

TEST(Spawn, SaysWhyAProgramCannotBeStarted) {
  const test::TestFolder folder;
  const auto bad = folder / "bad";
  std::ofstream(bad) << "#!/no/such/interpreter\n";
  std::filesystem::permissions(bad, std::filesystem::perms::owner_all);
  const auto pid = spawn({{bad}, {}, folder / "log"});
  ASSERT_FALSE(pid);
  EXPECT_EQ(pid.error(), "cannot start '" + bad.string() + "': No such file or directory");
}

}  // namespace
}  // namespace culprit::owners
