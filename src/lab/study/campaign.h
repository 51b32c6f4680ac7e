// A campaign: so many runs of each of some configurations. It holds all that is needed to repeat
// it.
//
// Its runs have one order, by configuration and then by number, in which they are folded into the
// result. So the result is the same to the last bit however the work was distributed.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/invariant.h"
#include "plan/paper_planner.h"

namespace culprit::study {

// Where the strategies' success probabilities in the rules come from.
enum class Probabilities : std::uint8_t {
  kIdeal,        // the true rates
  kMisspecified  // off by 20 % (the paper's robustness analysis)
};

// The profile of rows that were played on the live robot: real processes, in place of a model.
inline constexpr std::string_view kLiveRobot = "robot";
// The profile of the model that stands beside them.
inline constexpr std::string_view kModelOfLiveRobot = "live";

struct Configuration {
  PaperSwitches switches;
  std::string planner = "paper";  // --planner
  std::string profile = "paper";  // --profile
  Probabilities probabilities = Probabilities::kIdeal;

  bool operator==(const Configuration&) const = default;
};

// "D C S" with a dash for what is switched off: "D - S".
std::string label(const PaperSwitches& switches);

// The label, and what else is not as in the paper's ablation: "D C S, bayes, misspecified P".
std::string label(const Configuration& configuration);

// A run of a campaign: of rows[row], the run-th; both from 0.
struct RunId {
  std::uint32_t row = 0;
  std::uint32_t run = 0;

  bool operator==(const RunId&) const = default;
};

struct Campaign {
  static constexpr std::string_view kStudy = "sunset";  // the name of its study in files

  std::vector<Configuration> rows;
  std::uint32_t runs = 0;  // of each row
  std::uint64_t seed = 0;
  std::string version;  // of culprit
  // The command that makes the whole campaign: without shards, jobs and output paths, which change
  // nothing.
  std::string command;

  // Of all rows.
  std::uint64_t size() const { return std::uint64_t{runs} * rows.size(); }
  // The runs in their order. @pre index < size()
  RunId operator[](std::uint64_t index) const {
    CULPRIT_ASSERT(index < size());
    return {static_cast<std::uint32_t>(index / runs), static_cast<std::uint32_t>(index % runs)};
  }

  bool operator==(const Campaign&) const = default;
};

}  // namespace culprit::study
