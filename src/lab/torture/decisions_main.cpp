// culprit's decisions on random robots, one line a seed: how many steps, how many events, and a sum of
// all event texts. Two machines that print the same lines decide alike (scripts/arm64).
//
//     decisions 200        seeds 1 to 200
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "torture/torture.h"

namespace {

// FNV-1a: http://www.isthe.com/chongo/tech/comp/fnv/
std::uint64_t sum_of(const std::vector<std::string>& lines) {
  std::uint64_t sum = 14695981039346656037U;
  const auto add = [&](char c) { sum = (sum ^ static_cast<unsigned char>(c)) * 1099511628211U; };
  for (const std::string& line : lines) {
    for (const char c : line) add(c);
    add('\n');
  }
  return sum;
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t seeds = argc == 2 ? std::strtoull(argv[1], nullptr, 10) : 0;
  if (seeds == 0) {
    std::fprintf(stderr, "usage: decisions SEEDS\n");
    return 2;
  }
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const auto outcome = culprit::torture::run(culprit::torture::draw(seed));
    std::printf("%" PRIu64 " %" PRIu64 " steps %zu events %016" PRIx64 "\n", seed, outcome.steps,
                outcome.timeline.size(), sum_of(outcome.timeline));
  }
}
