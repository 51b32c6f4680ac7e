// Who depends on whom directly, from both ends, edge by edge. An edge may be there several times.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <span>
#include <vector>

namespace culprit {

class Adjacency {
 public:
  using Index = std::uint32_t;

  std::size_t size() const { return ends_.size(); }
  void resize(std::size_t size) { ends_.resize(size); }
  std::span<const Index> producers(Index at) const { return ends_[at].producers; }
  std::span<const Index> consumers(Index at) const { return ends_[at].consumers; }

  void add(Index consumer, Index producer) {
    ends_[consumer].producers.push_back(producer);
    ends_[producer].consumers.push_back(consumer);
  }
  // @pre it is there; of several, one
  void remove(Index consumer, Index producer) {
    erase_one(ends_[consumer].producers, producer);
    erase_one(ends_[producer].consumers, consumer);
  }
  void clear(Index at) { ends_[at] = {}; }

 private:
  struct Ends {
    std::vector<Index> producers;
    std::vector<Index> consumers;
  };

  static void erase_one(std::vector<Index>& list, Index what) {
    const auto found = std::find(list.begin(), list.end(), what);
    assert(found != list.end());
    *found = list.back();
    list.pop_back();
  }

  std::vector<Ends> ends_;
};

}  // namespace culprit
