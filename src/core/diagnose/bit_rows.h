// Rows of bits: relations between many things, and sets of them.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace culprit::diagnose {

using Word = std::uint64_t;
inline constexpr std::size_t kWordBits = 64;

class BitRows {
 public:
  BitRows(std::size_t rows, std::size_t columns)
      : words_((columns + kWordBits - 1) / kWordBits), bits_(rows * words_) {}

  std::span<Word> operator[](std::size_t row) {
    return std::span(bits_).subspan(row * words_, words_);
  }
  std::span<const Word> operator[](std::size_t row) const {
    return std::span(bits_).subspan(row * words_, words_);
  }

 private:
  std::size_t words_;
  std::vector<Word> bits_;
};

inline void set(std::span<Word> row, std::size_t bit) {
  row[bit / kWordBits] |= Word{1} << (bit % kWordBits);
}
inline bool has(std::span<const Word> row, std::size_t bit) {
  return (row[bit / kWordBits] >> (bit % kWordBits) & 1) != 0;
}
inline void add(std::span<Word> row, std::span<const Word> other) {
  for (std::size_t w = 0; w < row.size(); ++w) row[w] |= other[w];
}
inline bool meet(std::span<const Word> a, std::span<const Word> b) {
  for (std::size_t w = 0; w < a.size(); ++w) {
    if ((a[w] & b[w]) != 0) return true;
  }
  return false;
}

inline void clear(std::span<Word> row, std::size_t bit) {
  row[bit / kWordBits] &= ~(Word{1} << (bit % kWordBits));
}

// Visits the bits that are set in both, ascending, up to the first one of which `visit(bit)` is
// true. Whether there is one.
template <class Visit>
bool any_common(std::span<const Word> a, std::span<const Word> b, Visit visit) {
  for (std::size_t w = 0; w < a.size(); ++w) {
    for (Word rest = a[w] & b[w]; rest != 0; rest &= rest - 1) {
      if (visit(w * kWordBits + static_cast<std::size_t>(std::countr_zero(rest)))) return true;
    }
  }
  return false;
}
// Calls `visit(bit)` for each of them.
template <class Visit>
void for_each_common(std::span<const Word> a, std::span<const Word> b, Visit visit) {
  any_common(a, b, [&](std::size_t bit) {
    visit(bit);
    return false;
  });
}
// Calls `visit(bit)` for each bit that is set, ascending.
template <class Visit>
void for_each(std::span<const Word> row, Visit visit) {
  for_each_common(row, row, visit);
}
// The first bit that is set in both, if there is one.
inline std::optional<std::size_t> first_common(std::span<const Word> a, std::span<const Word> b) {
  for (std::size_t w = 0; w < a.size(); ++w) {
    if (const Word both = a[w] & b[w]; both != 0)
      return w * kWordBits + static_cast<std::size_t>(std::countr_zero(both));
  }
  return std::nullopt;
}

// Rows as columns, of `size` of either.
BitRows transposed(const BitRows& square, std::size_t size);

}  // namespace culprit::diagnose
