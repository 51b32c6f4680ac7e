// Mean or standard deviation of the values within a time that moves on.
//
// No value is ever subtracted, so no rounding error outlives the value that brought it, and the
// deviation of equal values is exactly 0. Each sample belongs to a block of kBlock:
//
//   oldest block    for each sample that is left, the sum of it and of all later ones of the block
//   blocks          two stacks, as in two-stack sliding window aggregation: each block of the older
//                   one has the sum of itself and of all later ones there, the newer one has one sum
//   newest block    one sum
//
// The sum of the window is that of these parts. A sample is summed up three times in all, and no call
// does so for more than one block of samples and one stack of blocks: 0.1 ms for millions of samples.
//
// A sum S of n values x is
//
//   mean        S = Σ x as two doubles, the second one of which is the error of the first (Dekker)
//   deviation   S = (m, q), m = Σ x / n, q = Σ (x - m)²; two of them are joined as Chan, Golub and
//               LeVeque do (1979): with d = m₂ - m₁, m = m₁ + d n₂/n, q = q₁ + q₂ + d² n₁ n₂ / n
#pragma once

#include <cstdint>
#include <vector>

#include "base/time.h"
#include "monitor/long_queue.h"

namespace culprit::monitor {

class SlidingMoments {
 public:
  enum class Of : std::uint8_t { kMean, kDeviation };

  // Keeps `limit` values at most; 16 bytes each.
  SlidingMoments(Of of, std::size_t limit)
      : of_(of), samples_(limit), blocks_(limit / kBlock + 1) {}

  // False: it cannot hold one more, and is as it was. Times never go back.
  [[nodiscard]] bool add(Time at, double value);
  // Forgets what came at `time` or before.
  void forget_until(Time time);
  void clear();

  bool empty() const { return samples_.empty(); }
  // When the oldest value came. @pre !empty()
  Time oldest() const { return samples_.front().at; }
  // The deviation is that of the population. NaN where infinite values leave no result.
  // @pre !empty()
  double value() const;

 private:
  struct Sum {
    double first = 0;   // mean: Σ x; deviation: m
    double second = 0;  // mean: the error of `first`; deviation: q
  };
  struct Sample {
    Time at;
    double value = 0;
  };
  Sum joined(const Sum& a, std::size_t of_a, const Sum& b, std::size_t of_b) const;
  void end_block();
  void begin_oldest();
  void pop_block();

  static constexpr std::size_t kBlock = 1024;

  Of of_;
  LongQueue<Sample> samples_;
  std::vector<Sum> oldest_;  // of the samples that are left of the oldest block, the last one first
  LongQueue<Sum> blocks_;
  std::size_t older_ = 0;  // so many of `blocks_`, from the front, are the older stack
  Sum newer_;
  Sum newest_;
  std::size_t in_newest_ = 0;  // samples
};

}  // namespace culprit::monitor
