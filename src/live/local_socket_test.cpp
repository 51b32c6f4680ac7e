#include "live/local_socket.h"

#include <fstream>
#include <optional>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "owners/file_descriptor.h"

namespace culprit::live {
namespace {

using testing::HasSubstr;

// A runtime folder of its own, whatever the machine has.
struct LocalSockets : testing::Test {
  LocalSockets() {
    setenv("XDG_RUNTIME_DIR", folder.path().c_str(), 1);
    unsetenv("RUNTIME_DIRECTORY");
  }
  ~LocalSockets() override { unsetenv("XDG_RUNTIME_DIR"); }

  // Only those in our folder.
  std::vector<LocalSocket> found() const {
    std::vector<LocalSocket> ours;
    for (LocalSocket& each : local_sockets()) {
      if (each.path.native().starts_with(folder.path().native())) ours.push_back(std::move(each));
    }
    return ours;
  }

  test::TestFolder folder;
};

// Bound to `path`; listens until it is gone.
owners::FileDescriptor listener(const std::filesystem::path& path) {
  owners::FileDescriptor descriptor(socket(AF_UNIX, SOCK_STREAM, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.native().copy(address.sun_path, sizeof address.sun_path - 1);
  EXPECT_EQ(bind(descriptor.get(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  EXPECT_EQ(listen(descriptor.get(), 1), 0);
  return descriptor;
}

TEST_F(LocalSockets, AreInAFolderThatIsTheUsersAlone) {
  const auto path = own_socket(7);
  ASSERT_TRUE(path) << path.error();
  EXPECT_EQ(path->filename(), "7-" + std::to_string(getpid()) + ".sock");
  struct stat status {};
  ASSERT_EQ(stat(path->parent_path().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0700u);
}

TEST_F(LocalSockets, AreNotMadeWhereOthersMayWrite) {
  const auto own = folder / "culprit";
  std::filesystem::create_directory(own);
  chmod(own.c_str(), 0777);
  EXPECT_THAT(own_socket(7).error(), HasSubstr("others may write"));
  std::filesystem::remove(own);
  std::filesystem::create_directory(folder / "elsewhere");
  std::filesystem::create_symlink(folder / "elsewhere", own);
  EXPECT_THAT(own_socket(7).error(), HasSubstr("no folder"));
}

TEST_F(LocalSockets, AreNotMadeUnderANameThatIsTooLong) {
  const auto deep = folder / std::string(100, 'x');
  std::filesystem::create_directory(deep);
  setenv("XDG_RUNTIME_DIR", deep.c_str(), 1);
  EXPECT_THAT(own_socket(7).error(), HasSubstr("too long"));
}

TEST_F(LocalSockets, DoNotTakeTheNameOfOneThatListens) {
  const auto path = *own_socket(7);
  const auto listening = listener(path);
  EXPECT_THAT(own_socket(7).error(), HasSubstr("another process listens"));
}

TEST_F(LocalSockets, AreFoundWithWhatBecameOfTheirProcess) {
  EXPECT_TRUE(found().empty());
  const auto path = *own_socket(7);
  const auto left = path.parent_path() / "8-1.sock";
  const auto gone = path.parent_path() / "8-99999999.sock";
  const auto listening = listener(path);
  { listener(left), listener(gone); }
  std::ofstream(path.parent_path() / "9-1.sock") << "no socket";
  std::ofstream(path.parent_path() / "note.txt") << "of somebody";
  auto all = found();
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].domain, 7u);
  EXPECT_EQ(all[0].process, getpid());
  EXPECT_EQ(all[0].user, geteuid());
  EXPECT_EQ(all[0].state, LocalSocket::State::kListens);
  EXPECT_EQ(all[1].state, LocalSocket::State::kLeft);

  // A process of that number may be about to listen.
  remove_left_sockets();
  all = found();
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[1].path, left);
}

// Any user can make a folder of such a name in /tmp.
TEST_F(LocalSockets, OfOtherUsersAreAskedOnlyIfRootSaysSo) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can give a folder away";
  constexpr uid_t kNobody = 65534;
  const auto path = *own_socket(7);
  const auto listening = listener(path);
  ASSERT_EQ(chown(path.parent_path().c_str(), kNobody, kNobody), 0);
  const auto state = [&](const CulpritQuery& query) {
    for (const LocalSocket& each : local_sockets(query)) {
      if (each.path == path) return std::optional(each.state);
    }
    return std::optional<LocalSocket::State>();
  };
  EXPECT_EQ(state({}), LocalSocket::State::kForbidden);
  EXPECT_EQ(state({.users = {1}}), LocalSocket::State::kForbidden);
  EXPECT_EQ(state({.users = {kNobody}}), LocalSocket::State::kListens);
  EXPECT_EQ(state({.is_everybody = true}), LocalSocket::State::kListens);
  chmod(path.parent_path().c_str(), 0777);
  EXPECT_EQ(state({.is_everybody = true}), std::nullopt) << "anybody may have put it there";
}

}  // namespace
}  // namespace culprit::live
