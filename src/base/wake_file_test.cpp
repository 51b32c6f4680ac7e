#include "base/wake_file.h"

#include <poll.h>

#include <gtest/gtest.h>

namespace culprit {
namespace {

TEST(WakeFile, IsReadableFromAWakeUntilItIsCleared) {
  const WakeFile file;
  const auto is_readable = [&] {
    pollfd each{file.descriptor(), POLLIN, 0};
    return poll(&each, 1, 0) == 1;
  };
  EXPECT_FALSE(is_readable());
  file.clear();
  file.wake();
  file.wake();
  EXPECT_TRUE(is_readable());
  file.clear();
  EXPECT_FALSE(is_readable());
}

}  // namespace
}  // namespace culprit
