// The calls that start a campaign over an exemplar, and show how it went. One at a time: it is to
// be a guest on the machine.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "base/expected.h"
#include "http/routes.h"

namespace culprit::web {

// The runner of the campaigns. The functions are called from any thread, and may block for a
// moment.
struct Studies {
  static constexpr std::uint32_t kMostRuns = 100'000;

  struct Campaign {
    std::string study;  // "sunset", "suave", "rca"
    std::uint32_t runs = 0;
    std::uint64_t seed = 1;
  };
  struct Progress {
    Campaign campaign;
    std::string state;  // "running", "done", "failed", "stopped"
    double seconds = 0;
    std::optional<std::pair<std::uint64_t, std::uint64_t>> done;  // of how many; nothing: not known
    std::string trouble;                                          // of a failed one, in words
    bool has_report = false;
  };

  std::function<Expected<void>(const Campaign&)> start;  // an error: one is running
  std::function<void()> stop;
  std::function<std::optional<Progress>()> progress;  // of the last one
  std::function<Expected<std::string>()> result;      // of the last one: JSON (docs/study-files.md)
  std::function<Expected<std::string>()> report;      // of the last one: HTML
};

std::vector<Route> study_routes(Studies studies);

}  // namespace culprit::web
