#include "study/suave/campaign.h"

#include <algorithm>

#include "study/ordered_work.h"

namespace culprit::study {
namespace {

// The paper's rule: one-sided, on the search time.
bool is_outlier(const SuaveRun& run, const Moments& search) {
  return run.search_s > search.mean() + 2 * search.sample_sd();
}

void add(const suave::model::Reactions& of_run, SuaveReactions& all) {
  for (const double answered : of_run.answered_s) all.answered_s.add(answered);
  all.unanswered += static_cast<std::int64_t>(of_run.unanswered_s.size());
}

SuaveRow fold(const std::string& manager, const suave::model::MissionPlan& plan,
              const std::vector<SuaveRun>& runs) {
  SuaveRow row;
  row.manager = manager;
  Moments search;
  for (const SuaveRun& run : runs) search.add(run.search_s);
  const bool has_outliers = manager == kCulprit;
  for (const SuaveRun& run : runs) {
    ++row.runs;
    row.found += run.is_found ? 1 : 0;
    row.successes += run.is_success ? 1 : 0;
    row.searched_s.add(run.found_s);
    row.last_distance_m.add(run.distance_m);
    row.whole_distance_m.add(run.whole_distance_m);
    add(run.visibility, row.visibility);
    add(run.thruster, row.thruster);
    if (plan.needs_battery) add(run.battery, row.battery);
    if (has_outliers && is_outlier(run, search)) {
      ++row.outliers;
      continue;
    }
    row.search_s.add(run.search_s);
    row.distance_m.add(run.distance_m);
  }
  return row;
}

SuaveRun play(const SuaveCampaign& campaign, const std::string& manager, std::uint64_t run,
              Track* track = nullptr) {
  return play_suave(manager, *campaign.generation, *campaign.plan, campaign.vehicle,
                    simulation::mix(campaign.seed) + run, track);
}

}  // namespace

std::optional<std::vector<SuaveRow>> run_campaign(const SuaveCampaign& campaign, unsigned jobs,
                                                  const std::function<bool()>& is_stopped) {
  const std::uint64_t size = std::uint64_t{campaign.runs} * campaign.managers.size();
  std::vector<SuaveRow> rows;
  std::vector<SuaveRun> runs;  // of the manager under way
  work_in_order(
      0, size, jobs,
      [&](std::uint64_t i) {
        return play(campaign, campaign.managers[i / campaign.runs], i % campaign.runs);
      },
      [&](std::uint64_t i, SuaveRun run) {
        runs.push_back(std::move(run));
        if (runs.size() == campaign.runs) {
          rows.push_back(fold(campaign.managers[i / campaign.runs], *campaign.plan, runs));
          runs.clear();
        }
        return !is_stopped || !is_stopped();
      });
  if (rows.size() < campaign.managers.size()) return std::nullopt;
  return rows;
}

std::vector<Track> first_tracks(const SuaveCampaign& campaign) {
  std::vector<Track> tracks(campaign.managers.size());
  for (std::size_t m = 0; m < tracks.size(); ++m)
    (void)play(campaign, campaign.managers[m], 0, &tracks[m]);
  return tracks;
}

}  // namespace culprit::study
