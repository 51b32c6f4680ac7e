// A queue that may become very long: it grows by small pieces and never copies what it holds, so no
// single call takes long. In steady state it allocates nothing.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "base/invariant.h"

namespace culprit::monitor {

template <class T>
class LongQueue {
 public:
  explicit LongQueue(std::size_t limit) : limit_(limit) {}

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  bool full() const { return size_ == limit_; }

  // From the oldest, 0, to the newest, size() - 1.
  T& operator[](std::size_t i) { return pieces_[slot(first_ + i)][(first_ + i) % kPiece]; }
  const T& operator[](std::size_t i) const {
    return pieces_[slot(first_ + i)][(first_ + i) % kPiece];
  }
  const T& front() const { return (*this)[0]; }
  T& back() { return (*this)[size_ - 1]; }
  const T& back() const { return (*this)[size_ - 1]; }

  // @pre !full()
  void push_back(const T& item) {
    CULPRIT_ASSERT(!full());
    const std::size_t place = first_ + size_;
    if (place / kPiece == pieces_.size()) grow();
    Piece& piece = pieces_[slot(place)];
    if (piece == nullptr) piece = std::make_unique<T[]>(kPiece);
    ++size_;
    back() = item;
  }
  // @pre !empty()
  void pop_front() {
    CULPRIT_ASSERT(!empty());
    --size_;
    if (++first_ < kPiece) return;
    // The piece that is used up will be needed next behind the last one.
    first_ = 0;
    Piece& used_up = pieces_[head_];
    head_ = (head_ + 1) % pieces_.size();
    Piece& next = pieces_[slot(size_ == 0 ? 0 : size_ - 1 + kPiece)];
    if (next == nullptr) next = std::move(used_up);
  }
  // Leaves the `count` oldest. @pre count <= size()
  void truncate(std::size_t count) {
    CULPRIT_ASSERT(count <= size_);
    size_ = count;
  }
  void clear() { size_ = 0; }

 private:
  static constexpr std::size_t kPiece = 32;  // items
  using Piece = std::unique_ptr<T[]>;

  // Where the piece is that holds the item so far behind the beginning of the first piece.
  std::size_t slot(std::size_t place) const { return (head_ + place / kPiece) % pieces_.size(); }

  void grow() {
    std::vector<Piece> more(std::max<std::size_t>(2, 2 * pieces_.size()));
    for (std::size_t i = 0; i < pieces_.size(); ++i)
      more[i] = std::move(pieces_[(head_ + i) % pieces_.size()]);
    pieces_.swap(more);
    head_ = 0;
  }

  std::size_t limit_;
  std::vector<Piece> pieces_;  // a ring that begins with `head_`; null: not needed yet
  std::size_t head_ = 0;
  std::size_t first_ = 0;  // of the first piece
  std::size_t size_ = 0;
};

}  // namespace culprit::monitor
