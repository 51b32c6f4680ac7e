#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "laboratory/commands.h"
#include "terminal/progress.h"
#include "torture/torture.h"

namespace culprit::lab {
namespace {

struct TortureOptions {
  std::uint64_t seeds = 1000;
  std::uint64_t first = 1;
};

int torture(const TortureOptions& options) {
  std::uint64_t violations = 0;
  {
    Progress progress(0, options.seeds);
    for (std::uint64_t i = 0; i < options.seeds; ++i) {
      const torture::Scenario scenario = torture::draw(options.first + i);
      if (torture::run(scenario).violation) {
        ++violations;
        fmt::print("{}\n", torture::report(torture::shrink(scenario)));
        std::fflush(stdout);
      }
      progress.show(i + 1);
    }
  }
  fmt::print("{} seeds, {} violations\n", options.seeds, violations);
  return violations == 0 ? kOk : kFailed;
}

}  // namespace

void add_torture(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<TortureOptions>();
  CLI::App* command = app.add_subcommand(
      "torture",
      "Run culprit on random simulated robots with all kinds of faults, and check its invariants.\n"
      "The same seed gives the same run; a failed one is reduced and shown.");
  command->add_option("--seeds", options->seeds, "Number of seeds")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1'000'000'000}))
      ->capture_default_str();
  command->add_option("--from", options->first, "The first seed")->capture_default_str();
  command->callback([options, &exit_code] { exit_code = torture(*options); });
}

}  // namespace culprit::lab
