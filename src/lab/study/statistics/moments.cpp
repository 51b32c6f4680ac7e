#include "study/statistics/moments.h"

#include <cmath>

namespace culprit::study {

Moments Moments::of_summary(double mean, double sample_sd, std::int64_t count) {
  Moments moments;
  moments.count_ = count;
  moments.mean_ = mean;
  if (count > 1)
    moments.squared_deviations_ = sample_sd * sample_sd * static_cast<double>(count - 1);
  return moments;
}

void Moments::add(double value) {
  ++count_;
  const double deviation = value - mean_;
  mean_ += deviation / static_cast<double>(count_);
  squared_deviations_ += deviation * (value - mean_);
}

void Moments::merge(const Moments& other) {
  if (other.count_ == 0) return;
  const auto ours = static_cast<double>(count_);
  const auto theirs = static_cast<double>(other.count_);
  const double apart = other.mean_ - mean_;
  mean_ += apart * theirs / (ours + theirs);
  squared_deviations_ +=
      other.squared_deviations_ + apart * apart * ours * theirs / (ours + theirs);
  count_ += other.count_;
}

double Moments::population_sd() const {
  return count_ > 0 ? std::sqrt(squared_deviations_ / static_cast<double>(count_)) : 0;
}

double Moments::sample_variance() const {
  return count_ > 1 ? squared_deviations_ / static_cast<double>(count_ - 1) : 0;
}

double Moments::sample_sd() const { return std::sqrt(sample_variance()); }

}  // namespace culprit::study
