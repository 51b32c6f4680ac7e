// Mean or standard deviation of the values within a time that moves on.
//
// No value is ever subtracted, so no rounding error outlives the value that brought it, and the
// deviation of equal values is exactly 0. Values are summed up in two stacks (a queue of two stacks,
// as in two-stack sliding window aggregation): each value of the older stack knows the sum of itself
// and all later ones of its stack, the newer stack has one sum. When the older one is used up, the
// newer one becomes it. Each value is added twice in all.
//
// A sum S of n values x is
//
//   mean        S = Σ x as two doubles, the second one of which is the error of the first (Dekker)
//   deviation   S = (m, q), m = Σ x / n, q = Σ (x - m)²; two of them are joined as Chan, Golub and
//               LeVeque do (1979): with d = m₂ - m₁, m = m₁ + d n₂/n, q = q₁ + q₂ + d² n₁ n₂ / n
#pragma once

#include <cstdint>

#include "base/time.h"
#include "monitor/ring.h"

namespace culprit::monitor {

class SlidingMoments {
 public:
  enum class Of : std::uint8_t { kMean, kDeviation };

  // Keeps `limit` values at most; 24 bytes each.
  SlidingMoments(Of of, std::size_t limit) : of_(of), samples_(limit) {}

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
    Sum sum;  // of it; in the older stack, of it and all later ones there
  };
  Sum joined(const Sum& a, std::size_t of_a, const Sum& b, std::size_t of_b) const;
  void turn_over();

  Of of_;
  Ring<Sample> samples_;
  std::size_t older_ = 0;  // so many of `samples_`, from the front, are the older stack
  Sum newer_;
};

}  // namespace culprit::monitor
