// A ring buffer: grows up to its limit and then stays as it is, so that nothing allocates in
// steady state.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "base/invariant.h"

namespace culprit::monitor {

template <class T>
class Ring {
 public:
  explicit Ring(std::size_t limit) : limit_(limit) {}

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  bool full() const { return size_ == limit_; }

  // From the oldest, 0, to the newest, size() - 1.
  T& operator[](std::size_t i) { return items_[(first_ + i) % items_.size()]; }
  const T& operator[](std::size_t i) const { return items_[(first_ + i) % items_.size()]; }
  T& front() { return (*this)[0]; }
  T& back() { return (*this)[size_ - 1]; }
  const T& back() const { return (*this)[size_ - 1]; }

  // @pre !full()
  void push_back(const T& item) {
    CULPRIT_ASSERT(!full());
    if (size_ == items_.size()) grow();
    ++size_;
    back() = item;
  }
  // @pre !empty()
  void pop_front() {
    CULPRIT_ASSERT(!empty());
    first_ = (first_ + 1) % items_.size();
    --size_;
  }
  void clear() { first_ = size_ = 0; }

 private:
  void grow() {
    std::vector<T> larger(std::min(limit_, std::max<std::size_t>(8, 2 * items_.size())));
    for (std::size_t i = 0; i < size_; ++i) larger[i] = (*this)[i];
    items_.swap(larger);
    first_ = 0;
  }

  std::size_t limit_;
  std::vector<T> items_;
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

}  // namespace culprit::monitor
