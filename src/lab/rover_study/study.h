// `culprit-lab study rover`: plays of the rover in virtual time under several managers, and what they amount to.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rover_study/play.h"
#include "study/statistics/moments.h"
#include "study/tables/table.h"

namespace culprit::study {

struct RoverCampaign {
  enum class Faults : std::uint8_t {
    kSingle,
    kPairs,   // all pairs of faults of different components
    kTriples  // `triples` random ones, likewise
  };
  Faults faults = Faults::kSingle;
  std::uint32_t triples = 1000;
  std::uint64_t seed = 1;
  std::vector<std::string> managers = rover_managers();
  unsigned jobs = 1;
};

// The same campaign, the same plays: the play of a place has the same seed under each manager.
std::vector<rover::Play> plays_of(const RoverCampaign& campaign);

// Each play under each manager: results[manager][play].
using RoverResults = std::vector<std::vector<RoverResult>>;
RoverResults play_all(const RuleSet& rules, const std::vector<rover::Play>& plays,
                      const RoverCampaign& campaign);

// The compared figures, of the plays in which something mends each fault. Less is better, but for goals.
enum class RoverMetric : std::uint8_t { kHealed_s, kStood_s, kGoals, kWrongRestarts, kCalls };
inline constexpr std::size_t kRoverMetrics = 5;
// A play that did not heal counts with RoverTimes::kPatience.
double value_of(RoverMetric metric, const RoverResult& result);

struct RoverRow {
  std::string manager;
  int plays = 0;  // with a remedy for each fault; so the next ones
  int healed = 0;
  int faults = 0;
  int blamed = 0;
  std::optional<double> median_s{};  // until healed; nothing: fewer healed
  std::optional<double> late_s{};    // the 95th percentile, likewise
  Moments stood_s{};
  Moments goals_an_hour{};
  int wrong_restarts = 0;
  std::optional<int> collisions{};  // live only
  int calls = 0;
  int unfixable = 0;  // plays with a fault that only a person mends
  int stands = 0;     // of these: the rover stood within 3 s, for good
};
RoverRow row_of(const std::string& manager, const std::vector<rover::Play>& plays,
                const std::vector<RoverResult>& results);

// `first` against `second` in one metric: means over the plays, how many plays are better and worse, and the p of Wilcoxon's
// signed-rank test on the paired differences, two-sided, corrected by Holm over the five metrics.
struct RoverComparison {
  RoverMetric metric = RoverMetric::kHealed_s;
  double first = 0;  // mean
  double second = 0;
  int better = 0;  // plays
  int worse = 0;
  double p = 1;
};
std::vector<RoverComparison> compare(const std::vector<rover::Play>& plays,
                                     const std::vector<RoverResult>& first,
                                     const std::vector<RoverResult>& second);

// ---- for people

Table table_of(const std::vector<RoverRow>& rows);
// `name` against each other manager of the campaign. Without rows: there is nothing to compare.
Table comparisons_of(const std::string& name, const RoverCampaign& campaign,
                     const std::vector<rover::Play>& plays, const RoverResults& results);
// The plays of this manager that did not heal, and those that did not stand in time: one a line.
std::string left_of(const std::string& manager, const std::vector<rover::Play>& plays,
                    const std::vector<RoverResult>& results);
// One play, to fill a line while others go on: fault, noticed, blamed, healed, time stood, wrong restarts, goals.
std::string header_of_plays();
std::string line_of(const rover::Play& play, const RoverResult& result);

}  // namespace culprit::study
