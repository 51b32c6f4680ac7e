// The main function of every test program: each process has a temporary folder of its own, so that
// tests that run at the same time cannot meet in a file.

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <gmock/gmock.h>

namespace {

std::string make_temporary_folder() {
  std::string path = (std::filesystem::temp_directory_path() / "culprit-tests-XXXXXX").string();
  if (mkdtemp(path.data()) == nullptr) return "";
  // For tests that take another user's part.
  std::filesystem::permissions(path, static_cast<std::filesystem::perms>(0755));
  return path;
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  const std::string folder = make_temporary_folder();
  if (folder.empty()) {
    std::perror("cannot make a temporary folder for the tests");
    return 1;
  }
  setenv("TMPDIR", folder.c_str(), 1);
  setenv("TEST_TMPDIR", folder.c_str(), 1);
  const int result = RUN_ALL_TESTS();
  std::error_code error;
  std::filesystem::permissions(folder, std::filesystem::perms::owner_all, error);
  std::filesystem::remove_all(folder, error);
  return result;
}
