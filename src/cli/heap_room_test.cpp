#include "cli/heap_room.h"

#include <cstdlib>
#include <fstream>
#include <vector>

#include <gtest/gtest.h>

namespace culprit::cli {
namespace {

// Memory of this process, in MiB.
long resident() {
  long size = 0;
  long pages = 0;
  std::ifstream("/proc/self/statm") >> size >> pages;
  return pages / 256;
}

// In a process of its own, since what it sets stays so.
TEST(HeapRoom, TakesNoMemoryBeforeItIsUsed) {
  const auto is_little = [] {
    const long before = resident();
    make_heap_room(std::size_t{256} << 20);
    const std::vector<std::vector<char>> blocks(1000, std::vector<char>(1000));
    return resident() - before < 64 && blocks.size() == 1000;
  };
  EXPECT_EXIT(std::_Exit(is_little() ? 0 : 1), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace culprit::cli
