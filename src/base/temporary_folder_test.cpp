#include "base/temporary_folder.h"

#include <cstdlib>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"

namespace culprit {
namespace {

TEST(TemporaryFolder, GoesWithAllThatIsInIt) {
  std::filesystem::path file;
  {
    auto made = TemporaryFolder::make("test");
    ASSERT_TRUE(made) << made.error();
    const TemporaryFolder folder = std::move(*made);
    file = folder / "file";
    std::ofstream(file) << "text";
    EXPECT_TRUE(std::filesystem::exists(file));
  }
  EXPECT_FALSE(std::filesystem::exists(file.parent_path()));
}

TEST(TemporaryFolder, SaysWhereItCannotBeMade) {
  const test::TestFolder world;
  const std::string before = std::getenv("TMPDIR") == nullptr ? "" : std::getenv("TMPDIR");
  setenv("TMPDIR", (world.path() / "none").c_str(), 1);
  const auto made = TemporaryFolder::make("test");
  if (before.empty()) unsetenv("TMPDIR");
  if (!before.empty()) setenv("TMPDIR", before.c_str(), 1);
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error(), testing::HasSubstr("TMPDIR"));
}

}  // namespace
}  // namespace culprit
