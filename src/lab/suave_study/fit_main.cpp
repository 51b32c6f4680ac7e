// Fits the vehicle of SUAVE's model to the published runs (suave_study/fit.h). Run it by
// scripts/fit-suave. culprit's own rows are not fitted.
#include <cstdlib>
#include <string>
#include <thread>

#include <fmt/core.h>

#include "suave_study/fit.h"
#include "suave_study/settings_json.h"

namespace culprit::study {
namespace {

int fit(std::uint32_t runs) {
  const auto fit =
      fit_vehicle(*published_targets(), {}, runs, std::max(1U, std::thread::hardware_concurrency()),
                  [](const std::string& step) {
                    fmt::print("{}\n", step);
                    std::fflush(stdout);
                  });
  if (!fit) {
    fmt::print(stderr, "suave-fit: {}\n", fit.error());
    return 1;
  }
  fmt::print("{}\nmisfit {:.3f}, with the constants as they are {:.3f}\n",
             to_indented(to_json(fit->vehicle)), fit->misfit, fit->misfit_before);
  return 0;
}

}  // namespace
}  // namespace culprit::study

int main(int argc, char** argv) {
  const int runs = argc > 1 ? std::atoi(argv[1]) : 100;
  if (runs < 2) {
    fmt::print(stderr, "usage: suave-fit [RUNS]: how many runs of each row, 2 at least\n");
    return 2;
  }
  return culprit::study::fit(static_cast<std::uint32_t>(runs));
}
