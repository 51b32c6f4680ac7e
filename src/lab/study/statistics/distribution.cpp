#include "study/statistics/distribution.h"

#include <bit>

namespace culprit::study {
namespace {

constexpr int kSignificandBits = 52;

// Towards zero, so that dropping bits one after the other is dropping them at once.
double without_low_bits(double value, int bits) {
  const auto pattern = std::bit_cast<std::uint64_t>(value);
  return std::bit_cast<double>(pattern & (~std::uint64_t{0} << bits)) + 0.0;  // no -0
}

}  // namespace

void Distribution::add(double value) {
  ++count_;
  ++counts_[without_low_bits(value, dropped_bits_)];
  while (counts_.size() > kMostValues && dropped_bits_ < kSignificandBits) coarsen();
}

void Distribution::coarsen() {
  ++dropped_bits_;
  std::map<double, std::int64_t> coarser;
  for (const auto& [value, count] : counts_)
    coarser[without_low_bits(value, dropped_bits_)] += count;
  counts_ = std::move(coarser);
}

}  // namespace culprit::study
