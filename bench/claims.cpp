#include "claims.h"

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "base/mutex.h"

namespace culprit::bench {
namespace {

struct Claim {
  std::string what;
  double measured;
  double limit;
  std::string unit;
};

Mutex mutex;
std::vector<Claim> claims CULPRIT_GUARDED_BY(mutex);

}  // namespace

void claim(std::string what, double measured, double limit, std::string unit) {
  const MutexLock lock(mutex);
  // Google Benchmark may run a function several times: the last run counts.
  std::erase_if(claims, [&](const Claim& c) { return c.what == what; });
  claims.push_back({std::move(what), measured, limit, std::move(unit)});
}

bool print_claims() {
  const MutexLock lock(mutex);
  std::printf("\n%-72s %10s %10s\n", "claim", "measured", "at most");
  for (const Claim& c : claims) {
    std::printf("%-72s %10.3g %10.3g  %-12s %s\n", c.what.c_str(), c.measured, c.limit,
                c.unit.c_str(), c.measured <= c.limit ? "holds" : "MISSED");
  }
  return std::all_of(claims.begin(), claims.end(),
                     [](const Claim& c) { return c.measured <= c.limit; });
}

}  // namespace culprit::bench
