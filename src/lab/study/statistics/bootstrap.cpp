#include "study/statistics/bootstrap.h"

#include <algorithm>
#include <random>

namespace culprit::study {
namespace {

// P(Poisson(1) <= i) in units of 2^-32, rounded; whatever is beyond ten counts as eleven.
// ppois(0:10, 1) * 2^32 in R.
constexpr std::array<std::uint32_t, 11> kCumulative = {
    1580030169, 3160060337, 3950075422, 4213413783, 4279248374, 4292415292,
    4294609778, 4294923276, 4294962463, 4294966817, 4294967253};

std::uint8_t poisson(std::uint32_t uniform) {
  std::uint8_t draws = 0;
  while (draws < kCumulative.size() && uniform >= kCumulative[draws]) ++draws;
  return draws;
}

}  // namespace

Weights poisson_weights(std::uint64_t seed, std::uint32_t row, std::uint32_t run) {
  // Engine and seed sequence are laid down by the standard to the bit; its distributions are not.
  std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U),
                         row, run};
  std::mt19937 engine(sequence);
  Weights weights;
  for (std::uint8_t& weight : weights) weight = poisson(static_cast<std::uint32_t>(engine()));
  return weights;
}

void BootstrapMean::add(const Weights& weights, double sum, double count) {
  for (std::size_t i = 0; i < kReplicates; ++i) {
    sums_[i] += weights[i] * sum;
    counts_[i] += weights[i] * count;
  }
}

std::optional<Interval> BootstrapMean::interval() const {
  std::array<double, kReplicates> means;
  for (std::size_t i = 0; i < kReplicates; ++i) {
    if (counts_[i] == 0) return std::nullopt;
    means[i] = sums_[i] / counts_[i];
  }
  std::sort(means.begin(), means.end());
  constexpr std::size_t kTail = kReplicates / 40;  // 2.5 %
  return Interval{means[kTail - 1], means[kReplicates - kTail]};
}

}  // namespace culprit::study
