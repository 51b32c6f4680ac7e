#include "owners/found_owner.h"

#include <csignal>
#include <sys/wait.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "owners/spawn.h"

namespace culprit::owners {
namespace {

using testing::HasSubstr;

TEST(FoundOwner, IsWhoeverStartedIt) {
  const test::TestFolder folder;
  const auto started =
      spawn({.arguments = {"sleep", "60"}, .search_first = {}, .log = folder.path() / "log"});
  ASSERT_TRUE(started) << started.error();
  const auto owner = found_owner(*started, "");
  kill(*started, SIGKILL);
  waitpid(*started, nullptr, 0);
  ASSERT_TRUE(owner);
  if (owner->declare.starts_with("CONTAINER")) GTEST_SKIP() << "the tests run in a container";
  EXPECT_THAT(owner->who, HasSubstr("process " + std::to_string(getpid())));
  EXPECT_THAT(owner->declare, HasSubstr("RESPAWNED"));
}

TEST(FoundOwner, IsTheNodeThatLoadsItBeforeWhoRunsThat) {
  const auto owner = found_owner(getpid(), "/box");
  ASSERT_TRUE(owner);
  EXPECT_EQ(owner->declare, "IN /box PLUGIN package::Class");
}

TEST(FoundOwner, IsNobodyWhereTheProcessIsNotKnown) { EXPECT_FALSE(found_owner(0, "/box")); }

}  // namespace
}  // namespace culprit::owners
