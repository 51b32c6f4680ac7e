#include "diagnose/bit_rows.h"

#include <algorithm>
#include <array>

namespace culprit::diagnose {
namespace {

using Block = std::array<Word, kWordBits>;

// Swaps rows and columns: of the quarters of the block, then of the quarters of these, and so on
// (Warren, "Hacker's Delight", 2003, section 7-3).
void transpose(Block& block) {
  Word low = ~Word{0} >> (kWordBits / 2);  // the lower half of each part of a row
  for (std::size_t half = kWordBits / 2; half != 0; half /= 2, low ^= low << half) {
    for (std::size_t row = 0; row < kWordBits; row = (row + half + 1) & ~half) {
      const Word swapped = (block[row] >> half ^ block[row + half]) & low;
      block[row] ^= swapped << half;
      block[row + half] ^= swapped;
    }
  }
}

}  // namespace

BitRows transposed(const BitRows& square, std::size_t size) {
  BitRows result(size, size);
  Block block;
  for (std::size_t top = 0; top < size; top += kWordBits) {
    const std::size_t height = std::min(kWordBits, size - top);
    for (std::size_t left = 0; left < size; left += kWordBits) {
      block.fill(0);
      Word any = 0;
      for (std::size_t r = 0; r < height; ++r) any |= block[r] = square[top + r][left / kWordBits];
      if (any == 0) continue;
      transpose(block);
      const std::size_t width = std::min(kWordBits, size - left);
      for (std::size_t c = 0; c < width; ++c) result[left + c][top / kWordBits] = block[c];
    }
  }
  return result;
}

}  // namespace culprit::diagnose
