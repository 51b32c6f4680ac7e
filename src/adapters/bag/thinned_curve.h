// A curve over time, however many samples it is given: in memory there are kMostBuckets spans of time, each with its lowest
// and its highest sample. So a spike of one sample stays, and what lies between the two is left out.
//
//     ThinnedCurve curve;
//     for (const Sample& each : samples) curve.add(each.at, each.value);
//     draw(curve.points());
//
// The spans begin at a millisecond, and get twice as long whenever there are too many of them.
#pragma once

#include <cstdint>
#include <vector>

namespace culprit::bag {

class ThinnedCurve {
 public:
  static constexpr std::size_t kMostBuckets = 400;
  // Values beyond this bound, infinities and NaN are left out: the difference of two must be a number.
  static constexpr double kMostValue = 1e300;

  struct Point {
    std::int64_t at = 0;  // nanoseconds since 1970
    double value = 0;
    bool operator==(const Point&) const = default;
  };

  // A time before that of the last sample counts as that.
  void add(std::int64_t at, double value);

  // In the order of their times; at most two for each span.
  std::vector<Point> points() const;
  std::uint64_t samples() const { return samples_; }
  // No two neighbours of a curve without a pause are further apart: some times the mean distance of its samples.
  // @pre samples() > 0
  std::int64_t longest_gap() const;

  // @pre samples() > 0
  double lowest() const { return lowest_; }
  double highest() const { return highest_; }

 private:
  struct Bucket {
    std::int64_t place = 0;  // it begins at first_ + place * width_
    Point low, high;
  };
  void halve();

  std::vector<Bucket> buckets_;
  std::int64_t width_ = 1'000'000;  // ns
  std::int64_t first_ = 0;
  std::int64_t last_ = 0;
  std::uint64_t samples_ = 0;
  double lowest_ = 0;
  double highest_ = 0;
};

}  // namespace culprit::bag
