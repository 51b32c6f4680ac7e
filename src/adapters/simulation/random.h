// The randomness of simulated worlds and of their pictures: seeded, small, and the same on every
// platform.
//
// SplitMix64 (Steele, Lea, Flood: "Fast Splittable Pseudorandom Number Generators", OOPSLA 2014).
// The standard library's distributions are not used because each implementation draws other
// numbers.
#pragma once

#include <cstdint>

namespace culprit::simulation {

// A well-mixed 64-bit hash; a bijection.
constexpr std::uint64_t mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31U);
}

class Random {
 public:
  explicit constexpr Random(std::uint64_t seed) : state_(mix(seed)) {}

  constexpr std::uint64_t next() {
    const std::uint64_t result = mix(state_);
    state_ += 0x9e3779b97f4a7c15U;
    return result;
  }

  // In [0, 1).
  constexpr double uniform() { return static_cast<double>(next() >> 11U) * 0x1p-53; }
  constexpr double uniform(double low, double high) { return low + (high - low) * uniform(); }

  // In [0, n), n > 0. The bias of the remainder is below n / 2^64.
  constexpr int below(int n) { return static_cast<int>(next() % static_cast<std::uint64_t>(n)); }

  constexpr bool chance(double probability) { return uniform() < probability; }

  // N(0, 1) as the sum of twelve 16-bit uniforms (Irwin-Hall): no libm, and never beyond 6 sigma.
  constexpr double normal() {
    std::int64_t sum = 0;
    for (int draw = 0; draw < 3; ++draw) {
      const std::uint64_t bits = next();
      for (unsigned shift = 0; shift < 64; shift += 16) {
        sum += static_cast<std::int64_t>((bits >> shift) & 0xffffU);
      }
    }
    return static_cast<double>(sum) / 65536.0 + 12.0 / 131072.0 - 6.0;
  }

 private:
  std::uint64_t state_;
};

}  // namespace culprit::simulation
