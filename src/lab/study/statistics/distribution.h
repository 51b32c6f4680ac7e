// How values are distributed, in bounded memory: exact as long as few different values occur, with
// a small relative error beyond.
//
// Values are counted one by one. Once there are more than kMostValues different ones, all lose the
// lowest bit of their significand, and again until they are few enough. So the result depends on
// the values only, not on their order, and each is kept with a relative error below 2^-bits.
#pragma once

#include <cstdint>
#include <map>

namespace culprit::study {

class Distribution {
 public:
  static constexpr std::size_t kMostValues = 1024;

  void add(double value);  // finite

  // Value -> how often it occurred, ascending.
  const std::map<double, std::int64_t>& counts() const { return counts_; }
  std::int64_t count() const { return count_; }

 private:
  void coarsen();

  std::map<double, std::int64_t> counts_;
  std::int64_t count_ = 0;
  int dropped_bits_ = 0;
};

}  // namespace culprit::study
