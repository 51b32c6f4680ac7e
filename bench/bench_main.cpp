// culprit-bench: Google Benchmark's options, its table, and the table of claims. Exits with 1 if a
// claim was missed.
#include <benchmark/benchmark.h>

#include "claims.h"

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return culprit::bench::print_claims() ? 0 : 1;
}
