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

// Or the program that runs this test with all its children: a container engine, or systemd.
TEST(FoundOwner, IsTheProgramThatStartedIt) {
  const test::TestFolder folder;
  const auto started =
      spawn({.arguments = {"sleep", "60"}, .search_first = {}, .log = folder.path() / "log"});
  ASSERT_TRUE(started) << started.error();
  const auto owner = found_owner(*started, "");
  kill(*started, SIGKILL);
  waitpid(*started, nullptr, 0);
  ASSERT_TRUE(owner);
  if (owner->declare.find("RESPAWNED") != std::string::npos) {
    EXPECT_THAT(owner->name, HasSubstr("process " + std::to_string(getpid())));
  } else {
    const auto all_of_us = found_owner(getpid(), "");
    ASSERT_TRUE(all_of_us);
    EXPECT_EQ(owner->declare, all_of_us->declare);
    EXPECT_EQ(owner->name, all_of_us->name);
  }
}

TEST(FoundOwner, IsTheNodeThatLoadsItBeforeTheOneThatRunsIt) {
  const auto owner = found_owner(getpid(), "/box");
  ASSERT_TRUE(owner);
  EXPECT_EQ(owner->declare, "IN /box PLUGIN package::Class");
}

TEST(FoundOwner, IsNobodyWhereTheProcessIsNotKnown) { EXPECT_FALSE(found_owner(0, "/box")); }

}  // namespace
}  // namespace culprit::owners
