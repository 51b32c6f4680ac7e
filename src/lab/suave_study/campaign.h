// A campaign over SUAVE: so many runs of each of some managers, and what they yield.
//
// Run number i of every manager has the same seed, and so the same world: the same start, the same
// phases of all timers, the same drift as long as nothing is done differently.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/invariant.h"
#include "exemplars/suave/model/mission_settings.h"
#include "study/campaign.h"
#include "study/single_run.h"
#include "study/statistics/moments.h"
#include "suave_study/run.h"

namespace culprit::study {

struct SuaveCampaign {
  static constexpr std::string_view kStudy = "suave";  // its name in files

  const suave::model::MissionPlan* plan = nullptr;
  const suave::model::Generation* generation = nullptr;
  std::vector<std::string> managers;
  std::uint32_t runs = 0;  // of each
  std::uint64_t seed = 0;
  // The changes to the plan; empty: it is played unchanged.
  std::optional<suave::model::MissionSettings> settings;
  suave::model::VehicleTraits vehicle;
  std::string version;  // of culprit
  std::string command;  // that makes the whole campaign

  // Of all managers.
  std::uint64_t size() const { return std::uint64_t{runs} * managers.size(); }
  // The runs in their order, by manager; a RunId's row is the manager. @pre index < size()
  RunId operator[](std::uint64_t index) const {
    CULPRIT_ASSERT(index < size());
    return {static_cast<std::uint32_t>(index / runs), static_cast<std::uint32_t>(index % runs)};
  }

  bool operator==(const SuaveCampaign&) const = default;
};

// There is at least one, each exists, and none is there twice.
Expected<void> check_managers(const std::vector<std::string>& managers);

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

struct SuaveResult {
  SuaveCampaign campaign;
  std::vector<SuaveRow> rows;  // as its managers
};

// Folds runs into a result.
class SuaveFold {
 public:
  explicit SuaveFold(SuaveCampaign campaign);

  // The next run in the campaign's order. @pre !is_complete()
  void add(SuaveRun run);

  std::uint64_t size() const { return next_; }
  bool is_complete() const { return next_ == result_.campaign.size(); }

  // @pre is_complete()
  SuaveResult result() && {
    CULPRIT_ASSERT(is_complete());
    return std::move(result_);
  }

 private:
  SuaveResult result_;
  std::vector<SuaveRun> runs_;  // of the manager under way
  std::uint64_t next_ = 0;
};

SuaveRun play(const SuaveCampaign& campaign, RunId id);

// Plays all runs on `jobs` threads; the result does not depend on how many.
SuaveResult run_campaign(const SuaveCampaign& campaign, unsigned jobs);

// The first run of each manager again, with its track.
std::vector<Track> first_tracks(const SuaveCampaign& campaign);

// A run again, to look at moment by moment. Managers without rules report no events; the vehicle's
// actions and the faults are reported for all.
SingleRun single_run(const SuaveCampaign& campaign, RunId id);

}  // namespace culprit::study
