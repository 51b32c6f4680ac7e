#include "diagnose/bit_rows.h"

#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace culprit::diagnose {
namespace {

RC_GTEST_PROP(BitRows, RowsBecomeColumns, ()) {
  const auto size = *rc::gen::inRange<std::size_t>(0, 150);
  std::mt19937_64 random(*rc::gen::arbitrary<std::uint64_t>());
  BitRows rows(size, size);
  for (std::size_t r = 0; r < size; ++r) {
    for (std::size_t c = 0; c < size; ++c) {
      if (random() % 3 == 0) set(rows[r], c);
    }
  }
  const BitRows columns = transposed(rows, size);
  bool is_right = true;
  for (std::size_t r = 0; r < size; ++r) {
    for (std::size_t c = 0; c < size; ++c) is_right &= has(columns[c], r) == has(rows[r], c);
  }
  RC_ASSERT(is_right);
}

}  // namespace
}  // namespace culprit::diagnose
