// A campaign over SUAVE: so many runs of each of some managers, and what they yield.
//
// Run number i of every manager has the same seed, and so the same world: the same start, the same
// phases of all timers, the same drift as long as nothing is done differently.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "study/statistics/moments.h"
#include "study/suave/run.h"

namespace culprit::study {

struct SuaveCampaign {
  const suave::model::MissionPlan* plan = nullptr;
  const suave::model::Generation* generation = nullptr;
  std::vector<std::string> managers;
  std::uint32_t runs = 0;  // of each
  std::uint64_t seed = 0;
  suave::model::VehicleTraits vehicle;
};

struct SuaveReactions {
  Moments answered_s;
  std::int64_t unanswered = 0;
};

struct SuaveRow {
  std::string manager;

  // As the paper reports: of its own manager, runs that searched longer than the mean and twice the
  // standard deviation do not count; of the others all do.
  Moments search_s;
  Moments distance_m;
  std::int64_t outliers = 0;
  SuaveReactions visibility;
  SuaveReactions thruster;
  SuaveReactions battery;

  // Honestly: all runs.
  std::int64_t runs = 0;
  std::int64_t found = 0;
  std::int64_t successes = 0;
  Moments searched_s;  // not cut to whole seconds; until the end where nothing was found
  Moments last_distance_m;
  Moments whole_distance_m;
};

// Plays all runs on `jobs` threads; the result does not depend on how many. `is_stopped` is asked
// after each run (null: never stopped); where it stopped the rest is missing and nothing is given.
std::optional<std::vector<SuaveRow>> run_campaign(const SuaveCampaign& campaign, unsigned jobs,
                                                  const std::function<bool()>& is_stopped);

// The first run of each manager again, with its track.
std::vector<Track> first_tracks(const SuaveCampaign& campaign);

}  // namespace culprit::study
