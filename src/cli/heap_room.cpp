#include "cli/heap_room.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

namespace culprit::cli {

void make_heap_room(std::size_t bytes) {
  constexpr std::size_t kLargePage = std::size_t{2} << 20;
  constexpr std::size_t kMost = std::size_t{512} << 20;
  constexpr int kLargestBlock = 32 << 20;  // that glibc takes off its heap if it is told to
  const std::size_t room = std::min(bytes, kMost) / kLargePage * kLargePage;
  if (room == 0) return;
  mallopt(M_MMAP_THRESHOLD, kLargestBlock);
  mallopt(M_TOP_PAD, static_cast<int>(room));
  void* const block = std::malloc(kLargePage);  // more than is left: now the heap grows
  const auto begin = reinterpret_cast<std::uintptr_t>(block);
  const auto end = reinterpret_cast<std::uintptr_t>(sbrk(0));
  const bool is_of_heap = begin < end && end - begin <= room + 2 * kLargePage;
  std::free(block);
  if (!is_of_heap) return;  // somebody else allocates, or there is no room
  const std::uintptr_t first = (begin + kLargePage - 1) / kLargePage * kLargePage;
  madvise(reinterpret_cast<void*>(first), end - first, MADV_HUGEPAGE);
}

}  // namespace culprit::cli
